//! The sensor: an MPU-9250 with its AK8963 on the I2C bus.
//!
//! ```text
//!                       ┌ errors, noise ► low-pass ► counts ┐
//! motion ──► steps ─────┤                                   ├─► registers ──► bus
//!   (sampling)          │        (signal_path)              │   FIFO, interrupts
//!                       └ AK8963 ──► auxiliary master ──────┘
//! ```
//!
//! From the product specification (PS-MPU-9250A-01 rev. 1.0), the register map (RM-MPU-9250A-00 rev. 1.4; the
//! accelerometer's filters of rev. 1.6 at second hand), the application note on self-test (AN-MPU-9250A-03) and the AK8963 data sheet
//! (MS1356-E-02). Nothing is computed until the bus looks; what it then sees does not depend on how often it looks.

pub mod ak8963;

mod aux_master;

pub mod complaint;

mod fifo;

mod interrupts;

mod low_pass;

pub mod part;

mod registers;

mod sample;

mod sampling;

mod self_test;

mod signal_path;

mod target;

use std::sync::Arc;

use crate::motion::Motion;
use crate::time::{MILLISECOND, Ticks};
use ak8963::Ak8963;
use aux_master::AuxMaster;
use complaint::{Complaint, Complaints};
use fifo::Fifo;
use interrupts::Interrupts;
pub use part::Part;
use registers::*;
use sampling::{CYCLE, Clock, Mode, SLEEP, Schedule};
use signal_path::{SignalPath, Started};

/// Bus address with AD0 low.
pub const ADDRESS: u8 = 0x68;

/// Registers answer this long after power-on (PS 3.4.2: 11 ms typical, 100 ms at most).
const START_UP: Ticks = 11 * MILLISECOND;
/// After H_RESET the registers are back at their defaults; the same start-up is assumed.
const RESET_TIME: Ticks = 11 * MILLISECOND;
/// From sleep to a valid output (PS 3.1 and 3.2), and the accelerometer's from power-on (PS 4.23).
const GYRO_START: Ticks = 35 * MILLISECOND;
const ACCEL_START: Ticks = 20 * MILLISECOND;
const ACCEL_COLD_START: Ticks = 30 * MILLISECOND;

/// Steps that are computed where nobody wants the samples between, in seconds: 30 time constants of the slowest
/// filter, so that nothing of what lies before can be seen.
const FILTER_MEMORY: f64 = 1.0;

/// Bits of USER_CTRL.
const FIFO_ENABLED: u8 = 1 << 6;
const I2C_MST_EN: u8 = 1 << 5;
/// BYPASS_EN of INT_PIN_CFG.
const BYPASS_EN: u8 = 1 << 1;
/// FIFO_MODE of CONFIG.
const FIFO_MODE: u8 = 1 << 6;
/// ACCEL_INTEL_EN and ACCEL_INTEL_MODE of MOT_DETECT_CTRL.
const WAKE_ON_MOTION: u8 = 3 << 6;

/// What is wrong with the sensor, its magnetometer or the wires, for tests and `--fault`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Faults {
    /// Nothing answers.
    pub absent: bool,
    /// The sensor no longer takes new samples.
    pub frozen: bool,
}

/// One burst that the firmware read, as the registers held it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Burst {
    /// When INT_STATUS was read.
    pub at: Ticks,
    /// When the sample that it holds was ready.
    pub ready: Ticks,
    /// INT_STATUS, accelerometer, temperature, gyroscope: 0x3A to 0x48.
    pub bytes: [u8; 15],
    /// ST1 to ST2 of the magnetometer, if it was read through the bypass behind this burst.
    pub field: Option<[u8; 8]>,
}

/// The sensor.
#[derive(Debug, Clone)]
pub struct Mpu9250 {
    part: Part,
    registers: Registers,
    path: SignalPath,
    clock: Clock,
    started: Started,
    /// When the gyroscope can serve as the clock.
    locks_at: Option<Ticks>,
    fifo: Fifo,
    interrupts: Interrupts,
    /// RAW_DATA_RDY that waits for external sensor data.
    ready_with_external: Option<Ticks>,
    aux: AuxMaster,
    magnetometer: Option<Ak8963>,
    answers_at: Ticks,
    /// It is the driver who asked for the reset it starts from.
    reset_by_driver: bool,
    /// I2C_IF_DIS was set.
    spi_only: bool,
    transfer: target::Transfer,
    /// Present faults.
    pub faults: Faults,
    /// What the driver did wrong.
    pub complaints: Complaints,
    /// Every burst from INT_STATUS on, once recording was asked for.
    pub recording: Option<Vec<Burst>>,
    /// When the last sample was ready.
    last_ready: Ticks,
    /// When the sample was ready that the last whole burst held, if it was a new one.
    fetched: Option<Ticks>,
}

impl Mpu9250 {
    /// A `part` that has just been powered, moved by `motion`.
    pub fn new(motion: Arc<dyn Motion>, part: Part) -> Mpu9250 {
        let registers = Registers::new();
        let schedule = Schedule::of(&registers, &part, false);
        let magnetometer = part
            .magnetometer
            .then(|| Ak8963::new(Arc::clone(&motion), part.magnetic, part.seed, 0));
        let mut sensor = Mpu9250 {
            part,
            registers,
            path: SignalPath::new(motion, part),
            clock: Clock::new(schedule, 0),
            started: Started { gyro: 0, accel: 0 },
            locks_at: None,
            fifo: Fifo::default(),
            interrupts: Interrupts::default(),
            ready_with_external: None,
            aux: AuxMaster::default(),
            magnetometer,
            answers_at: START_UP,
            reset_by_driver: false,
            spi_only: false,
            transfer: target::Transfer::default(),
            faults: Faults::default(),
            complaints: Complaints::default(),
            recording: None,
            last_ready: 0,
            fetched: None,
        };
        sensor.reset_registers(0);
        sensor
    }

    /// Everything but the magnetometer, which is a die of its own, and what it depends on, as after power-on.
    fn reset_registers(&mut self, now: Ticks) {
        self.registers = Registers::new();
        self.registers[WHO_AM_I] = self.part.who_am_i;
        for axis in 0..3 {
            let codes = |codes: [u8; 3]| codes[usize::from(axis)];
            self.registers[SELF_TEST_GYRO + axis] = codes(self.part.gyro_self_test.codes);
            self.registers[SELF_TEST_ACCEL + axis] = codes(self.part.accel_self_test.codes);
        }
        self.fifo = Fifo::default();
        self.interrupts = Interrupts::default();
        self.ready_with_external = None;
        self.aux.clear();
        self.started = Started {
            gyro: now + GYRO_START,
            accel: now + ACCEL_COLD_START,
        };
        self.locks_at = Some(self.started.gyro);
        self.path.settle();
        self.clock = Clock::new(Schedule::of(&self.registers, &self.part, false), now);
        self.path
            .configure(&self.registers, self.clock.schedule(), now);
    }

    /// The sensor loses power for a moment.
    pub fn brown_out(&mut self, now: Ticks) {
        self.aux = AuxMaster::default();
        self.reset_registers(now);
        self.answers_at = now + START_UP;
        self.reset_by_driver = false;
        self.spi_only = false;
        if let Some(magnetometer) = &mut self.magnetometer {
            magnetometer.reset(now);
        }
    }

    /// When the sample was ready that the last whole burst held; once for each new sample.
    pub fn take_fetched(&mut self) -> Option<Ticks> {
        self.fetched.take()
    }

    /// Level of the INT pin, which the board does not connect: `true` is high.
    pub fn interrupt_pin(&mut self, now: Ticks) -> bool {
        self.advance(now);
        self.interrupts.pin(&self.registers, now)
    }

    /// The magnetometer, if there is one.
    pub fn magnetometer(&mut self) -> Option<&mut Ak8963> {
        self.magnetometer.as_mut()
    }

    /// The present part.
    pub fn part(&self) -> &Part {
        &self.part
    }

    /// Takes the steps that are due.
    fn advance(&mut self, now: Ticks) {
        if let Some(at) = self.locks_at.filter(|&at| at <= now) {
            self.take_steps(at);
            self.locks_at = None;
            self.follow_registers(at);
        }
        self.take_steps(now);
        self.aux.finish(&mut self.registers, now);
        self.announce_external(now);
    }

    fn take_steps(&mut self, now: Ticks) {
        let due = self.clock.due(now);
        if due <= self.clock.taken() {
            return;
        }
        if self.faults.frozen {
            self.clock.skip_to(due);
            return;
        }
        let schedule = self.clock.schedule();
        if !self.every_sample_counts() {
            let memory = (FILTER_MEMORY * schedule.step_hz).ceil() as u64;
            let memory = memory.next_multiple_of(schedule.steps_per_sample);
            if due > self.clock.taken() + 2 * memory {
                self.clock
                    .skip_to(due - due % schedule.steps_per_sample - memory);
                self.path.settle();
            }
        }
        while self.clock.taken() < due {
            let (index, at) = self.clock.step();
            self.path.step(index, at, &self.registers, self.started);
            if index.is_multiple_of(schedule.steps_per_sample) {
                self.sample(at);
            }
        }
    }

    /// Whether samples leave a trace besides the output registers.
    fn every_sample_counts(&self) -> bool {
        self.registers.has(USER_CTRL, FIFO_ENABLED)
            || self.registers.has(USER_CTRL, I2C_MST_EN)
            || self.registers.has(MOT_DETECT_CTRL, WAKE_ON_MOTION)
    }

    /// Takes over what was written to the registers that decide how to measure.
    fn follow_registers(&mut self, now: Ticks) {
        let locked = self.locks_at.is_none() && gyro_driven(&self.registers);
        let schedule = Schedule::of(&self.registers, &self.part, locked);
        let stood_still = self.clock.schedule().mode == Mode::Stopped;
        if self.clock.follow(schedule, now) && stood_still {
            self.path.settle();
        }
        self.path
            .configure(&self.registers, schedule, self.clock.since());
    }

    /// Notes which elements a write has turned on; `before` are the registers as they were.
    fn start_elements(&mut self, before: &Registers, now: Ticks) {
        if !gyro_driven(before) && gyro_driven(&self.registers) {
            self.started.gyro = now + GYRO_START;
            self.locks_at = Some(self.started.gyro);
            self.path.settle_gyro();
        }
        let awake = |registers: &Registers| registers[PWR_MGMT_1] & SLEEP == 0;
        if !awake(before) && awake(&self.registers) {
            self.started.accel = now + ACCEL_START;
        }
    }

    fn is_bypassed(&self) -> bool {
        self.registers.has(INT_PIN_CFG, BYPASS_EN) && !self.registers.has(USER_CTRL, I2C_MST_EN)
    }

    fn complain(&mut self, now: Ticks, complaint: Complaint) {
        self.complaints.note(now, complaint);
    }
}

/// Whether the gyroscope's drive is on: in standby it is, asleep, in cycle mode and with all axes disabled it is not.
fn gyro_driven(registers: &Registers) -> bool {
    registers[PWR_MGMT_1] & (SLEEP | CYCLE) == 0 && registers[PWR_MGMT_2] & 7 != 7
}
