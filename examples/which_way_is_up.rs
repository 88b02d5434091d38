//! Which way is up? The tracker's library on made-up samples, without board or emulator.
//!
//! Run with `cargo run --example which_way_is_up`. A board lies still on its right side for a second and
//! is then set upright in another. Expect the quaternion to go from `0.707 0 0 -0.707`, a roll of -90°,
//! to `1 0 0 0`, and up to end on the board's y axis. If it ends elsewhere, an axis or a sign is wrong.

#[path = "program/mod.rs"]
mod program;

use std::error::Error;
use std::fmt::Write as _;
use std::process::ExitCode;

use vrduino::imu::RANGES;
use vrduino::sensor::RawSample;
use vrduino::tracker::{Health, Tracker};

/// Counts of 1 g at ±16 g.
const ONE_G: f64 = 2048.0;
/// Counts of 1 °/s at ±2000 °/s.
const ONE_DPS: f64 = 16.384;

fn main() -> ExitCode {
    program::run(include_str!("which_way_is_up.rs"), 0, run)
}

fn run(text: &mut String) -> Result<(), Box<dyn Error>> {
    let mut tracker = Tracker::new(RANGES);
    for millisecond in 0..2500 {
        // 90°/s about z for the second from 1.2 s on.
        let turning = (1200..2200).contains(&millisecond);
        let roll = (f64::from((millisecond - 1200).clamp(0, 1000)) * 0.09 - 90.0).to_radians();
        let up_in_body = [roll.sin(), roll.cos(), 0.0];
        let raw = RawSample {
            gyro: [0, 0, if turning { (90.0 * ONE_DPS) as i16 } else { 0 }],
            accel: up_in_body.map(|component| (component * ONE_G).round() as i16),
            temperature: 0,
            fresh: true,
        };
        tracker.update(&raw, None, &Health::default(), &mut |line| {
            // Text as it comes, orientations ten times a second.
            if !line.starts_with("QC") || millisecond % 100 == 9 {
                text.push_str(&format!("{:5} ms  {line}", millisecond + 1));
            }
        });
    }
    let up = tracker.orientation().inverse() * nalgebra::Vector3::y();
    writeln!(
        text,
        "up, seen from the board: {:.3} {:.3} {:.3}",
        up.x, up.y, up.z
    )?;
    Ok(())
}
