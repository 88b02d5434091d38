//! What does the board say? Reads the stream as a PC does: orientations in, angles out.
//!
//! Run with `cargo emulate --seconds 8 | cargo run --example read_the_stream`, or with a board:
//! `cargo run --example read_the_stream < /dev/ttyACM0`. Expect ten lines of angles a second. If
//! nothing comes, look at the lines that begin with `error:`; they are passed on.

use std::io::{self, BufRead};

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

fn main() -> io::Result<()> {
    let mut count = 0;
    for line in io::stdin().lock().lines() {
        let line = line?;
        let Some(orientation) = orientation(&line) else {
            println!("{line}");
            continue;
        };
        count += 1;
        if count % 10 == 0 {
            // Where the board's own axes point: -z is where a head in front of it looks.
            let forward = orientation * -Vector3::z();
            let up = orientation * Vector3::y();
            let yaw = f64::atan2(-forward.x, -forward.z).to_degrees();
            let pitch = forward.y.clamp(-1.0, 1.0).asin().to_degrees();
            println!(
                "yaw {yaw:7.1}°  pitch {pitch:6.1}°  up {:.2} {:.2} {:.2}",
                up.x, up.y, up.z
            );
        }
    }
    Ok(())
}

/// The orientation in a `QC w x y z` line, normalised again: three decimals have rounded it
/// (course notes, section 5.4).
fn orientation(line: &str) -> Option<UnitQuaternion<f64>> {
    let numbers = line.strip_prefix("QC ")?.split(' ').take(4).map(str::parse);
    let [w, x, y, z] = numbers
        .collect::<Result<Vec<f64>, _>>()
        .ok()?
        .try_into()
        .ok()?;
    Some(UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)))
}
