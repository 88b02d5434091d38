//! The sensor on its bus: set up while the program waits, sampled by interrupt ever after
//! (`sampling`).

mod frames;

mod job;

mod reader;

mod sampled;

mod sampling;

use core::fmt;

use embedded_hal::delay::DelayNs;
use vrduino::imu::magnetometer::polling::{Loss, Polling};
use vrduino::imu::magnetometer::{self, MagnetometerError};
use vrduino::imu::{self, ImuError};
use vrduino::sampling::Timing;
use vrduino::sensor::RawSample;
use vrduino::sensor::magnetometer::{RawField, SensitivityAdjustment};

use super::clock::{self, Time};
use super::dma::Dma;
use super::i2c::{Error, I2c};
use super::timer::Alarm;
use super::watchdog::Watchdog;
use sampled::Outcome;
use sampling::Samples;

pub use sampling::{counts, lock_on};

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
const IMPLAUSIBLE: u32 = (4 * 2048) * (4 * 2048);

/// What the factory found out about the magnetometer, or why there is none.
pub type Compass = Result<SensitivityAdjustment, MagnetometerError<Error>>;

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
    samples: Samples,
    /// The last sample.
    pub sample: RawSample,
    /// When it was ready.
    pub timing: Timing,
    failures: u32,
    repeats: u32,
    forces: u32,
}

impl Imu {
    /// Takes the bus and what serves it, and sets the alarm: from here on milliseconds are counted.
    pub fn new(bus: I2c, dma: Dma, alarm: Alarm) -> Imu {
        Imu {
            bus: Some(bus),
            samples: sampling::start(alarm, dma),
            sample: RawSample::default(),
            timing: Timing::default(),
            failures: 0,
            repeats: 0,
            forces: 0,
        }
    }

    /// Finds the sensor, sets it up and hands the bus to the interrupts. It need not have a
    /// magnetometer.
    pub fn start(&mut self, time: &mut Time, watchdog: &mut Watchdog) -> Result<Compass, Fault> {
        let mut bus = sampling::take()
            .or(self.bus.take())
            .expect("the bus is here or with the interrupts");
        if let Err(error) = set_up(&mut bus, time, watchdog) {
            self.bus = Some(bus);
            return Err(Fault::SetUp(error));
        }
        // Last, since its first measurement is ready 7 ms later.
        let compass = magnetometer::set_up(&mut bus, time);
        while self.samples.dequeue().is_some() {}
        (self.failures, self.repeats, self.forces) = (0, 0, 0);
        sampling::give(bus, compass.is_ok().then(Polling::new));
        Ok(compass)
    }

    /// Sleeps until the next burst has come in, or has failed and is bridged: see [`Imu::sample`] and [`Imu::timing`].
    /// Now and then the magnetometer has measured since the one before; that it is lost is said once.
    #[inline(always)]
    pub fn next_sample(&mut self) -> Result<Option<Result<RawField, Loss>>, Fault> {
        clock::sleep_until(|| self.samples.ready());
        let Some(sampled) = self.samples.peek() else {
            return Ok(None);
        };
        self.sample = match sampled.outcome {
            Outcome::New => sampled.bytes.sample(),
            Outcome::Nothing | Outcome::Failed(_) => self.sample.repeated(),
        };
        self.timing = sampled.timing;
        let (outcome, field) = (sampled.outcome, sampled.field);
        // It was looked at where it lies.
        let _ = self.samples.dequeue();
        self.check(outcome)?;
        Ok(field)
    }

    /// Whether the sensor can be believed.
    #[inline(always)]
    fn check(&mut self, outcome: Outcome) -> Result<(), Fault> {
        match outcome {
            Outcome::New => (self.failures, self.repeats) = (0, 0),
            Outcome::Nothing => {
                self.failures = 0;
                self.repeats += 1;
                if self.repeats > TOLERATED_REPEATS {
                    return Err(Fault::Frozen);
                }
            }
            Outcome::Failed(error) => {
                self.failures += 1;
                if self.failures > TOLERATED_FAILURES {
                    return Err(Fault::Lost(error));
                }
            }
        }
        // Full scale on three axes is less than 2^32.
        let force: u32 = self
            .sample
            .accel
            .iter()
            .map(|&count| u32::from(count.unsigned_abs()).pow(2))
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
