//! Whether the stream is what it should be.

use vrduino::units::METRES_PER_S2_PER_G;

use super::check::Report;
use super::watch::Seen;

/// Samples a second: the sensor's clock may be 1 % off (data sheet), and some.
const RATE: std::ops::RangeInclusive<f64> = 980.0..=1020.0;

/// Of 30 fraction bits, rounded.
const LENGTH_ERROR: f64 = 1e-6;

/// How far the force at rest may be off 1 g, m/s²: what the data sheet allows a sensor that is not
/// calibrated (0.8 of bias and 3 %), and beyond.
const GRAVITY_DOUBT: f64 = 0.15;
const GRAVITY_BAD: f64 = 1.2;

/// How far a board at rest may turn, degrees a minute.
const DRIFT: f64 = 6.0;

/// Looks at it.
pub fn look(seen: &Seen, calibrated: bool, emulated: bool, report: &mut Report) {
    let Some([first, last]) = &seen.ends else {
        return;
    };
    let seconds = last.time - first.time;
    if seconds < 1.0 {
        report.bad(
            format!("only {} samples came", seen.samples),
            "unplug the board and plug it in again",
        );
        return;
    }
    rate(
        seen,
        seconds,
        last.arrival - first.arrival,
        emulated,
        report,
    );
    losses(seen, report);
    if seen.length_error <= LENGTH_ERROR {
        report.good("quaternions are of unit length");
    } else {
        report.bad(
            format!(
                "quaternions are off unit length by {:.1e}",
                seen.length_error
            ),
            "that is a mistake in the board's program: flash it anew (`vrduino flash`)",
        );
    }
    let still = seen.moved == 0 && !seen.rests.is_empty();
    if !still {
        report.doubt(
            "it was moved while it was looked at: drift and gravity are not known",
            "lay it down and run this again",
        );
        return;
    }
    gravity(seen, calibrated, report);
    let degrees = first.orientation.angle_to(&last.orientation).to_degrees();
    let drift = degrees / seconds * 60.0;
    let sentence = format!("at rest it turned by {degrees:.3}° in {seconds:.1} s");
    if drift <= DRIFT {
        report.good(sentence);
    } else {
        report.doubt(
            sentence,
            "the gyro's bias is still being found after a start or a change of temperature: give it a minute of rest; if it stays, press `b`",
        );
    }
}

fn rate(seen: &Seen, seconds: f64, arrived: f64, emulated: bool, report: &mut Report) {
    let missing = seen.status.report.missing as f64;
    let rate = (seen.samples as f64 + missing) / seconds;
    let sentence = format!("{rate:.0} samples a second by the board's clock");
    if !RATE.contains(&rate) {
        report.bad(
            format!("{sentence}: 1000 are wanted"),
            "the sensor's clock is off: the part may be broken, or no MPU-9250",
        );
    } else if seen.repeated > seen.samples / 100 {
        report.doubt(
            format!(
                "{sentence}, of which {} repeat the one before",
                seen.repeated
            ),
            "the sensor skips some: look at its wires and its 3V3",
        );
    } else {
        report.good(sentence);
    }
    if seconds < 0.95 * arrived {
        let slow = format!("{seconds:.1} s of stream took {arrived:.1} s to come");
        if emulated {
            report.note(format!(
                "{slow}: this computer is too busy to emulate the board in real time"
            ));
        } else {
            report.doubt(
                slow,
                "close what keeps the computer busy, and take another USB socket, without a hub",
            );
        }
    }
}

fn losses(seen: &Seen, report: &mut Report) {
    let losses = &seen.status.report;
    if losses.missing + losses.damaged == 0 && losses.restarts == 0 {
        report.good("nothing was lost and nothing damaged");
    } else {
        report.doubt(
            format!(
                "{} samples were lost, {} frames or lines damaged, {} new starts",
                losses.missing, losses.damaged, losses.restarts
            ),
            "take another cable and another USB socket, without a hub; close what keeps the computer busy",
        );
    }
}

fn gravity(seen: &Seen, calibrated: bool, report: &mut Report) {
    let count = seen.rests.len() as f64;
    let mean = seen
        .rests
        .iter()
        .map(|&force| f64::from(force))
        .sum::<f64>()
        / count;
    let off = (mean - METRES_PER_S2_PER_G).abs();
    let sentence = format!("at rest the accelerometer reads {mean:.2} m/s², uncorrected");
    if off > GRAVITY_BAD {
        report.bad(
            format!("{sentence}: gravity is {METRES_PER_S2_PER_G:.2}"),
            "no sensor within its data sheet is so far off: the part is broken, or was dropped",
        );
    } else if off > GRAVITY_DOUBT && !calibrated {
        report.doubt(
            sentence,
            "as far off as the data sheet allows: `vrduino calibrate` makes up for it",
        );
    } else {
        report.good(sentence);
    }
}
