//! What is printed: a line in its place on a terminal, a line each elsewhere, or JSON.

use std::io::{self, IsTerminal, Write};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};

use super::tally::Tally;
use super::verdict;
use crate::hub::{State, Status};
use crate::stream::{Percentiles, Report};

/// Standard output is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Closed;

/// Where to, and how.
pub enum Output {
    /// On a terminal, the latest line in its place.
    Terminal(ProgressBar),
    /// Elsewhere.
    Lines,
    /// For programs.
    Json,
}

impl Output {
    /// For people, or as JSON.
    pub fn new(json: bool) -> Self {
        if json {
            Self::Json
        } else if io::stdout().is_terminal() {
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stdout());
            if let Ok(style) = ProgressStyle::with_template("{wide_msg}") {
                bar.set_style(style);
            }
            Self::Terminal(bar)
        } else {
            Self::Lines
        }
    }

    /// The source is there.
    pub fn connected(&self, source: &str) -> Result<(), Closed> {
        self.say(
            || format!("reading {source}"),
            || json!({ "event": "connected", "source": source }),
        )
    }

    /// It is not: why, and what to do.
    pub fn trouble(&self, state: State, sentence: &str) -> Result<(), Closed> {
        let word = match state {
            State::Lost => "lost",
            State::Connected => "note",
            State::Waiting | State::Ended => "waiting",
        };
        self.say(
            || format!("{word}: {sentence}"),
            || json!({ "event": word, "sentence": sentence }),
        )
    }

    /// A line of the board's.
    pub fn line(&self, line: &str) -> Result<(), Closed> {
        self.say(
            || format!("the board: {line}"),
            || json!({ "event": "line", "line": line }),
        )
    }

    /// How it goes.
    pub fn stream(&self, status: &Status, tally: &mut Tally) -> Result<(), Closed> {
        let words = tally.recent.words();
        tally.recent.forget();
        let report = &status.report;
        match self {
            Self::Terminal(bar) => {
                bar.set_message(short(report, &words));
                bar.tick();
                Ok(())
            }
            _ => self.say(
                || full(&status.source, report, &words),
                || {
                    let mut object = losses(report);
                    object["event"] = json!("stream");
                    object["source"] = json!(status.source);
                    object["rate"] = json!(report.rate);
                    object["delay"] = json!(report.delay);
                    object["status"] = json!(words);
                    object
                },
            ),
        }
    }

    /// What it came to.
    pub fn summary(&self, status: &Status, tally: &Tally, seconds: f64) -> Result<(), Closed> {
        self.clear();
        let report = &status.report;
        let findings = verdict::findings(status, tally);
        self.say(
            || {
                let verdict = if findings.is_empty() {
                    "the stream is sound".to_owned()
                } else {
                    findings.join("\n            ")
                };
                let condition = &tally.all;
                format!(
                    "\n\
                     samples     {} in {seconds:.1} s from {}\n\
                     delay       {}\n\
                     lost        {} missing, {} CRC errors, {} malformed, {} bytes thrown away\n\
                     connection  {} restarts of the board, made anew {} times\n\
                     sensor      {} samples clipped, {} repeated, {} left out before\n\
                     verdict     {verdict}",
                    report.samples,
                    status.source,
                    in_words(tally.delay()),
                    report.missing,
                    report.damaged,
                    report.malformed,
                    report.bytes,
                    report.restarts,
                    report.reconnections,
                    condition.clipped(),
                    condition.repeated(),
                    condition.skipped(),
                )
            },
            || {
                let mut object = losses(report);
                object["event"] = json!("summary");
                object["source"] = json!(status.source);
                object["seconds"] = json!(seconds);
                object["delay"] = json!(tally.delay());
                object["clipped"] = json!(tally.all.clipped());
                object["repeated"] = json!(tally.all.repeated());
                object["skipped"] = json!(tally.all.skipped());
                object["sound"] = json!(findings.is_empty());
                object["findings"] = json!(findings);
                object
            },
        )
    }

    /// Takes the live line away.
    pub fn clear(&self) {
        if let Self::Terminal(bar) = self {
            bar.finish_and_clear();
        }
    }

    fn say(&self, text: impl Fn() -> String, json: impl Fn() -> Value) -> Result<(), Closed> {
        let line = match self {
            Self::Terminal(bar) if !bar.is_finished() => {
                bar.println(text());
                return Ok(());
            }
            Self::Terminal(_) | Self::Lines => text(),
            Self::Json => json().to_string(),
        };
        let mut stdout = io::stdout();
        writeln!(stdout, "{line}")
            .and_then(|()| stdout.flush())
            .map_err(|_| Closed)
    }
}

fn losses(report: &Report) -> Value {
    json!({
        "samples": report.samples,
        "missing": report.missing,
        "crc_errors": report.damaged,
        "malformed": report.malformed,
        "bytes_thrown_away": report.bytes,
        "restarts": report.restarts,
        "reconnections": report.reconnections,
    })
}

fn in_words(delay: Option<Percentiles>) -> String {
    match delay {
        Some(delay) => format!("{delay} ms behind the fastest"),
        None => "unknown: the stream has no device time".into(),
    }
}

fn in_short(delay: Option<Percentiles>) -> String {
    delay.map_or("delay unknown".into(), |delay| format!("delay {delay} ms"))
}

/// All of it, as a line of a log.
fn full(source: &str, report: &Report, words: &[&str]) -> String {
    let delay = in_short(report.delay);
    format!(
        "{source}: {:.1} a second, {delay}, missing {}, CRC errors {}, malformed {}, thrown away {} bytes, restarts {}; {}",
        report.rate,
        report.missing,
        report.damaged,
        report.malformed,
        report.bytes,
        report.restarts,
        words.join(", ")
    )
}

/// What fits on a terminal: what is nought is left out.
fn short(report: &Report, words: &[&str]) -> String {
    let delay = in_short(report.delay);
    let losses: Vec<String> = [
        (report.missing, "missing"),
        (report.damaged, "CRC errors"),
        (report.malformed, "malformed"),
        (report.bytes, "bytes thrown away"),
        (report.restarts, "restarts"),
    ]
    .into_iter()
    .filter(|&(count, _)| count > 0)
    .map(|(count, what)| format!("{count} {what}"))
    .collect();
    let losses = if losses.is_empty() {
        "nothing lost".to_owned()
    } else {
        losses.join(", ")
    };
    format!(
        "{:.0} /s · {delay} · {losses} · {}",
        report.rate,
        words.join(", ")
    )
}
