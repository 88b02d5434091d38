//! No input makes flatland and the angles of the accelerometer anything but angles.

mod matrices;

mod random;

mod rotations;

use nalgebra::RealField;
use rotations::{Random, anything, reading, times};
use vrduino::orientation::angles::pitch_and_roll;
use vrduino::orientation::flatland::Flatland;

fn survives_anything<T: RealField + Copy>() {
    let mut random = Random(14);
    let finite = |angle: T| assert!(angle.is_finite());
    for round in 0..100 {
        let (tau, dt) = times::<T>(round, &mut random);
        let mut flat = Flatland::new(tau, dt);
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
