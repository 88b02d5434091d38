//! From rates to the half angles of a sample (course notes, eq. 17).

use super::multiply::Multiply;
use super::number::{Q, Wide};
use super::vector::Vector;
use crate::sensor::GyroRange;
use crate::units::RADIANS_PER_DEGREE;

/// The time from one sample to the next in nanoseconds.
///
/// Single precision would keep seven digits of it, and a gyro that turned by 6000° would be off by a
/// thousandth of a degree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nanoseconds(pub u32);

/// Half the angle of one sample, in radians per count. At most 6.7 ms at ±2000 °/s and in proportion more
/// at the others, 53 ms at ±250 °/s: a longer period is taken for that.
pub fn half_angle_per_count<M: Multiply>(range: GyroRange, period: Nanoseconds) -> Q<M, 49> {
    let product = half_angle_per_nanosecond(range) * u64::from(period.0);
    let half_angle = (product + (1 << 22)) >> 23;
    // A sixteenth less than what fits, for what a tangent is longer than its angle.
    Q::from_bits(half_angle.min(15 << 27) as i32)
}

/// Half a radian per second and count, as Q72 per nanosecond: ½ max_range / 2¹⁵ 10⁻⁹ 2⁷².
const fn half_angle_per_nanosecond(range: GyroRange) -> u64 {
    const PER_DPS: f64 = 0.5 * RADIANS_PER_DEGREE * 1e-9 * (1_u64 << 57) as f64;
    const fn of(dps: f64) -> u64 {
        (dps * PER_DPS + 0.5) as u64
    }
    match range {
        GyroRange::Dps250 => const { of(GyroRange::Dps250.max_dps()) },
        GyroRange::Dps500 => const { of(GyroRange::Dps500.max_dps()) },
        GyroRange::Dps1000 => const { of(GyroRange::Dps1000.max_dps()) },
        GyroRange::Dps2000 => const { of(GyroRange::Dps2000.max_dps()) },
    }
}

/// What the half angles of the samples so far have left below the last bit of theirs, as Q64.
#[derive(Clone, Copy, Debug)]
pub struct Remainders([u32; 3]);

impl Remainders {
    /// Half of the last bit kept.
    pub const START: Self = Self([1 << 31; 3]);

    /// n φ/2 of eq. 17 for a rate in counts. What is rounded off is carried over to the next sample.
    #[inline(always)]
    pub fn half_angle<M: Multiply>(
        &mut self,
        rate: Vector<M, 15>,
        half_angle_per_count: Q<M, 49>,
    ) -> Vector<M, 32> {
        let [rest_x, rest_y, rest_z] = &mut self.0;
        let of = |rate: Q<M, 15>, rest: &mut u32| {
            let angle = Wide::<M, 64>::from_bits(i64::from(*rest)).plus(rate, half_angle_per_count);
            *rest = angle.lower();
            angle.upper()
        };
        Vector::new(of(rate.x, rest_x), of(rate.y, rest_y), of(rate.z, rest_z))
    }
}
