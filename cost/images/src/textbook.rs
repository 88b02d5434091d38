//! The course's filter as a student writes it from the notes: angle and axis, sine and cosine, arc cosine, a quaternion
//! product for each step, and every value in the units of the page.

use crate::filter::{BIAS_DPS, Counts, Filter, PERIOD_S};
use nalgebra::{RealField, convert, try_convert};

/// The weight of the gyro, eq. 24: that of a time constant of 7.6 s.
const ALPHA: f64 = 7.6 / (7.6 + PERIOD_S);

/// w, x, y, z.
type Quaternion<T> = [T; 4];

/// In double precision as the course does it, or in single.
pub struct Textbook<T> {
    q: Quaternion<T>,
}

impl<T: RealField + Copy> Filter for Textbook<T> {
    fn start() -> Self {
        let (one, zero) = (T::one(), T::zero());
        Self {
            q: [one, zero, zero, zero],
        }
    }

    #[inline]
    fn update(&mut self, counts: &Counts) {
        let number = |value: f64| convert::<f64, T>(value);
        let count = |count: i16| convert::<f32, T>(f32::from(count));
        let zero = T::zero();
        let [gx, gy, gz] = counts.sample.gyro.map(count);
        let [ax, ay, az] = counts.sample.accel.map(count);

        // Eq. 5, and the bias.
        let dps = |raw: T, bias: f64| raw * number(2000.0 / 32768.0) - number(bias);
        let (gx, gy, gz) = (
            dps(gx, BIAS_DPS[0]),
            dps(gy, BIAS_DPS[1]),
            dps(gz, BIAS_DPS[2]),
        );
        let g = |raw: T| raw * number(2.0 / 32768.0);
        let (ax, ay, az) = (g(ax), g(ay), g(az));

        // Eq. 17 and 18.
        let length = (gx * gx + gy * gy + gz * gz).sqrt();
        if length > number(1e-8) {
            let axis = [gx / length, gy / length, gz / length];
            let turn = from_angle_axis(length * number(PERIOD_S), axis);
            self.q = product(self.q, turn);
        }

        // Eq. 20.
        let a = product(product(self.q, [zero, ax, ay, az]), inverse(self.q));
        let length = (a[1] * a[1] + a[2] * a[2] + a[3] * a[3]).sqrt();
        let v = [a[1] / length, a[2] / length, a[3] / length];

        // Eq. 21 to 24.
        let tilt = v[1].min(T::one()).acos() * number(180.0) / T::pi();
        let n = [-v[2], zero, v[0]];
        let length = (n[0] * n[0] + n[2] * n[2]).sqrt();
        if length > number(1e-8) {
            let axis = [n[0] / length, zero, n[2] / length];
            let turn = from_angle_axis(number(1.0 - ALPHA) * tilt, axis);
            self.q = product(turn, self.q);
        }
        self.q = normalised(self.q);
    }

    fn orientation(&self) -> [f64; 4] {
        self.q.map(|part| try_convert(part).unwrap_or(f64::NAN))
    }
}

/// An angle in degrees.
fn from_angle_axis<T: RealField + Copy>(degrees: T, axis: [T; 3]) -> Quaternion<T> {
    let half = degrees * T::pi() / convert(180.0) / convert(2.0);
    let (sine, cosine) = (half.sin(), half.cos());
    [cosine, axis[0] * sine, axis[1] * sine, axis[2] * sine]
}

fn product<T: RealField + Copy>(p: Quaternion<T>, q: Quaternion<T>) -> Quaternion<T> {
    [
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    ]
}

fn squared<T: RealField + Copy>(q: Quaternion<T>) -> T {
    q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]
}

fn inverse<T: RealField + Copy>(q: Quaternion<T>) -> Quaternion<T> {
    let squared = squared(q);
    [
        q[0] / squared,
        -q[1] / squared,
        -q[2] / squared,
        -q[3] / squared,
    ]
}

fn normalised<T: RealField + Copy>(q: Quaternion<T>) -> Quaternion<T> {
    let length = squared(q).sqrt();
    q.map(|part| part / length)
}
