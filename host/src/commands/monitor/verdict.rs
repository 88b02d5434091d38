//! What is to be thought of a stream, and what to do about it.

use super::tally::Tally;
use crate::failure::{self, Failure};
use crate::hub::{State, Status};
use crate::source::Kind;

/// Later than this, a picture stutters (s).
const LATE: f64 = 0.020;

/// What is not as it should be, a sentence each; none if all is well.
pub fn findings(status: &Status, tally: &Tally) -> Vec<String> {
    let report = &status.report;
    let mut findings = Vec::new();
    let mut find = |is_so: bool, sentence: String| {
        if is_so {
            findings.push(sentence);
        }
    };
    find(
        matches!(status.state, State::Lost | State::Waiting),
        "the board is gone: plug it in again".into(),
    );
    find(
        report.reconnections > 0,
        format!(
            "the connection was lost and made anew, times {}: look to cable, plug and hub",
            report.reconnections
        ),
    );
    find(
        report.restarts > 0,
        format!(
            "the board started again, times {}: look to its power and its cable, and to its lines that begin with warning:",
            report.restarts
        ),
    );
    let why = match status.kind {
        Some(Kind::Replay) => "the recording does not have them",
        _ => "this computer did not read in time, so close what else keeps it busy",
    };
    find(
        report.missing > 0,
        format!("samples missing, {}: {why}", report.missing),
    );
    find(
        report.damaged > 0,
        format!(
            "lines or frames changed on the way, {}: try another cable, and that nothing else reads this port",
            report.damaged
        ),
    );
    // Where reading began within a frame, one piece is no frame.
    find(
        report.malformed > 1 + report.reconnections,
        format!(
            "pieces that are no line and no frame, {}: try another cable, and that nothing else reads this port",
            report.malformed
        ),
    );
    if let Some(wanted) = wanted(status) {
        find(
            report.rate > 0.0 && report.rate < 0.95 * wanted && report.missing == 0,
            format!(
                "{:.0} samples a second where {wanted:.0} should come: the key 0 shows the sensor's own count (nReads/sec)",
                report.rate
            ),
        );
    }
    if let Some(delay) = tally.delay() {
        find(
            delay.p99 > LATE,
            format!(
                "one in a hundred came {:.0} ms late or more: this computer, or a hub between, is busy",
                delay.p99 * 1e3
            ),
        );
    }
    let clipped = tally.all.clipped();
    find(
        clipped > 0,
        format!(
            "samples at the end of the sensor's range, {clipped}: it was turned or knocked too hard"
        ),
    );
    find(
        tally
            .all
            .latest()
            .is_some_and(|status| !status.bias_measured),
        "the gyro's bias is not known and the heading drifts: lay the board down for two seconds"
            .into(),
    );
    find(
        tally.warnings() > 0,
        format!("warnings, {}: see the lines above", tally.warnings()),
    );
    findings
}

/// Orientations a second that the board was asked for.
fn wanted(status: &Status) -> Option<f64> {
    let (_, every) = status.stream.as_ref()?.split_once(" every ")?;
    let every: f64 = every.parse().ok()?;
    (every > 0.0).then(|| 1000.0 / every)
}

/// There was none.
pub fn no_board(status: &Status) -> Failure {
    let failure = status.trouble.clone();
    failure.unwrap_or_else(|| {
        Failure::new(
            failure::Kind::Board,
            "no board was found in that time: connect it by USB, or take --emulate for the emulated board",
        )
    })
}

/// It was there, and no orientation came.
pub fn no_samples(status: &Status, tally: &Tally) -> Failure {
    let source = &status.source;
    let sentence = if let Some(line) = &tally.other {
        format!(
            "{source} sends lines and no orientation in that time, the last “{line}”: after its start the board measures its bias for a second, and up to five if it is moved; if one of the keys 0 to 4 was pressed, 5 brings the orientation back; `vrduino doctor` looks closer"
        )
    } else if status.version.is_some() {
        format!(
            "{source} answers and sends no orientation in that time: is its sensor connected? `vrduino doctor` looks closer"
        )
    } else if status.report.bytes > 0 {
        format!(
            "{source} sends what is no line and no frame, {} bytes: is it the right port (`vrduino list`), and is vrduino on the board (`vrduino flash`)?",
            status.report.bytes
        )
    } else {
        format!(
            "{source} sends nothing: is it the right port (`vrduino list`), and is vrduino on the board (`vrduino flash`)?"
        )
    };
    Failure::new(failure::Kind::Stream, sentence)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::Report;

    fn status(report: Report) -> Status {
        Status {
            state: State::Connected,
            stream: Some("binary every 1".into()),
            report,
            ..Status::default()
        }
    }

    #[test]
    fn a_sound_stream_has_no_findings_and_each_fault_has_its_own() {
        let sound = Report {
            rate: 1000.0,
            malformed: 1,
            ..Report::default()
        };
        let tally = Tally::default();
        assert!(findings(&status(sound), &tally).is_empty());
        let faulty = [
            (
                Report {
                    missing: 2,
                    ..sound
                },
                "missing, 2",
            ),
            (
                Report {
                    damaged: 3,
                    ..sound
                },
                "changed on the way, 3",
            ),
            (
                Report {
                    malformed: 4,
                    ..sound
                },
                "no frame, 4",
            ),
            (
                Report {
                    restarts: 5,
                    ..sound
                },
                "again, times 5",
            ),
            (
                Report {
                    reconnections: 6,
                    ..sound
                },
                "anew, times 6",
            ),
            (
                Report {
                    rate: 500.0,
                    ..sound
                },
                "500 samples a second where 1000",
            ),
        ];
        for (report, words) in faulty {
            let found = findings(&status(report), &tally);
            assert_eq!(found.len(), 1, "{found:?}");
            assert!(found[0].contains(words), "{found:?}");
        }
    }
}
