//! What the errors of tilt and heading say of the gyro's bias while the board moves: they are what the
//! bias adds up to.

use super::super::multiply::Multiply;
use super::super::number::{Q, Wide};
use super::super::vector::Vector;
use super::inclination::Inclination;
use super::parameters::{Rates, samples, seconds, weight};
use crate::fusion::integral::{LARGEST_ERROR, LARGEST_HEADING_ERROR, SECOND};
use crate::fusion::parameters::{DECIMATION, size, tilt_low_pass_weight};
use crate::fusion::{Parameters, Source};
use crate::units::Seconds;
use core::num::NonZeroU32;

/// Gains, and the axes along which an error of tilt is laid to the bias.
#[derive(Clone, Copy, Debug)]
pub struct Integral<M> {
    coefficients: Coefficients<M>,
    /// The world's x and z as the body sees them, low-passed like the error of tilt: the reference says why.
    axes: [Vector<M, 27>; 2],
    /// Whether there are none yet.
    fresh: bool,
    /// What the last bit of an error times its gain has left so far: of tilt about x and z, and of heading.
    remainders: [u32; 3],
    /// Samples since the start, counted in eights.
    age: u32,
    /// Fields since the start that told of the heading.
    fields: u32,
}

#[derive(Clone, Copy, Debug)]
struct Coefficients<M> {
    /// Share of the axes of now in [`DECIMATION`] samples.
    low_pass: Q<M, 32>,
    /// Largest error of tilt, counts of the accelerometer.
    largest: Q<M, 10>,
    /// Gain in [`DECIMATION`] samples, counts of the gyro per count of the accelerometer.
    tilt: Q<M, 34>,
    /// That of the start, times samples.
    tilt_start: Quotient,
    /// Samples in a second.
    tilt_second: NonZeroU32,
    /// Gains in a field, counts of the gyro.
    heading: Q<M, 28>,
    /// That of the start, times fields.
    heading_start: Quotient,
    /// Fields in a second; before so many the heading has not settled.
    field_second: NonZeroU32,
    /// Gain in a field per sample since the last rest, as Q56.
    heading_per_sample: u32,
}

/// A number to be divided by counts: `mantissa` 2^`shift`.
#[derive(Clone, Copy, Debug)]
struct Quotient {
    mantissa: u32,
    shift: u32,
}

impl Quotient {
    /// `least` is the smallest of the counts, for which the quotient has to fit.
    fn new(value: f32, least: NonZeroU32) -> Self {
        let most = i32::MAX as f32 * least.get() as f32;
        let (mut value, mut shift) = (value.min(most), 0);
        while value >= (1_u64 << 32) as f32 && shift < 31 {
            value *= 0.5;
            shift += 1;
        }
        Self {
            mantissa: value as u32,
            shift,
        }
    }

    #[inline(always)]
    fn over(self, count: NonZeroU32) -> i32 {
        ((self.mantissa / count) << self.shift) as i32
    }
}

impl<M: Multiply> Coefficients<M> {
    fn new(parameters: &Parameters<f32>, rates: &Rates) -> Self {
        let block = rates.block(DECIMATION);
        let second = Seconds(SECOND as f32);
        let tilt_start = samples(parameters.tilt_integral_start, rates.sample);
        let tilt = size(parameters.tilt_integral * seconds(block).0) * rates.counts_per_rad_per_s()
            / rates.counts_per_g();
        let heading =
            |gain: f32| size(gain * seconds(rates.field).0) * rates.counts_per_rad_per_s();
        let rest_worth = samples(parameters.rest_worth, rates.sample);
        let a_second = |period| NonZeroU32::new(samples(second, period)).unwrap_or(NonZeroU32::MIN);
        let (tilt_second, field_second) = (a_second(rates.sample), a_second(rates.field));
        let per_sample = heading(parameters.heading_integral) / rest_worth as f32;
        Self {
            low_pass: weight(tilt_low_pass_weight(parameters, seconds(block))),
            largest: Q::nearest(LARGEST_ERROR as f32 * rates.counts_per_g()),
            tilt: Q::nearest(tilt),
            tilt_start: Quotient::new(tilt * (1_u64 << 34) as f32 * tilt_start as f32, tilt_second),
            tilt_second,
            heading: Q::nearest(heading(parameters.heading_integral)),
            heading_start: Quotient::new(
                heading(parameters.heading_integral_start)
                    * (1 << 28) as f32
                    * field_second.get() as f32,
                field_second,
            ),
            field_second,
            // A cast saturates.
            heading_per_sample: (per_sample * (1_u64 << 56) as f32) as u32,
        }
    }
}

impl<M: Multiply> Integral<M> {
    pub fn new(parameters: &Parameters<f32>, rates: &Rates) -> Self {
        Self {
            coefficients: Coefficients::new(parameters, rates),
            axes: [Vector::ZERO; 2],
            fresh: true,
            remainders: [1 << 31; 3],
            age: 0,
            fields: 0,
        }
    }

    pub fn tune(&mut self, parameters: &Parameters<f32>, rates: &Rates) {
        self.coefficients = Coefficients::new(parameters, rates);
    }

    /// Once in a block, at rest or not, but not in the first second, in which the tilt is still being found.
    #[inline(always)]
    pub fn follow(&mut self, inclination: &Inclination<M>) {
        self.age = self.age.saturating_add(DECIMATION);
        if !inclination.is_settled() {
            return;
        }
        let q = inclination.orientation();
        let [now_x, now_z] = [q.world_x(), q.world_z()];
        self.axes = if self.fresh {
            [now_x, now_z]
        } else {
            let low_pass = self.coefficients.low_pass;
            let [x, z] = self.axes;
            [x.towards(now_x, low_pass), z.towards(now_z, low_pass)]
        };
        self.fresh = false;
    }

    /// Then what the error of tilt says of how far the bias is off, counts of the gyro, times the gain, along two
    /// axes of the body.
    #[inline(always)]
    pub fn of_tilt(
        &mut self,
        error: [Q<M, 10>; 2],
        source: Source,
    ) -> [(Q<M, 20>, Vector<M, 27>); 2] {
        let gain = self.tilt_gain(source);
        let [x, z] = error.map(|part| part.limited(self.coefficients.largest));
        let [rest_x, rest_z, _] = &mut self.remainders;
        // b = (−z, x).
        let about_x = carried(rest_x, gain, -z.finer::<18>());
        let about_z = carried(rest_z, gain, x.finer::<18>());
        let [axis_x, axis_z] = self.axes;
        [(about_x, axis_x), (about_z, axis_z)]
    }

    /// With every field that tells of the heading: what its error, a sine, says of the bias, as above, but along
    /// the vertical. None in the compass's first second.
    #[inline(always)]
    pub fn of_heading(&mut self, error: Q<M, 30>, source: Source) -> Option<Q<M, 20>> {
        let gain = self.heading_gain(source)?;
        let largest = const { Q::constant(LARGEST_HEADING_ERROR) };
        let error = error.limited(largest).coarser::<24>();
        let [.., rest] = &mut self.remainders;
        Some(carried(rest, gain, error))
    }

    #[inline(always)]
    fn tilt_gain(&self, source: Source) -> Q<M, 34> {
        let Coefficients {
            tilt,
            tilt_start,
            tilt_second,
            ..
        } = self.coefficients;
        if source != Source::Unmeasured {
            return tilt;
        }
        let start = tilt_start.over(tilt_second.saturating_add(self.age));
        Q::from_bits(tilt.bits().max(start))
    }

    /// None in the compass's first second.
    #[inline(always)]
    fn heading_gain(&mut self, source: Source) -> Option<Q<M, 28>> {
        let Coefficients {
            heading,
            heading_start,
            field_second,
            heading_per_sample,
            ..
        } = self.coefficients;
        self.fields = self.fields.saturating_add(1);
        if self.fields <= field_second.get() {
            return None;
        }
        Some(match source {
            Source::Unmeasured => {
                let start = heading_start.over(field_second.saturating_add(self.fields));
                Q::from_bits(heading.bits().max(start))
            }
            Source::Rest { samples } => {
                let come_back = (u64::from(samples) * u64::from(heading_per_sample)) >> 28;
                let whole = heading.bits();
                Q::from_bits(i32::try_from(come_back).map_or(whole, |part| part.min(whole)))
            }
        })
    }
}

/// A gain times an error. What is rounded off is carried over to the next.
#[inline(always)]
fn carried<M: Multiply, const A: u32, const B: u32>(
    rest: &mut u32,
    gain: Q<M, A>,
    error: Q<M, B>,
) -> Q<M, 20> {
    let product = Wide::<M, 52>::from_bits(i64::from(*rest)).plus(gain, error);
    *rest = product.lower();
    product.upper()
}
