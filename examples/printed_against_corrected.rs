//! What difference do the misprints make? Some rows of `docs/errata.md`, as printed in the course
//! notes (000) and the gyroscope-emulation paper (002) and as the library has them.
//!
//! Run with `cargo run --example printed_against_corrected`. Expect a table of both numbers; the
//! picture has eq. 11 beside eq. 12 of the notes (section 4), wrong wherever the board is upside down.

use std::error::Error;
use std::f64::consts::TAU;
use std::fmt::{self, Write as _};
use std::process::ExitCode;

use nalgebra::{UnitQuaternion, Vector3};
use picture::{Line, Look, Picture, Scale};
use vrduino::orientation::angles::{PitchRoll, pitch_and_roll, pitch_full_circle};
use vrduino::orientation::flatland::shortest_turn;
use vrduino::orientation::quaternion::axis_angle;
use vrduino::orientation::tilt;
use vrduino::sensor::{AccelRange, GyroRange, Ranges, RawSample};
use vrduino::units::{Angle, SpecificForce};
use vrduino::virtual_gyro::butterworth::{Coefficients, CutOff};
use vrduino::virtual_gyro::{TaitBryan, attitude_quaternion};

#[path = "picture/mod.rs"]
mod picture;

#[path = "program/mod.rs"]
mod program;

fn main() -> ExitCode {
    program::run(include_str!("printed_against_corrected.rs"), 0, run)
}

fn run(text: &mut String) -> Result<(), Box<dyn Error>> {
    writeln!(
        text,
        "place                                       printed    corrected"
    )?;
    let mut row = |place: &str, [printed, corrected]: [f64; 2]| -> fmt::Result {
        writeln!(text, "{place:38} {printed:12.5} {corrected:12.5}")
    };
    row("000 eq. 5: count -32768 at 250 °/s", full_scale())?;
    row("000 eq. 9: 179° and -179°, weight 0.9", seam())?;
    row("000 eq. 23: tilt 1e-4 rad, f32 (rad)", small_tilt())?;
    row("000 eq. 36: 10° turn written as -q (°)", double_cover())?;
    let gain = cut_off().ok_or("no such cut-off")?;
    row("002 3.2.1: gain at the cut-off 0.02 F_e", gain)?;
    row("002 3.6: q of φ, θ, ψ, off by (°)", order())?;

    let rolls = || (-180..=180).map(f64::from);
    let points = |which: usize| rolls().map(|roll| [roll, rebuilt(roll)[which]]).collect();
    let worst = rolls().fold([0.0_f64; 2], |most, roll| {
        let [printed, corrected] = rebuilt(roll);
        [most[0].max(printed), most[1].max(corrected)]
    });
    row("000 eq. 11, 12: up rebuilt, off by (°)", worst)?;
    let lines = [("printed", 0), ("corrected", 1)];
    let lines = lines.map(|(name, which)| Line {
        name,
        points: points(which),
    });
    let look = Look {
        scales: [Scale::Circle, Scale::Even],
        strokes: &[],
    };
    let picture = Picture {
        title: "Up rebuilt from pitch and roll of eq. 11 and 12 at a pitch of 10°: how far off",
        x: "roll (°)",
        y: "off by (°)",
        lines: lines.into(),
    };
    Ok(writeln!(
        text,
        "{}",
        picture
            .save_with("printed_against_corrected", &look)?
            .display()
    )?)
}

fn full_scale() -> [f64; 2] {
    let (gyro, accel) = (GyroRange::Dps250, AccelRange::G2);
    let mut raw = RawSample::default();
    raw.gyro[0] = i16::MIN;
    let corrected = Ranges { gyro, accel }.sample::<f64>(&raw).rate.dps().x;
    let largest = f64::from(i16::MAX);
    [f64::from(i16::MIN) / largest * gyro.max_dps(), corrected]
}

fn seam() -> [f64; 2] {
    let (gyro, accelerometer, alpha) = (179.0, -179.0, 0.9);
    let [from, to] = [gyro, accelerometer].map(Angle::from_degrees);
    let corrected = gyro + (1.0 - alpha) * shortest_turn(from, to).degrees();
    [alpha * gyro + (1.0 - alpha) * accelerometer, corrected]
}

fn small_tilt() -> [f64; 2] {
    let (sin, cos) = 1e-4_f32.sin_cos();
    let up = SpecificForce::from_m_per_s2(Vector3::new(sin, cos, 0.0));
    [cos.acos(), tilt::correction(up, 1.0).angle()].map(f64::from)
}

fn double_cover() -> [f64; 2] {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 10_f64.to_radians());
    let q = UnitQuaternion::new_unchecked(-turn.into_inner());
    [2.0 * q.w.acos().to_degrees(), axis_angle(q).angle.degrees()]
}

fn cut_off() -> Option<[f64; 2]> {
    let right = Coefficients::new(CutOff::new(0.02)?);
    let (sin, cos) = (TAU * 0.02).sin_cos();
    let size = |a: f64, b: f64| (a + b * cos).hypot(b * sin);
    let gain = |[b0, b1, a1]: [f64; 3]| size(b0, b1) / size(1.0, a1);
    Some([[0.0305, 0.0305, -0.9391], [right.b0, right.b1, right.a1]].map(gain))
}

fn order() -> [f64; 2] {
    let angles = TaitBryan::from_rad(0.3, -0.4, 1.1);
    let about = |axis, angle: Angle<f64>| UnitQuaternion::from_axis_angle(&axis, angle.rad());
    let printed = about(Vector3::x_axis(), angles.roll)
        * about(Vector3::y_axis(), angles.pitch)
        * about(Vector3::z_axis(), angles.yaw);
    // R is reference to device, a quaternion of the paper device to reference.
    let right = UnitQuaternion::from_rotation_matrix(&angles.matrix().inverse());
    let corrected = attitude_quaternion::from_angles(&angles);
    [printed, corrected].map(|q| q.angle_to(&right).to_degrees())
}

/// How far from what was measured the up is that the angles of eq. 11 and 12 describe (°).
fn rebuilt(roll: f64) -> [f64; 2] {
    let (pitch, roll) = (Angle::from_degrees(10.0), Angle::from_degrees(roll));
    let up = PitchRoll { pitch, roll }.up_in_body();
    let force = SpecificForce::from_m_per_s2(up);
    let corrected = pitch_and_roll(force);
    // Eq. 11 with the sign of a_y, and eq. 12 with atan2.
    let printed = PitchRoll {
        pitch: pitch_full_circle(force),
        ..corrected
    };
    [printed, corrected].map(|angles| angles.up_in_body().angle(&up).to_degrees())
}
