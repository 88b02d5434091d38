//! What does the board say? Reads the stream as a PC does: orientations in, angles out.
//!
//! Run with `cargo emulate --seconds 8 | cargo run --example read_the_stream`, or with a board:
//! `cargo run --example read_the_stream < /dev/ttyACM0`. Expect ten lines of angles a second. If
//! nothing comes, look at the lines that begin with `error:`; they are passed on, as is every other
//! line that is not an orientation.
//!
//! It is made to be copied into a host: a serial line may lose bytes or begin in the middle of a
//! line, so nothing that comes stops it or shows as an angle that is none.

use std::io::{self, BufRead, Write};

use vrduino::nalgebra::{UnitQuaternion, Vector3};
use vrduino::view;

/// No line of the stream is as long; what is gets cut into pieces, lest a line without end fill the
/// memory.
const LONGEST: u64 = 256;

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
        // Who reads our output has seen enough.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        outcome => outcome,
    }
}

fn read(stream: &mut impl BufRead, out: &mut impl Write) -> io::Result<()> {
    let mut count = 0;
    let mut bytes = Vec::new();
    while io::Read::take(&mut *stream, LONGEST).read_until(b'\n', &mut bytes)? > 0 {
        // A byte that is no text is shown as such, and makes of its line no orientation.
        let line = String::from_utf8_lossy(&bytes);
        let line = line.trim_end();
        if let Some(orientation) = orientation(line) {
            count += 1;
            if count % 10 == 0 {
                writeln!(out, "{}", described(orientation))?;
            }
        } else {
            writeln!(out, "{line}")?;
        }
        bytes.clear();
    }
    Ok(())
}

/// The orientation, body to world, in a `QC w x y z` line. None if it is no such line, or one that
/// is no rotation: cut short, all zero, not a number. Three decimals have rounded it, so
/// `from_stream` makes it of unit length again (course notes, section 5.4).
fn orientation(line: &str) -> Option<UnitQuaternion<f64>> {
    let numbers = line.strip_prefix("QC ")?.split(' ').map(str::parse);
    let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().ok()?;
    view::from_stream(numbers.try_into().ok()?).ok()
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
