//! When the sensor measures: its clock, its internal steps, and the samples among them.
//!
//! Internally a running sensor steps at 8 kHz, or at 32 kHz with the gyroscope's filter bypassed (register map, section
//! 4.5). Every so many steps it stores a sample.

use super::part::Part;
use super::registers::{CONFIG, GYRO_CONFIG, LP_ACCEL_ODR, PWR_MGMT_1, Registers, SMPLRT_DIV};
use crate::time::{SECOND, Ticks};

pub const SLEEP: u8 = 1 << 6;
pub const CYCLE: u8 = 1 << 5;
pub const STANDBY: u8 = 1 << 4;

/// What is running.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Asleep, or without a clock.
    Stopped,
    /// The accelerometer wakes up for single samples.
    Cycle,
    /// Everything that is not disabled.
    Running,
}

/// How often what happens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Schedule {
    /// What is running.
    pub mode: Mode,
    /// Internal steps a second, by the sensor's own clock.
    pub step_hz: f64,
    /// Steps between samples.
    pub steps_per_sample: u64,
    /// Relative error of the clock in use.
    clock_error: f64,
}

impl Schedule {
    /// What the registers ask for. `locked` tells whether the gyroscope can serve as the clock.
    pub fn of(registers: &Registers, part: &Part, locked: bool) -> Schedule {
        let power = registers[PWR_MGMT_1];
        let source = power & 7;
        let mode = match power & (SLEEP | CYCLE | STANDBY) {
            _ if source == 7 => Mode::Stopped,
            CYCLE => Mode::Cycle,
            bits if bits & SLEEP != 0 => Mode::Stopped,
            _ => Mode::Running,
        };
        let clock_error = if locked && (1..=5).contains(&source) {
            part.clock_error
        } else {
            part.internal_clock_error
        };
        let (step_hz, steps_per_sample) = match mode {
            Mode::Cycle => {
                let code = i32::from((registers[LP_ACCEL_ODR] & 0xF).min(11));
                (500.0 * 2f64.powi(code - 11), 1)
            }
            _ if registers[GYRO_CONFIG] & 3 != 0 => (32_000.0, 1),
            // The divider is in effect only behind the averaging filter (section 4.4).
            _ => match registers[CONFIG] & 7 {
                0 | 7 => (8_000.0, 1),
                _ => (8_000.0, 8 * (u64::from(registers[SMPLRT_DIV]) + 1)),
            },
        };
        Schedule {
            mode,
            step_hz,
            steps_per_sample,
            clock_error,
        }
    }

    /// Length of a step in 2⁻³² ticks.
    fn period(&self) -> u128 {
        let hz = self.step_hz * (1.0 + self.clock_error);
        (SECOND as f64 / hz * FRACTION as f64).round().max(1.0) as u128
    }
}

const FRACTION: u128 = 1 << 32;

/// Counts steps since the schedule last changed.
#[derive(Debug, Clone)]
pub struct Clock {
    schedule: Schedule,
    period: u128,
    since: Ticks,
    /// Steps taken.
    taken: u64,
}

impl Clock {
    /// A clock that starts at `since`.
    pub fn new(schedule: Schedule, since: Ticks) -> Clock {
        Clock {
            schedule,
            period: schedule.period(),
            since,
            taken: 0,
        }
    }

    /// What it goes by.
    pub fn schedule(&self) -> Schedule {
        self.schedule
    }

    /// Since when.
    pub fn since(&self) -> Ticks {
        self.since
    }

    /// Starts again at `now`, if the schedule is another; `true` if it is.
    pub fn follow(&mut self, schedule: Schedule, now: Ticks) -> bool {
        let changed = schedule != self.schedule;
        if changed {
            *self = Clock::new(schedule, now);
        }
        changed
    }

    /// Steps that are due at `now`, whether taken or not.
    pub fn due(&self, now: Ticks) -> u64 {
        if self.schedule.mode == Mode::Stopped {
            return self.taken;
        }
        (u128::from(now.saturating_sub(self.since)) * FRACTION / self.period) as u64
    }

    /// Steps taken.
    pub fn taken(&self) -> u64 {
        self.taken
    }

    /// Takes the next step; returns its number and its time.
    pub fn step(&mut self) -> (u64, Ticks) {
        self.taken += 1;
        let ticks = (u128::from(self.taken) * self.period).div_ceil(FRACTION) as Ticks;
        (self.taken, self.since + ticks)
    }

    /// Leaves out all steps before the one with this number.
    pub fn skip_to(&mut self, taken: u64) {
        self.taken = self.taken.max(taken);
    }
}
