//! The sensor on its bus: set up while the program waits, sampled by interrupt ever after.
//!
//! PIT0 starts a burst every millisecond; I2C0 interrupts after every byte and carries it on. Both
//! run at the same priority, so neither interrupts the other. A burst takes 0.45 ms of the
//! millisecond.

use core::cell::RefCell;
use core::fmt;

use critical_section::Mutex;
use heapless::spsc::{Consumer, Producer, Queue};
use mk20dx_hal::clocks::Clocks;
use mk20dx_hal::interrupt;
use mk20dx_hal::pac::{self, Interrupt};
use mk20dx_hal::timer::{PitChannel, PitExt};
use vrduino::imu::{self, ADDRESS, ImuError};
use vrduino::sensor::{BURST_LEN, BURST_START, Burst, RawSample};

use embedded_hal::delay::DelayNs;

use super::breadcrumb::{self, Stage};
use super::clock::{self, Time};
use super::i2c::{Error, I2c};
use super::watchdog::Watchdog;

/// Bursts that may wait for the main program: it may be this many milliseconds late.
const WAITING_BURSTS: usize = 16;
/// PIT counts down from here: 36 MHz / 36 000 = 1 kHz, exact to the crystal.
const TICKS_PER_SAMPLE: u32 = 36_000 - 1;
/// Timer ticks after which a burst that does not end is given up.
const STUCK_TICKS: u8 = 3;
/// The sensor may take 100 ms from power-on to its first answer (data sheet, table 3).
const START_UP_TRIES: u32 = 12;
const START_UP_PAUSE_MS: u32 = 10;
/// The gyroscope needs 35 ms from sleep to a steady output (data sheet, table 1).
const GYRO_START_MS: u32 = 50;
/// Bursts in a row that may fail before the sensor counts as lost.
const TOLERATED_FAILURES: u32 = 10;
/// Samples in a row that may repeat the one before.
const TOLERATED_REPEATS: u32 = 100;
/// Samples in a row that may exceed [`IMPLAUSIBLE`].
const TOLERATED_FORCE: u32 = 200;
/// 4 g in counts at ±16 g, squared. Nobody is shaken that hard for a fifth of a second; a sensor that
/// lost its supply and came back at ±2 g shows 8 g at rest.
const IMPLAUSIBLE: i64 = (4 * 2048) * (4 * 2048);
/// More urgent than USB (0x80); only the upper four bits exist.
const PRIORITY: u8 = 0x40;

static SAMPLING: Mutex<RefCell<Option<Sampling>>> = Mutex::new(RefCell::new(None));

/// Why there are no samples.
#[derive(Clone, Copy)]
pub enum Fault {
    /// The sensor could not be set up.
    SetUp(ImuError<Error>),
    /// It was, and then its bursts failed one after the other.
    Lost(Error),
    /// It answers, but has no new samples.
    Frozen,
    /// What it reports cannot be true.
    Implausible,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Fault::SetUp(ImuError::NoAnswer(Error::Stuck)) | Fault::Lost(Error::Stuck) => {
                f.write_str("an I2C line is stuck low: check SDA 18, SCL 19 and their pull-ups")
            }
            Fault::SetUp(error) => error.fmt(f),
            Fault::Lost(_) => f.write_str("the IMU stopped answering: check its wires"),
            Fault::Frozen => f.write_str("the IMU takes no new samples: setting it up again"),
            Fault::Implausible => {
                f.write_str("the IMU lost its settings: check its 3V3 supply; setting it up again")
            }
        }
    }
}

/// The sensor.
pub struct Imu {
    /// The bus, while it is not in the interrupts' hands.
    bus: Option<I2c>,
    bursts: Consumer<'static, Result<Burst, Error>>,
    last: RawSample,
    failures: u32,
    repeats: u32,
    forces: u32,
}

impl Imu {
    /// Takes bus and timer, and starts the timer: from here on milliseconds are counted.
    pub fn new(
        registers: pac::I2c0,
        port: pac::Portb,
        gpio: pac::Ptb,
        pit: pac::Pit,
        sim: &pac::Sim,
        clocks: &Clocks,
    ) -> Imu {
        let queue =
            cortex_m::singleton!(: Queue<Result<Burst, Error>, WAITING_BURSTS> = Queue::new())
                .expect("the board is taken once");
        let (results, bursts) = queue.split();
        let mut timer = pit.split(sim, clocks).ch0;
        timer.start_ticks(TICKS_PER_SAMPLE);
        timer.enable_interrupt();
        let sampling = Sampling {
            timer,
            bus: None,
            step: Step::Idle,
            burst: [0; BURST_LEN],
            results,
            stuck_ticks: 0,
            overruns: 0,
        };
        critical_section::with(|cs| SAMPLING.replace(cs, Some(sampling)));
        for interrupt in [Interrupt::PIT0, Interrupt::I2C0] {
            super::enable_interrupt(interrupt, PRIORITY);
        }
        Imu {
            bus: Some(I2c::new(registers, port, gpio, sim)),
            bursts,
            last: RawSample::default(),
            failures: 0,
            repeats: 0,
            forces: 0,
        }
    }

    /// Finds the sensor, sets it up and hands the bus to the interrupts.
    pub fn start(&mut self, time: &mut Time, watchdog: &mut Watchdog) -> Result<(), Fault> {
        let taken = critical_section::with(|cs| {
            SAMPLING
                .borrow_ref_mut(cs)
                .as_mut()
                .and_then(Sampling::stop)
        });
        let mut bus = taken
            .or(self.bus.take())
            .expect("the bus is here or with the interrupts");
        let result = set_up(&mut bus, time, watchdog);
        if let Err(error) = result {
            self.bus = Some(bus);
            return Err(Fault::SetUp(error));
        }
        while self.bursts.dequeue().is_some() {}
        (self.failures, self.repeats, self.forces) = (0, 0, 0);
        critical_section::with(|cs| {
            if let Some(sampling) = SAMPLING.borrow_ref_mut(cs).as_mut() {
                sampling.bus = Some(bus);
            }
        });
        Ok(())
    }

    /// Sleeps until the next burst has come in, or has failed and is bridged.
    pub fn next_sample(&mut self) -> Result<RawSample, Fault> {
        let result = loop {
            if let Some(result) = self.bursts.dequeue() {
                break result;
            }
            clock::sleep_unless(|| self.bursts.ready());
        };
        let sample = match result {
            Ok(burst) => {
                self.failures = 0;
                RawSample::from_burst(&burst)
            }
            Err(error) => {
                self.failures += 1;
                if self.failures > TOLERATED_FAILURES {
                    return Err(Fault::Lost(error));
                }
                RawSample {
                    fresh: false,
                    ..self.last
                }
            }
        };
        self.check(&sample)?;
        self.last = sample;
        Ok(sample)
    }

    fn check(&mut self, sample: &RawSample) -> Result<(), Fault> {
        let repeats = *sample
            == RawSample {
                fresh: false,
                ..self.last
            };
        self.repeats = if repeats { self.repeats + 1 } else { 0 };
        if self.repeats > TOLERATED_REPEATS {
            return Err(Fault::Frozen);
        }
        let force: i64 = sample
            .accel
            .iter()
            .map(|&count| i64::from(count).pow(2))
            .sum();
        self.forces = if force > IMPLAUSIBLE {
            self.forces + 1
        } else {
            0
        };
        if self.forces > TOLERATED_FORCE {
            return Err(Fault::Implausible);
        }
        Ok(())
    }

    /// Milliseconds in which the burst before had not ended, or found no room in the queue.
    pub fn overruns(&self) -> u32 {
        critical_section::with(|cs| {
            SAMPLING
                .borrow_ref(cs)
                .as_ref()
                .map_or(0, |sampling| sampling.overruns)
        })
    }
}

fn set_up(bus: &mut I2c, time: &mut Time, watchdog: &mut Watchdog) -> Result<(), ImuError<Error>> {
    bus.recover().map_err(ImuError::NoAnswer)?;
    let mut tries = START_UP_TRIES;
    while let Err(error) = imu::probe(bus) {
        tries -= 1;
        if tries == 0 || matches!(error, ImuError::UnknownPart(_)) {
            return Err(error);
        }
        time.delay_ms(START_UP_PAUSE_MS);
        watchdog.feed();
    }
    imu::configure(bus, time)?;
    watchdog.feed();
    time.delay_ms(GYRO_START_MS);
    watchdog.feed();
    Ok(())
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Step {
    Idle,
    /// The sensor's address for writing is on the bus.
    AddressToWrite,
    /// The number of the first register is.
    Register,
    /// The sensor's address for reading is.
    AddressToRead,
    /// The byte with this index is coming in.
    Receive(usize),
}

/// What the two interrupts work on.
struct Sampling {
    timer: PitChannel<0>,
    /// Present while sampling is on.
    bus: Option<I2c>,
    step: Step,
    burst: Burst,
    results: Producer<'static, Result<Burst, Error>>,
    stuck_ticks: u8,
    overruns: u32,
}

impl Sampling {
    /// A millisecond begins.
    fn tick(&mut self) {
        self.timer.clear_interrupt();
        clock::tick();
        let Some(bus) = &mut self.bus else { return };
        if self.step == Step::Idle {
            self.stuck_ticks = 0;
            self.step = Step::AddressToWrite;
            bus.begin(ADDRESS << 1, true);
            return;
        }
        self.overruns = self.overruns.wrapping_add(1);
        self.stuck_ticks += 1;
        if self.stuck_ticks >= STUCK_TICKS {
            self.end(Err(Error::Timeout));
        }
    }

    /// A byte has ended.
    fn byte(&mut self) {
        let Some(bus) = &mut self.bus else { return };
        let Some(result) = bus.byte_done() else {
            return;
        };
        match (self.step, result) {
            (Step::AddressToWrite, Ok(())) => {
                bus.put(BURST_START);
                self.step = Step::Register;
            }
            (Step::Register, Ok(())) => {
                bus.begin_again(ADDRESS << 1 | 1, true);
                self.step = Step::AddressToRead;
            }
            (Step::AddressToRead, Ok(())) => {
                bus.receive_first(BURST_LEN, true);
                self.step = Step::Receive(0);
            }
            // The last byte is refused by ourselves, which shows as "not acknowledged".
            (Step::Receive(index), Ok(()) | Err(Error::NoData)) => {
                let remaining = BURST_LEN - 1 - index;
                let byte = bus.receive_next(remaining, true);
                if let Some(place) = self.burst.get_mut(index) {
                    *place = byte;
                }
                self.step = Step::Receive(index + 1);
                if remaining == 0 {
                    self.end(Ok(()));
                }
            }
            (Step::AddressToWrite | Step::AddressToRead, Err(Error::NoData)) => {
                self.end(Err(Error::NoAddress));
            }
            (Step::Idle, _) => {}
            (_, Err(error)) => self.end(Err(error)),
        }
    }

    fn end(&mut self, result: Result<(), Error>) {
        if let (Err(_), Some(bus)) = (result, &mut self.bus) {
            bus.stop();
        }
        self.step = Step::Idle;
        if self.results.enqueue(result.map(|()| self.burst)).is_err() {
            self.overruns = self.overruns.wrapping_add(1);
        }
    }

    /// Gives the bus back.
    fn stop(&mut self) -> Option<I2c> {
        self.step = Step::Idle;
        self.bus.take()
    }
}

fn sampling(work: impl FnOnce(&mut Sampling)) {
    breadcrumb::during(Stage::SamplingInterrupt, || {
        critical_section::with(|cs| {
            if let Some(sampling) = SAMPLING.borrow_ref_mut(cs).as_mut() {
                work(sampling);
            }
        });
    });
}

#[cortex_m_rt::interrupt]
fn PIT0() {
    sampling(Sampling::tick);
}

#[cortex_m_rt::interrupt]
fn I2C0() {
    sampling(Sampling::byte);
}
