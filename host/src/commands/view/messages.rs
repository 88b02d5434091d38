//! What page and program say to each other: `docs/host-protocol.md`, byte for byte.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::hub::{State, Status};
use crate::source::{Kind, Truth};
use crate::stream::Sample;

/// Records of a batch at most.
pub const BATCH: usize = 4096;

/// Bytes of a record.
const RECORD: usize = 40;

/// Kind and version of a batch.
const HEAD: [u8; 2] = [1, 1];

/// Bits above those of the status byte.
mod flag {
    pub const STATUS_KNOWN: u32 = 1 << 8;
    pub const OF_DEVICE: u32 = 1 << 9;
    pub const FIRST: u32 = 1 << 10;
}

/// Samples as a page takes them; [`BATCH`] of them at most.
pub fn batch(samples: &[Sample]) -> Vec<u8> {
    let count = samples.len().min(BATCH);
    let mut bytes = Vec::with_capacity(HEAD.len() + 2 + count * RECORD);
    bytes.extend(HEAD);
    bytes.extend((count as u16).to_le_bytes());
    for sample in &samples[..count] {
        record(sample, &mut bytes);
    }
    bytes
}

fn record(sample: &Sample, bytes: &mut Vec<u8>) {
    let q = sample.orientation;
    bytes.extend(sample.time.to_le_bytes());
    for number in [q.w, q.i, q.j, q.k] {
        bytes.extend((number as f32).to_le_bytes());
    }
    let latency = sample.delay.map_or(f32::NAN, |delay| (delay * 1e3) as f32);
    bytes.extend(latency.to_le_bytes());
    bytes.extend(u32::from(sample.sequence.unwrap_or(0)).to_le_bytes());
    let mut flags = 0;
    if let Some(status) = sample.status {
        flags |= u32::from(status.to_byte()) | flag::STATUS_KNOWN;
    }
    if sample.sequence.is_some() {
        flags |= flag::OF_DEVICE;
    }
    if sample.is_first {
        flags |= flag::FIRST;
    }
    bytes.extend(flags.to_le_bytes());
    bytes.extend([0; 4]);
}

/// What a page is told as text.
#[derive(Debug, Serialize)]
#[serde(tag = "type", rename_all = "lowercase")]
enum Told<'a> {
    Status(Box<Condition<'a>>),
    Line { text: &'a str },
    Truth { t: f64, q: [f64; 4] },
}

#[derive(Debug, Serialize)]
struct Condition<'a> {
    source: &'a str,
    kind: &'static str,
    state: State,
    message: String,
    rate: f64,
    latency_ms: Option<Latency>,
    gaps: u64,
    crc_errors: u64,
    malformed: u64,
    thrown_away: u64,
    dropped: u64,
    restarts: u64,
    version: Option<&'a str>,
    estimator: Option<&'a str>,
    settings: &'a BTreeMap<&'static str, f64>,
    motions: &'a [&'static str],
    motion: Option<&'a str>,
}

#[derive(Debug, Serialize)]
struct Latency {
    p50: f64,
    p99: f64,
}

/// How things are, and how many samples this page was too slow for.
pub fn status(status: &Status, dropped: u64) -> String {
    let report = &status.report;
    text(&Told::Status(Box::new(Condition {
        source: &status.source,
        kind: match status.kind {
            Some(Kind::Emulated) => "emulated",
            Some(Kind::Replay) => "replay",
            // Nobody has named a port, and none has been found.
            Some(Kind::Port) if !status.source.is_empty() => "port",
            _ => "none",
        },
        state: status.state,
        message: status.sentence(),
        rate: report.rate,
        latency_ms: report.delay.map(|delay| Latency {
            p50: delay.p50 * 1e3,
            p99: delay.p99 * 1e3,
        }),
        gaps: report.missing,
        crc_errors: report.damaged,
        malformed: report.malformed,
        thrown_away: report.bytes,
        dropped,
        restarts: report.restarts,
        version: status.version.as_deref(),
        estimator: status.estimator.as_deref(),
        settings: &status.settings,
        motions: status.motions,
        motion: status.motion.as_deref(),
    })))
}

/// A line of the board's, or one of ours that looks like it.
pub fn line(line: &str) -> String {
    text(&Told::Line { text: line })
}

/// How the emulated sensor really stands.
pub fn truth(truth: &Truth) -> String {
    text(&Told::Truth {
        t: truth.time,
        q: truth.orientation,
    })
}

fn text(told: &Told<'_>) -> String {
    // Strings and numbers always have a form.
    serde_json::to_string(told).unwrap_or_default()
}

/// What a page asks for.
#[derive(Debug, PartialEq)]
pub enum Asked {
    /// To type this line.
    Line(String),
    /// To press this key.
    Key(u8),
    /// To take the emulated board.
    Emulate,
    /// To leave it.
    Stop,
    /// To carry its sensor through this motion.
    Motion(String),
    /// To turn it there by hand: body to world, w, x, y, z.
    Turn([f64; 4]),
    /// To pull its plug, or put it back.
    Unplug(bool),
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
enum Request {
    Send(String),
    Start(String),
    Stop(bool),
    Motion(String),
    Turn([f64; 4]),
    Unplug(bool),
}

/// Understands it.
///
/// # Errors
///
/// A line that says why not.
pub fn understand(message: &str) -> Result<Asked, String> {
    /// Bytes of a line of the board's at most, with the colon (docs/commands.md).
    const LONGEST: usize = 73;
    let request = serde_json::from_str(message).map_err(|error| {
        format!("error: the program does not know what this page asks: {error}")
    })?;
    match request {
        Request::Send(text) if text.starts_with(':') => {
            let is_line = text.bytes().all(|byte| (b' '..=b'~').contains(&byte));
            if is_line && text.len() <= LONGEST {
                Ok(Asked::Line(text))
            } else {
                Err("error: not sent: a line is ASCII, and 72 characters with the colon before them at most".into())
            }
        }
        Request::Send(text) => match *text.as_bytes() {
            [key @ b'!'..=b'~'] => Ok(Asked::Key(key)),
            _ => Err("error: not sent: a key is one character; a line begins with a colon".into()),
        },
        Request::Start(what) if what == "emulated" => Ok(Asked::Emulate),
        Request::Start(what) => Err(format!("error: there is no {what} to start")),
        Request::Stop(true) => Ok(Asked::Stop),
        Request::Stop(false) => Err("error: nothing to stop".into()),
        Request::Motion(name) => Ok(Asked::Motion(name)),
        Request::Turn(orientation) => Ok(Asked::Turn(orientation)),
        Request::Unplug(unplug) => Ok(Asked::Unplug(unplug)),
    }
}
