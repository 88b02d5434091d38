//! The built-in motion: a head that looks around, for ever.

use std::f64::consts::TAU;

use super::rotation::{about, cross, gravity_in_body, multiply};
use super::{Instant, Motion};

/// How long the head is level and still before it moves (s).
///
/// Long enough for a firmware that averages its gyroscope at rest when it starts.
pub const STILL: f64 = 3.0;

/// How long the movement takes to grow to its full size (s).
const GROWTH: f64 = 4.0;

/// One swing: amplitude (°) and frequency (Hz).
type Swing = (f64, f64);

// The amplitudes add up to the largest angle of each axis. The frequencies have no common period,
// so that the motion does not repeat; none is above 0.8 Hz, where voluntary head movement fades.
// Together they reach about 220 °/s, a quick but not hasty turn of the head.
const YAW: [Swing; 3] = [(34.0, 0.317), (18.0, 0.541), (8.0, 0.773)];
const PITCH: [Swing; 2] = [(16.0, 0.271), (9.0, 0.619)];
const ROLL: [Swing; 2] = [(10.0, 0.199), (5.0, 0.467)];

/// A head that is still and level for [`STILL`] seconds and then looks around without end: yaw to
/// ±60°, pitch to ±25°, roll to ±15°.
///
/// The attitude body → world is yaw about y, then pitch about x, then roll about z, each in the
/// turned frame. Its angular rate is the analytic derivative, no difference quotient; the truth is
/// exact. The body axes are x right, y up, z towards the wearer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Head {
    /// From the neck's joint to the sensor (m), in the body frame.
    ///
    /// Zero, the default, makes the accelerometer feel gravity alone. [`Head::ON_THE_NECK`] adds the
    /// acceleration of a sensor that is carried around the neck.
    pub lever_arm: [f64; 3],
}

impl Head {
    /// A lever arm as of a headset: 12 cm above the neck's joint and 10 cm in front of it.
    pub const ON_THE_NECK: [f64; 3] = [0.0, 0.12, -0.10];

    /// A head that turns about the sensor itself.
    pub const fn new() -> Self {
        Self {
            lever_arm: [0.0; 3],
        }
    }
}

impl Default for Head {
    fn default() -> Self {
        Self::new()
    }
}

impl Motion for Head {
    fn at(&self, t: f64) -> Instant {
        let (attitude, rate) = turning(t);
        let mut force = gravity_in_body(attitude);
        let carried = lever_acceleration(t, rate, self.lever_arm);
        for (f, a) in force.iter_mut().zip(carried) {
            *f += a;
        }
        Instant {
            rate,
            force,
            field: None,
            truth: Some(attitude),
        }
    }

    fn duration(&self) -> Option<f64> {
        None
    }

    fn describe(&self) -> String {
        format!("generated head motion, still for {STILL} s and then without end")
    }
}

/// Attitude body → world, and angular rate in the body frame (rad/s).
fn turning(t: f64) -> ([f64; 4], [f64; 3]) {
    let moved = (t - STILL).max(0.0);
    let (yaw, yaw_rate) = swing(&YAW, moved);
    let (pitch, pitch_rate) = swing(&PITCH, moved);
    let (roll, roll_rate) = swing(&ROLL, moved);

    let attitude = multiply(
        about([0.0, 1.0, 0.0], yaw),
        multiply(about([1.0, 0.0, 0.0], pitch), about([0.0, 0.0, 1.0], roll)),
    );
    // Each rate about its own axis, carried into the body frame by the turns that follow it.
    let (sin_pitch, cos_pitch) = pitch.sin_cos();
    let (sin_roll, cos_roll) = roll.sin_cos();
    let [x, y, z] = [pitch_rate, cos_pitch * yaw_rate, -sin_pitch * yaw_rate];
    let rate = [
        cos_roll * x + sin_roll * y,
        -sin_roll * x + cos_roll * y,
        z + roll_rate,
    ];
    (attitude, rate)
}

/// Angle (rad) and its derivative (rad/s) of a sum of swings, `t` seconds after it began.
fn swing(swings: &[Swing], t: f64) -> (f64, f64) {
    let (size, growth) = grown(t);
    let (mut angle, mut rate) = (0.0, 0.0);
    for &(amplitude, frequency) in swings {
        let (sin, cos) = (TAU * frequency * t).sin_cos();
        let amplitude = amplitude.to_radians();
        angle += size * amplitude * sin;
        rate += growth * amplitude * sin + size * amplitude * TAU * frequency * cos;
    }
    (angle, rate)
}

/// The size of the movement, 0 to 1, and its derivative (1/s): the quintic 10s³ − 15s⁴ + 6s⁵, whose
/// first two derivatives vanish at both ends, so that neither rate nor acceleration jumps.
fn grown(t: f64) -> (f64, f64) {
    let s = (t / GROWTH).clamp(0.0, 1.0);
    let size = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    let growth = 30.0 * s * s * (1.0 - s) * (1.0 - s) / GROWTH;
    (size, growth)
}

/// Acceleration of a point carried at `arm` (m) from the centre of the turn: ω̇ × r + ω × (ω × r)
/// (m/s²), all in the body frame.
fn lever_acceleration(t: f64, rate: [f64; 3], arm: [f64; 3]) -> [f64; 3] {
    // The rate is exact, so a symmetric difference of it over this step is good to 1e-7 rad/s².
    const STEP: f64 = 1e-4;
    let (earlier, later) = (turning(t - STEP).1, turning(t + STEP).1);
    let angular: [f64; 3] = std::array::from_fn(|i| (later[i] - earlier[i]) / (2.0 * STEP));
    let tangential = cross(angular, arm);
    let centripetal = cross(rate, cross(rate, arm));
    std::array::from_fn(|i| tangential[i] + centripetal[i])
}
