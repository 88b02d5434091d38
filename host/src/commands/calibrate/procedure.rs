//! From counts to a record: the library's three procedures, fed with one stream.

use nalgebra::Vector3;
use vrduino::calibration::ellipsoid::{self, EllipsoidFit, Magnetometer};
use vrduino::calibration::record::{Gyro, Record};
use vrduino::calibration::six_positions::{
    self, Accelerometer, CrossAxis, Faces, SixPositions, Step, WINDOWS_PER_FACE,
};
use vrduino::calibration::{Rest, Stillness, Verdict};
use vrduino::imu::RANGES;
use vrduino::sensor::RawSample;
use vrduino::sensor::magnetometer::SensitivityAdjustment;
use vrduino::units::{METRES_PER_S2_PER_G, MagneticField};
use vrduino::wire::frame::Counts;

/// Faster than this (°/s) it is being moved: the second that is watched begins anew when that ends.
const MOVED_DPS: f32 = 15.0;

/// What is going on, and what is known so far.
#[derive(Clone, Debug)]
pub struct Procedure {
    adjustment: Option<SensitivityAdjustment>,
    stillness: Stillness,
    positions: SixPositions<f32>,
    fit: EllipsoidFit,
    /// Every second that was still.
    rests: Vec<Rest>,
    /// The fields that the fit was given, µT, body frame.
    fields: Vec<Vector3<f32>>,
    temperature_celsius: f32,
}

/// How far off something is before and after it is corrected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// As the sensor reads.
    pub before: f32,
    /// What is left.
    pub after: f32,
}

impl Procedure {
    /// At its beginning, for a magnetometer like this, if there is one.
    pub fn new(adjustment: Option<SensitivityAdjustment>) -> Self {
        Self {
            adjustment,
            stillness: Stillness::new(RANGES),
            positions: SixPositions::new(RANGES),
            fit: EllipsoidFit::new(),
            rests: Vec::new(),
            fields: Vec::new(),
            temperature_celsius: 0.0,
        }
    }

    /// Whether there is a magnetometer.
    pub fn has_magnetometer(&self) -> bool {
        self.adjustment.is_some()
    }

    /// Watches for a second in which nothing moves: what became of one that is over.
    pub fn rest(&mut self, raw: &RawSample) -> Option<Step<f32>> {
        self.temperature_celsius = raw.temperature_celsius();
        let rate = RANGES.sample::<f32>(raw).rate.dps();
        if rate.amax() > MOVED_DPS {
            self.stillness.restart();
            return None;
        }
        match self.stillness.push(raw) {
            Verdict::Collecting => None,
            Verdict::Moved => Some(Step::Moved),
            Verdict::Still(rest) => {
                self.rests.push(rest);
                Some(self.positions.place(rest.force, rest.temperature_celsius))
            }
        }
    }

    /// Takes the field, if there is a new one.
    pub fn turn(&mut self, counts: &Counts) {
        self.temperature_celsius = counts.sample.temperature_celsius();
        if let (Some(raw), Some(adjustment)) = (counts.field, self.adjustment) {
            let field = raw.field::<f32>(adjustment);
            self.fit.push(field);
            self.fields
                .extend(field.ok().map(MagneticField::microtesla));
        }
    }

    /// What the gyro reads at rest: the mean of all seconds that were still.
    pub fn gyro(&self) -> Option<Gyro> {
        let count = self.rests.len() as f32;
        let mean = |sum: Vector3<f32>| sum / count;
        (!self.rests.is_empty()).then(|| Gyro {
            bias: vrduino::units::AngularRate::from_dps(mean(
                self.rests.iter().map(|rest| rest.gyro_bias.dps()).sum(),
            )),
            temperature_celsius: self
                .rests
                .iter()
                .map(|rest| rest.temperature_celsius)
                .sum::<f32>()
                / count,
        })
    }

    /// The faces on which it has not lain long enough.
    pub fn missing(&self) -> Faces {
        self.positions.missing()
    }

    /// Seconds that are still wanted on each face.
    pub const fn seconds_on_a_face() -> u32 {
        WINDOWS_PER_FACE
    }

    /// The accelerometer's faults.
    ///
    /// # Errors
    ///
    /// What is missing, or wrong.
    pub fn accelerometer(&self) -> Result<Accelerometer<f32>, six_positions::Refusal<f32>> {
        self.positions.result(CrossAxis::Ignore)
    }

    /// What stands around the magnetometer.
    ///
    /// # Errors
    ///
    /// What is missing, or wrong.
    pub fn magnetometer(&self) -> Result<Magnetometer<f32>, ellipsoid::Refusal<f32>> {
        self.fit.result(self.temperature_celsius)
    }

    /// The fields so far, µT, body frame, as the sensor reads them.
    pub fn fields(&self) -> &[Vector3<f32>] {
        &self.fields
    }

    /// All that there is to keep.
    pub fn record(&self) -> Record {
        Record {
            gyro: self.gyro(),
            accelerometer: self.accelerometer().ok(),
            magnetometer: self.magnetometer().ok(),
        }
    }

    /// The rate in the seconds that were still, °/s (rms).
    pub fn gyro_residual(&self, gyro: &Gyro) -> Residual {
        let off = |bias: Vector3<f32>| {
            rms(self
                .rests
                .iter()
                .map(|rest| (rest.gyro_bias.dps() - bias).norm()))
        };
        Residual {
            before: off(Vector3::zeros()),
            after: off(gyro.bias.dps()),
        }
    }

    /// The length of the force in those seconds less 1 g, m/s² (rms).
    pub fn force_residual(&self, found: &Accelerometer<f32>) -> Residual {
        let g = METRES_PER_S2_PER_G as f32;
        let correct = found.calibration();
        Residual {
            before: rms(self
                .rests
                .iter()
                .map(|rest| rest.force.m_per_s2().norm() - g)),
            after: rms(self
                .rests
                .iter()
                .map(|rest| correct.corrected(rest.force).m_per_s2().norm() - g)),
        }
    }

    /// The length of the field less its mean, per cent of that (rms).
    pub fn field_residual(&self, found: &Magnetometer<f32>) -> Residual {
        let correct = found.calibration();
        let corrected = self.fields.iter().map(|&field| {
            let field = MagneticField::from_microtesla(field);
            correct.corrected(field).microtesla().norm()
        });
        Residual {
            before: scatter(self.fields.iter().map(Vector3::norm)),
            after: scatter(corrected),
        }
    }
}

fn rms(values: impl Iterator<Item = f32>) -> f32 {
    let (count, squares) = values.fold((0_u32, 0.0_f64), |(count, squares), value| {
        (count + 1, squares + f64::from(value).powi(2))
    });
    (squares / f64::from(count.max(1))).sqrt() as f32
}

/// Standard deviation in per cent of the mean.
fn scatter(values: impl Iterator<Item = f32> + Clone) -> f32 {
    let (count, sum) = values
        .clone()
        .fold((0_u32, 0.0_f64), |(count, sum), value| {
            (count + 1, sum + f64::from(value))
        });
    let mean = sum / f64::from(count.max(1));
    100.0 * rms(values.map(|value| value - mean as f32)) / mean as f32
}
