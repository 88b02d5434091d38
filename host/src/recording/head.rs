//! What is known of a recording as a whole.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::one_line;

/// What is known of a recording as a whole.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Head {
    /// When it began, by the clock on the wall: ISO 8601 with the difference from UTC.
    pub started: String,
    /// Name of the source.
    pub source: String,
    /// What the board says it is, as `vrduino 0.1.0`.
    pub board: Option<String>,
    /// The estimator that made the orientation.
    pub estimator: Option<String>,
    /// What was streamed, as `binary every 1`.
    pub stream: Option<String>,
    /// The board's settings when it began, as far as it had told them.
    pub settings: BTreeMap<String, f64>,
    /// Whether the sensor's registers are recorded.
    pub has_counts: bool,
}

/// What the columns are, for those who find a file and nothing else. Readers pass over it.
const EXPLANATIONS: &str = "\
# frame w, x, y, z take vectors from body to world; world y up, -z ahead; w is the scalar
# unit time_s on the device's clock where a sequence number is known, else as arrival_s; in a new segment times begin anew
# unit arrival_s on the computer's clock; delay_ms later than the fastest samples; status columns 0 or 1
";

/// The same for the registers.
const REGISTERS: &str = "\
# unit registers as the sensor has them, board axes; gyro 2000/32768 deg/s, accel 16/32768 g, field 0.15 uT along its own axes
";

impl Head {
    /// Takes it down, a comment to a line, without the first.
    pub(super) fn write(&self, text: &mut String) {
        let mut line = |name: &str, value: &str| {
            // Into a string nothing fails.
            let _ = writeln!(text, "# {name} {}", one_line(value));
        };
        line("started", &self.started);
        line("source", &self.source);
        let facts = [
            ("board", &self.board),
            ("estimator", &self.estimator),
            ("stream", &self.stream),
        ];
        for (name, value) in facts {
            if let Some(value) = value {
                line(name, value);
            }
        }
        for (name, value) in &self.settings {
            line("setting", &format!("{name} {value}"));
        }
        text.push_str(EXPLANATIONS);
        if self.has_counts {
            text.push_str(REGISTERS);
        }
    }

    /// Learns what a comment of the head tells; one it does not know is for people.
    pub(super) fn learn(&mut self, comment: &str) {
        let Some((name, value)) = comment.split_once(' ') else {
            return;
        };
        match name {
            "started" => value.clone_into(&mut self.started),
            "source" => value.clone_into(&mut self.source),
            "board" => self.board = Some(value.to_owned()),
            "estimator" => self.estimator = Some(value.to_owned()),
            "stream" => self.stream = Some(value.to_owned()),
            "setting" => {
                let setting = value.split_once(' ');
                if let Some((name, Ok(value))) = setting.map(|(n, v)| (n, v.parse())) {
                    self.settings.insert(name.to_owned(), value);
                }
            }
            _ => {}
        }
    }
}
