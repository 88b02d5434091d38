//! What does the board say? Reads the stream as a PC does: orientations in, angles out.
//!
//! Run with `cargo emulate --seconds 8 | cargo run --example read_the_stream`, or with a board:
//! `cargo run --example read_the_stream < /dev/ttyACM0`. Expect ten lines of angles a second, however the
//! board was told to send them (`cargo emulate --seconds 8 --type $':stream binary\n@1'`). If
//! nothing comes, look at the lines that begin with `error:`; they are passed on, as is every other
//! line that is not an orientation. What was lost on the way is told at the end, on standard error.
//!
//! It is made to be copied into a host: a serial line may lose bytes or begin in the middle of a
//! line, so nothing that comes stops it or shows as an angle that is none.

use std::io::{self, Read, Write};
use std::time::Duration;

use vrduino::nalgebra::{UnitQuaternion, Vector3};
use vrduino::wire::decoder::{Decoder, Event, Losses, Received};

/// Between two lines of angles.
const PAUSE: Duration = Duration::from_millis(100);

/// From one orientation to the next where they come without a time.
const USUAL: Duration = Duration::from_millis(10);

fn main() -> io::Result<()> {
    if std::env::args()
        .nth(1)
        .is_some_and(|argument| argument == "--help")
    {
        let source = include_str!("read_the_stream.rs").lines();
        return source
            .map_while(|line| line.strip_prefix("//!"))
            .try_for_each(|line| writeln!(io::stdout(), "{}", line.trim_start()));
    }
    match read(&mut io::stdin().lock(), &mut io::stdout().lock()) {
        Ok(losses) => writeln!(io::stderr(), "{}", lost(&losses)),
        // Who reads our output has seen enough.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        Err(error) => Err(error),
    }
}

fn read(stream: &mut impl Read, out: &mut impl Write) -> io::Result<Losses> {
    let mut decoder = Decoder::new();
    let mut shown = Shown::default();
    let mut bytes = [0; 4096];
    loop {
        let count = match stream.read(&mut bytes) {
            Ok(0) => return Ok(*decoder.losses()),
            Ok(count) => count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        for &byte in &bytes[..count] {
            match decoder.push(byte) {
                Some(Event::Orientation(received)) if shown.is_due(&received) => {
                    writeln!(out, "{}", described(received.orientation))?;
                }
                Some(Event::Text(line)) => writeln!(out, "{line}")?,
                _ => {}
            }
        }
    }
}

/// How long ago the last line of angles was, by the board's clock.
#[derive(Default)]
struct Shown {
    ago: Duration,
    micros: Option<u32>,
}

impl Shown {
    fn is_due(&mut self, received: &Received) -> bool {
        let micros = received.stamp.map(|stamp| stamp.micros);
        let since = match (self.micros, micros) {
            (Some(before), Some(now)) => Duration::from_micros(now.wrapping_sub(before).into()),
            _ => USUAL,
        };
        self.micros = micros;
        self.ago += since;
        let due = self.ago >= PAUSE;
        if due {
            self.ago = Duration::ZERO;
        }
        due
    }
}

fn lost(losses: &Losses) -> String {
    let Losses {
        bytes,
        damaged,
        malformed,
        missing,
        ..
    } = losses;
    format!(
        "lost: {bytes} bytes, {damaged} with a wrong checksum, {malformed} malformed, {missing} missing"
    )
}

/// Where the board's own axes point: −z is where a head in front of it looks.
fn described(orientation: UnitQuaternion<f64>) -> String {
    let ahead = orientation * -Vector3::z();
    let up = orientation * Vector3::y();
    let yaw = f64::atan2(-ahead.x, -ahead.z).to_degrees();
    let pitch = ahead.y.clamp(-1.0, 1.0).asin().to_degrees();
    let [yaw, pitch] = [yaw, pitch].map(|angle| rounded(angle, 1));
    let [x, y, z] = [up.x, up.y, up.z].map(|component| rounded(component, 2));
    format!("yaw {yaw:7.1}°  pitch {pitch:6.1}°  up {x:.2} {y:.2} {z:.2}")
}

/// To so many decimals, and zero without the sign that would show as −0.0.
fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10_f64.powi(decimals);
    (value * scale).round() / scale + 0.0
}
