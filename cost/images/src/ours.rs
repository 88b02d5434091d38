//! The library's filters.

use crate::filter::{BIAS_DPS, BIAS_PARTS, Counts, Filter, PERIOD_S, RANGES};
use crate::head::FIELD_EVERY;
use vrduino::calibration::GyroBias;
use vrduino::fixed::complementary::{self as fixed, Bias, Nanoseconds};
use vrduino::fixed::fusion::{self, Field};
use vrduino::fixed::multiply::Multiply;
use vrduino::fusion::{Fusion, Parameters, Rates};
use vrduino::nalgebra::{RealField, UnitQuaternion, Vector3, convert, try_convert};
use vrduino::orientation::complementary::Complementary;
use vrduino::orientation::{DEFAULT_TIME_CONSTANT, TimeConstant};
use vrduino::sensor::magnetometer::{RawField, Resolution, SensitivityAdjustment};
use vrduino::units::{AngularRate, Seconds};

/// The notes' filter in fixed point.
pub struct CourseInFixedPoint<M>(fixed::Complementary<M>);

impl<M: Multiply> Filter for CourseInFixedPoint<M> {
    fn start() -> Self {
        let mut filter = fixed::Complementary::with(&fixed::Parameters {
            gyro: RANGES.gyro,
            sample_period: Nanoseconds(1_000_000),
            time_constant: DEFAULT_TIME_CONSTANT,
        });
        filter.set_bias(Bias::from_parts_of_counts(BIAS_PARTS));
        Self(filter)
    }

    #[inline(always)]
    fn update(&mut self, counts: &Counts) {
        self.0.update(&counts.sample);
    }

    fn orientation(&self) -> [f64; 4] {
        self.0
            .bits()
            .map(|bits| f64::from(bits) / f64::from(1 << 30))
    }
}

/// The notes' filter as it is read.
pub struct Course<T: RealField> {
    bias: GyroBias<T>,
    filter: Complementary<T>,
}

impl<T: RealField + Copy> Filter for Course<T> {
    fn start() -> Self {
        let time = Seconds(convert(f64::from(DEFAULT_TIME_CONSTANT.time().0)));
        let filter = Complementary::new(TimeConstant::new(time), Seconds(convert(PERIOD_S)));
        let dps = Vector3::from(BIAS_DPS.map(convert));
        Self {
            bias: GyroBias::new(AngularRate::from_dps(dps)),
            filter,
        }
    }

    #[inline]
    fn update(&mut self, counts: &Counts) {
        let reading = self.bias.correct(RANGES.sample(&counts.sample));
        self.filter.update(&reading);
    }

    fn orientation(&self) -> [f64; 4] {
        parts(self.filter.orientation())
    }
}

/// The default estimator as it is read; with the magnetometer if `COMPASS`.
pub struct Default<T: RealField, const COMPASS: bool>(Fusion<T>);

impl<T: RealField + Copy, const COMPASS: bool> Filter for Default<T, COMPASS> {
    fn start() -> Self {
        let rates = Rates {
            sample: Seconds(convert(PERIOD_S)),
            field: Seconds(convert(PERIOD_S * FIELD_EVERY as f64)),
        };
        Self(Fusion::new(&Parameters::default(), rates))
    }

    #[inline]
    fn update(&mut self, counts: &Counts) {
        let field = (COMPASS && counts.field_is_new)
            .then(|| {
                let raw = RawField {
                    counts: counts.field,
                    resolution: Resolution::Bits16,
                    overflow: false,
                };
                raw.field(SensitivityAdjustment::NONE).ok()
            })
            .flatten();
        self.0.update(&RANGES.sample(&counts.sample), field);
    }

    fn orientation(&self) -> [f64; 4] {
        parts(self.0.orientation())
    }
}

/// The default estimator in fixed point; with the magnetometer if `COMPASS`.
pub struct DefaultInFixedPoint<M, const COMPASS: bool>(fusion::Fusion<M>);

impl<M: Multiply, const COMPASS: bool> Filter for DefaultInFixedPoint<M, COMPASS> {
    fn start() -> Self {
        let rates = fusion::Rates {
            sample: Nanoseconds(1_000_000),
            field: Nanoseconds(1_000_000 * FIELD_EVERY as u32),
            ranges: RANGES,
        };
        Self(fusion::Fusion::with(&Parameters::default(), rates))
    }

    #[inline(always)]
    fn update(&mut self, counts: &Counts) {
        let field = (COMPASS && counts.field_is_new).then(|| {
            // 0.15 µT are 24576/5 of its parts; from the magnetometer's axes to the body's.
            let [x, y, z] = counts.field;
            let parts = |count: i16| i32::from(count) * 24_576 / 5;
            Field::from_parts_of_microtesla([parts(y), parts(x), -parts(z)])
        });
        self.0.update(&counts.sample, field);
    }

    fn orientation(&self) -> [f64; 4] {
        self.0
            .bits()
            .map(|bits| f64::from(bits) / f64::from(1 << 30))
    }
}

fn parts<T: RealField + Copy>(q: UnitQuaternion<T>) -> [f64; 4] {
    [q.w, q.i, q.j, q.k].map(|part| try_convert(part).unwrap_or(f64::NAN))
}
