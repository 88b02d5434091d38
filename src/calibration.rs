//! What the sensor reports is not what is there. Each fault is measured by a procedure, and each
//! procedure would rather have no result than a wrong one: what it refuses, it refuses with a reason.
//!
//! | file | what |
//! |---|---|
//! | this one | is the board still? then the mean of the gyro is its bias |
//! | [`six_positions`] | bias, scale and, if wanted, cross-axis terms of the accelerometer |
//! | [`ellipsoid`] | hard and soft iron around the magnetometer |
//! | [`coverage`] | which directions of the field were seen, and which are missing |
//! | [`Correction`] | all three, as they are applied |
//! | [`record`] | all three, as bytes to keep |
//!
//! # The gyro's bias
//!
//! The gyro reads a few tenths of a degree per second when nothing turns (b in eq. 1), and
//! integrating that is most of a tracker's drift. So the board is watched for a second; if it
//! provably lay still, the mean of the gyro *is* the bias. The course's firmware takes the mean
//! without looking; hold the board in the hand at start-up and it drifts for the whole session.
//!
//! [`six_positions`]: crate::calibration::six_positions
//! [`ellipsoid`]: crate::calibration::ellipsoid
//! [`coverage`]: crate::calibration::coverage
//! [`Correction`]: crate::calibration::Correction
//! [`record`]: crate::calibration::record

use crate::sensor::measurement::Calibration;
use crate::sensor::{self, Ranges, RawSample, Sample};
use crate::units::{AngularRate, SpecificForce};
use nalgebra::{RealField, Vector3};

mod correction;

pub mod coverage;

pub mod ellipsoid;

mod face;

mod least_squares;

mod moments;

mod quadric;

pub mod record;

pub mod six_positions;

pub use correction::Correction;

/// Samples in one window: one second at 1 kHz, the course's number.
pub const WINDOW: u32 = 1000;
const HALF: u32 = WINDOW / 2;

/// Most a still gyro's readings may scatter about their mean (standard deviation, °/s).
///
/// Data sheet: 0.01 °/s/√Hz × √184 Hz ≈ 0.14. The motions recorded for the BROAD benchmark
/// (another sensor of this class) begin at rest, with 0.08 to 0.14 in nearly every second and 0.40
/// in the worst; of their seconds on the move, nineteen in twenty show more than 10.
const GYRO_SCATTER_DPS: f32 = 0.5;

/// The same for the accelerometer, m/s².
///
/// Data sheet: 300 µg/√Hz × √218 Hz ≈ 0.043. The same recordings at rest:
/// 0.07 to 0.14; on the move, above 0.7.
const FORCE_SCATTER: f32 = 0.2;

/// Most that the means of the two halves of a window may differ, °/s and m/s² per axis.
///
/// Averaging 500 samples leaves a tenth of the scatter (recordings at rest: up to 0.04 and
/// 0.025), so this sees what the scatter cannot: a slow wander, and a steady slow turn. Turning
/// at 1 °/s tilts the force by 0.5° from half to half, which is 0.086 m/s².
const GYRO_WANDER_DPS: f32 = 0.2;
const FORCE_WANDER: f32 = 0.06;

/// Largest bias believed, °/s per axis: the data sheet's zero-rate offset is ±5 at 25 °C, plus
/// its change with temperature. A turn about the vertical at constant speed looks exactly like a
/// bias to a gyro and an accelerometer; this is all that bounds it.
const LARGEST_BIAS_DPS: f32 = 10.0;

/// What the sensor reads when nothing moves. Body frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Mean rate: the bias b of eq. 1.
    pub gyro_bias: AngularRate<f32>,
    /// Variance of the rate, (°/s)² per axis: σ² of eq. 1.
    pub gyro_variance_dps2: Vector3<f32>,
    /// Mean force: which way is up.
    pub force: SpecificForce<f32>,
    /// Variance of the force, (m/s²)² per axis: σ² of eq. 2.
    pub force_variance_m2_per_s4: Vector3<f32>,
    /// Mean temperature of the die, °C. The bias changes with it.
    pub temperature_celsius: f32,
}

/// What the window says after a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// It is not full yet.
    Collecting,
    /// Full, and nothing moved. A new window has begun.
    Still(Rest),
    /// Full, and something moved. A new window has begun.
    Moved,
}

/// Watches raw samples in windows of [`WINDOW`] and judges each.
///
/// Sums are kept in whole counts, where they are exact: a mean of squares minus a squared mean
/// would lose everything to rounding in single precision.
#[derive(Clone, Debug)]
pub struct Stillness {
    ranges: Ranges,
    state: Sums,
}

#[derive(Clone, Debug, Default)]
struct Sums {
    samples: u32,
    // Gyro x, y, z, then accelerometer x, y, z. The largest possible, a thousand times 2³⁰, is
    // far from the end of an i64, and so is a thousand times that.
    axes: [AxisSums; 6],
    temperature: i64,
}

#[derive(Clone, Copy, Debug, Default)]
struct AxisSums {
    first_half: i64,
    second_half: i64,
    squares: i64,
}

/// Of one axis over a full window, in counts.
#[derive(Clone, Copy, Debug)]
struct AxisStatistics {
    mean: f32,
    variance: f32,
    wander: f32,
}

impl AxisSums {
    fn statistics(self) -> AxisStatistics {
        let n = i64::from(WINDOW);
        let sum = self.first_half + self.second_half;
        // n² times the variance, still exact.
        let spread = n * self.squares - sum * sum;
        AxisStatistics {
            mean: sum as f32 / WINDOW as f32,
            variance: spread as f32 / (WINDOW as f32 * WINDOW as f32),
            wander: (self.second_half - self.first_half) as f32 / HALF as f32,
        }
    }
}

impl Stillness {
    /// An empty window. `ranges` give the counts their meaning.
    pub fn new(ranges: Ranges) -> Self {
        Self {
            ranges,
            state: Sums::default(),
        }
    }

    /// Starts the window anew.
    pub fn restart(&mut self) {
        self.state = Sums::default();
    }

    /// Takes one sample. Repeated samples ([`RawSample::fresh`] is false) are not measurements
    /// and do not count: a sensor that has stopped must not pass for one that lies still.
    pub fn push(&mut self, raw: &RawSample) -> Verdict {
        if !raw.fresh {
            return Verdict::Collecting;
        }
        let in_first_half = self.state.samples < HALF;
        let counts = raw.gyro.iter().chain(&raw.accel);
        for (axis, &count) in self.state.axes.iter_mut().zip(counts) {
            let count = i64::from(count);
            if in_first_half {
                axis.first_half += count;
            } else {
                axis.second_half += count;
            }
            axis.squares += count * count;
        }
        self.state.temperature += i64::from(raw.temperature);
        self.state.samples += 1;
        if self.state.samples < WINDOW {
            return Verdict::Collecting;
        }
        let axes = self.state.axes.map(AxisSums::statistics);
        let temperature = sensor::celsius(self.state.temperature as f32 / WINDOW as f32);
        self.restart();
        self.judge(axes, temperature)
    }

    fn judge(&self, axes: [AxisStatistics; 6], temperature_celsius: f32) -> Verdict {
        let [gx, gy, gz, ax, ay, az] = axes;
        let physical = |value: fn(AxisStatistics) -> f32| {
            let sample = self.ranges.scaled(
                Vector3::new(value(gx), value(gy), value(gz)),
                Vector3::new(value(ax), value(ay), value(az)),
            );
            (sample.rate, sample.force)
        };
        let (gyro_bias, force) = physical(|axis| axis.mean);
        let (rate_wander, force_wander) = physical(|axis| axis.wander);
        // The unit of a variance is squared, so the scale is applied once here and once below.
        let (rate_unit, force_unit) = physical(|_| 1.0);
        let (rate_variance, force_variance) = physical(|axis| axis.variance);
        let gyro_variance_dps2 = rate_variance.dps().component_mul(&rate_unit.dps());
        let force_variance_m2_per_s4 = force_variance
            .m_per_s2()
            .component_mul(&force_unit.m_per_s2());

        let still = gyro_variance_dps2.max() <= GYRO_SCATTER_DPS * GYRO_SCATTER_DPS
            && force_variance_m2_per_s4.max() <= FORCE_SCATTER * FORCE_SCATTER
            && rate_wander.dps().amax() <= GYRO_WANDER_DPS
            && force_wander.m_per_s2().amax() <= FORCE_WANDER
            && gyro_bias.dps().amax() <= LARGEST_BIAS_DPS;
        if still {
            Verdict::Still(Rest {
                gyro_bias,
                gyro_variance_dps2,
                force,
                force_variance_m2_per_s4,
                temperature_celsius,
            })
        } else {
            Verdict::Moved
        }
    }
}

/// The correction: what the gyro reads at rest is subtracted from what it reads.
///
/// Only the gyro is corrected. The accelerometer's offset cannot be told from its tilt while the
/// board lies in one position; with more of them, [`six_positions`], there is a [`Correction`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroBias<T>(AngularRate<T>);

impl<T: RealField + Copy> GyroBias<T> {
    /// As measured at rest.
    pub fn new(at_rest: AngularRate<T>) -> Self {
        Self(at_rest)
    }

    /// For a sensor without bias, or when there was no way to measure it.
    pub fn zero() -> Self {
        Self(AngularRate::zero())
    }

    /// The rate that is subtracted.
    pub fn rate(self) -> AngularRate<T> {
        self.0
    }

    /// Eq. 1 solved for the true rate, noise aside.
    pub fn correct(self, sample: Sample<T>) -> Reading<T> {
        let rate = sample.rate.rad_per_s() - self.0.rad_per_s();
        Reading {
            rate: AngularRate::from_rad_per_s(rate),
            force: sample.force,
        }
    }
}

/// A corrected sample, body frame: what the estimators take. Only [`GyroBias::correct`],
/// [`Correction::correct`] and [`Reading::calibrated`] make one, so that an uncalibrated sample cannot
/// reach them by mistake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading<T> {
    rate: AngularRate<T>,
    force: SpecificForce<T>,
}

impl<T: RealField + Copy> Reading<T> {
    /// Each triad by its own A x + b (001), as a calibration on the bench gives them.
    pub fn calibrated(
        sample: Sample<T>,
        gyro: &Calibration<AngularRate<T>>,
        accelerometer: &Calibration<SpecificForce<T>>,
    ) -> Self {
        Self {
            rate: gyro.corrected(sample.rate),
            force: accelerometer.corrected(sample.force),
        }
    }

    /// Angular rate of the body, bias removed.
    pub fn rate(&self) -> AngularRate<T> {
        self.rate
    }

    /// Specific force.
    pub fn force(&self) -> SpecificForce<T> {
        self.force
    }
}
