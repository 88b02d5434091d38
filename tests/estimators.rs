//! Flatland and the angles of the accelerometer follow the course notes, and no input makes them
//! return anything but angles.

mod rotations;

use nalgebra::{RealField, UnitQuaternion, Vector3, convert};
use rotations::{Random, anything, reading};
use std::f64::consts::{FRAC_PI_2, PI};
use vrduino::orientation::TimeConstant;
use vrduino::orientation::angles::pitch_and_roll;
use vrduino::orientation::flatland::Flatland;
use vrduino::units::{Seconds, SpecificForce};

const G: f64 = 9.81;
const DT: f64 = 0.001;

fn survives_anything<T: RealField + Copy>() {
    let mut random = Random(14);
    let finite = |angle: T| assert!(angle.is_finite());
    for round in 0..100 {
        let (tau, dt) = match round {
            0 => (7.6, DT),
            1 => (7.6, 1e30),
            2 => (0.0, DT),
            3 => (-DT, DT),
            _ => (anything(&mut random), anything(&mut random)),
        };
        let (tau, dt) = (convert::<f64, T>(tau), Seconds(convert::<f64, T>(dt)));
        let mut flat = Flatland::new(TimeConstant::new(Seconds(tau)), dt);
        for _ in 0..1000 {
            let rate = [(); 3].map(|()| anything(&mut random));
            let force = [(); 3].map(|()| anything(&mut random));
            let reading = reading::<T>(rate, force);
            let roll = flat.update(&reading);
            for angle in [roll.gyro, roll.accelerometer, roll.fused] {
                finite(angle.rad());
            }
            let tilt = pitch_and_roll(reading.force());
            finite(tilt.pitch.rad());
            finite(tilt.roll.rad());
            if random.unit() < 0.01 {
                flat.reset(reading.force());
            }
        }
    }
}

#[test]
fn no_input_makes_anything_but_angles() {
    survives_anything::<f32>();
    survives_anything::<f64>();
}

#[test]
fn pitch_and_roll_rebuild_the_force_everywhere() {
    let mut random = Random(15);
    for _ in 0..10_000 {
        let a = Vector3::<f64>::from(random.vector(10.0));
        let tilt = pitch_and_roll(SpecificForce::from_m_per_s2(a));
        let (x, z) = (tilt.pitch.rad(), tilt.roll.rad());
        assert!(x.abs() <= FRAC_PI_2 && z.abs() <= PI);
        // Eq. 10.
        let rebuilt = Vector3::new(x.cos() * z.sin(), x.cos() * z.cos(), -x.sin());
        assert!((rebuilt - a.normalize()).amax() < 1e-12);
    }
}

#[test]
fn pitch_and_roll_are_those_of_the_orientation() {
    let (pitch, roll) = (10.0_f64.to_radians(), 170.0_f64.to_radians());
    let x = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), pitch);
    let z = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), roll);
    let a = (x * z).inverse() * Vector3::y();
    let tilt = pitch_and_roll(SpecificForce::from_m_per_s2(a * G));
    assert!((tilt.pitch.degrees() - 10.0).abs() < 1e-9);
    assert!((tilt.roll.degrees() - 170.0).abs() < 1e-9);
}

#[test]
fn flatland_blends_across_the_seam() {
    // α = 0.9; the gyro stands at 179°, the accelerometer says −179°: 179.2°, not 143.2°.
    let tau = TimeConstant::from_gyro_weight(0.9, Seconds(0.01));
    let mut flat = Flatland::new(tau, Seconds(0.01));
    let at = |degrees: f64| {
        let (s, c) = degrees.to_radians().sin_cos();
        [G * s, G * c, 0.0]
    };
    flat.reset(reading::<f64>([0.0; 3], at(179.0)).force());
    let roll = flat.update(&reading([0.0; 3], at(-179.0)));
    assert!((roll.fused.degrees() - 179.2).abs() < 1e-9);
    assert!((roll.accelerometer.degrees() + 179.0).abs() < 1e-9);
    assert!((roll.gyro.degrees() - 179.0).abs() < 1e-9);
}

#[test]
fn flatland_follows_eq_7_to_9() {
    let alpha = 0.98;
    let mut flat = Flatland::new(
        TimeConstant::from_gyro_weight(alpha, Seconds(DT)),
        Seconds(DT),
    );
    let (mut gyro, mut fused) = (0.0, 0.0);
    for i in 0..2000 {
        let t = f64::from(i) * DT;
        let (truth, rate) = ((2.0 * t).sin(), 2.0 * (2.0 * t).cos() + 0.1);
        let force = [G * truth.sin(), G * truth.cos(), 3.0];
        let roll = flat.update(&reading::<f64>([5.0, -5.0, rate], force));
        gyro += rate * DT;
        fused = alpha * (fused + rate * DT) + (1.0 - alpha) * force[0].atan2(force[1]);
        assert!((roll.gyro.rad() - gyro).abs() < 1e-9);
        assert!((roll.accelerometer.rad() - truth).abs() < 1e-9);
        assert!((roll.fused.rad() - fused).abs() < 1e-9);
    }
}
