//! What the board says of its sensor.

use crate::hub::Hub;

use super::check::Report;
use super::watch::Seen;

/// What a line of the board's means at the desk, by how it begins.
const MEANINGS: [(&str, &str); 9] = [
    (
        "error: no IMU answers",
        "unplug the board and look at the wires to the sensor: 3V3, GND, SDA to pin 18, SCL to pin 19; on a VRduino, press the sensor's board firmly into its socket",
    ),
    (
        "error: unknown part",
        "the chip is another than was sold: an MPU-9250, MPU-9255 or MPU-6500 is wanted",
    ),
    (
        "error: the IMU stopped answering",
        "a wire to the sensor is loose: move each while the stream runs, and solder the one that stops it",
    ),
    (
        "error: calibration not kept",
        "run `vrduino calibrate` again; if it stays, the board's EEPROM is worn or taken by a sketch",
    ),
    (
        "error: IMU register",
        "the sensor's 3V3 is weak: try another USB socket",
    ),
    (
        "warning: magnetic field",
        "move the board away from magnets: loudspeakers, headphones, laptop lids",
    ),
    (
        "warning: the sensor is at the end of its range",
        "it was knocked or turned faster than 2000 °/s; if it lies still, the sensor is broken",
    ),
    (
        "warning: not still",
        "lay the board down for two seconds: its gyro is measured then",
    ),
    (
        "warning: never still",
        "lay the board down for two seconds: its gyro is measured then",
    ),
];

/// Looks at what it said unasked, and asks for the rest: whether its accelerometer is calibrated.
pub fn look(hub: &Hub, seen: &Seen, report: &mut Report) -> bool {
    let mut told: Vec<&str> = Vec::new();
    for line in &seen.lines {
        if (line.starts_with("error") || line.starts_with("warning"))
            && !told.contains(&line.as_str())
        {
            told.push(line);
            trouble(line, report);
        }
    }
    if seen.ends.is_none() {
        if told.is_empty() {
            report.bad(
                "the sensor delivers nothing",
                "unplug the board and plug it in again",
            );
        }
        return false;
    }
    bias(hub, report);
    magnetometer(hub, seen, report);
    calibration(hub, report)
}

fn trouble(line: &str, report: &mut Report) {
    let meaning = MEANINGS
        .iter()
        .find(|(beginning, _)| line.starts_with(beginning));
    let advice = meaning.map_or(
        "docs/commands.md and README.md say what it means",
        |(_, advice)| advice,
    );
    let sentence = format!("the board says `{line}`");
    if line.starts_with("error") {
        report.bad(sentence, advice);
    } else {
        report.doubt(sentence, advice);
    }
}

fn bias(hub: &Hub, report: &mut Report) {
    match hub.ask(":bias") {
        Ok(bias) if bias.contains("never still") => report.doubt(
            format!("the gyro's bias is not known: {bias}"),
            "lay the board down for two seconds",
        ),
        Ok(bias) => report.good(format!(
            "the gyro's bias is known: {}",
            without(&bias, "bias ")
        )),
        Err(failure) => report.bad(":bias is not answered", failure.sentence),
    }
}

fn magnetometer(hub: &Hub, seen: &Seen, report: &mut Report) {
    if seen.fields == 0 {
        report.doubt(
            "no magnetometer: the heading drifts as far as the gyro does",
            "an MPU-6500 sold as an MPU-9250 has none; `r`, typed to the board, faces it ahead again",
        );
        return;
    }
    match hub.ask(":compass") {
        Ok(compass) => report.good(format!("the magnetometer delivers; {compass}")),
        Err(failure) => report.bad(":compass is not answered", failure.sentence),
    }
}

fn calibration(hub: &Hub, report: &mut Report) -> bool {
    match hub.ask(":calibration") {
        Ok(known) if known.ends_with(": none") => report.doubt(
            "the sensor is not calibrated",
            "tilt and heading get better by `vrduino calibrate`, which takes three minutes",
        ),
        Ok(known) => {
            report.good(format!("calibrated: {}", without(&known, "calibration: ")));
            return known.contains("force within");
        }
        Err(failure) => report.bad(":calibration is not answered", failure.sentence),
    }
    false
}

fn without<'a>(answer: &'a str, word: &str) -> &'a str {
    answer.strip_prefix(word).unwrap_or(answer)
}
