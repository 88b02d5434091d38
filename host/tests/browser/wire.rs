//! The page's own decoder, which Web Serial needs, against the library's.

use data_encoding::BASE64;
use libtest_mimic::Failed;
use serde_json::{Value, json};
use vrduino::wire::decoder::{Decoder, Event};

use super::bytes::{Random, mixture};
use super::chromium::Chromium;
use super::server::Server;
use super::tab::Tab;

/// The frame of docs/wire-format.md, a quarter turn to the left.
const GOLDEN: &str =
    "00 04 01 50 07 04 87 d6 12 05 cd 3c 41 2d 01 01 01 05 cd 3c 41 2d 01 01 01 03 7c eb 00";

/// Its lines.
const LINES: &str = "QC 0.707 0.000 0.707 0.000\nQC 0.707 0.000 0.707 0.000 7 1234567 *E8D8\n";

/// What the page makes of bytes that come in pieces of up to so many.
const DECODE: &str = "(async (base64, most) => {
    const { Decoder } = await import('/wire.js');
    const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    const came = [];
    const decoder = new Decoder({
        orientation: (...values) => came.push(['orientation', ...values]),
        counts: (...values) => came.push(['counts', ...values]),
        text: (line) => came.push(['text', line]),
        unknown: (kind) => came.push(['unknown', kind]),
    });
    for (let at = 0; at < bytes.length; at += most) decoder.push(bytes.subarray(at, at + most));
    return [came, decoder.losses];
})";

/// Quaternions are the same numbers, but for the last digits that JSON takes.
const TOLERANCE: f64 = 1e-12;

pub fn decodes(chromium: &Chromium) -> Result<(), Failed> {
    // No samples of a stream are wanted, only the page's parts.
    let program = Server::view(&["--port", "/dev/no-such-port"]);
    let mut tab = chromium.open(&program.url())?;

    let frame: Vec<u8> = GOLDEN
        .split(' ')
        .map(|byte| u8::from_str_radix(byte, 16))
        .collect::<Result<_, _>>()?;
    let [came, losses] = decode(&mut tab, &frame, 5)?;
    // 2D413CCDh of 40000000h, in the golden bytes; 0.707 made 1 again is the same to ten digits.
    let half = 0.5_f64.sqrt();
    let expected = json!([["orientation", half, 0.0, half, 0.0, 7, 1_234_567, 0x50]]);
    alike(&came, &expected)?;
    let nothing = json!({"bytes": 0, "damaged": 0, "malformed": 0, "missing": 0, "restarts": 0});
    alike(&losses, &nothing)?;
    let [came, losses] = decode(&mut tab, LINES.as_bytes(), 7)?;
    let plain = json!(["orientation", half, 0.0, half, 0.0, -1, -1, -1]);
    let timed = json!(["orientation", half, 0.0, half, 0.0, 7, 1_234_567, -1]);
    alike(&came, &json!([plain, timed]))?;
    alike(&losses, &nothing)?;

    let mut random = Random(7);
    let mut orientations = 0;
    for round in 0..20 {
        let bytes = mixture(500, &mut random);
        let [came, losses] = decode(&mut tab, &bytes, 1 + round * 13)?;
        let expected = by_the_library(&bytes);
        let count = |kind: &str| expected.0.iter().filter(|event| event[0] == kind).count();
        orientations += count("orientation");
        alike(&came, &Value::from(expected.0))
            .and_then(|()| alike(&losses, &expected.1))
            .map_err(|failed| format!("round {round}: {failed:?}"))?;
    }
    if orientations < 3000 {
        return Err(format!("only {orientations} orientations were compared").into());
    }
    tab.close()
}

fn decode(tab: &mut Tab, bytes: &[u8], most: usize) -> Result<[Value; 2], Failed> {
    let call = format!("{DECODE}('{}', {most})", BASE64.encode(bytes));
    Ok(serde_json::from_value(tab.eval(&call)?)?)
}

fn by_the_library(bytes: &[u8]) -> (Vec<Value>, Value) {
    let mut decoder = Decoder::new();
    let mut came = Vec::new();
    for &byte in bytes {
        came.extend(decoder.push(byte).map(|event| match event {
            Event::Orientation(received) => {
                let q = received.orientation;
                let [sequence, micros] = match received.stamp {
                    Some(stamp) => [i64::from(stamp.sequence), i64::from(stamp.micros)],
                    None => [-1, -1],
                };
                let status = received
                    .status
                    .map_or(-1, |status| i64::from(status.to_byte()));
                json!(["orientation", q.w, q.i, q.j, q.k, sequence, micros, status])
            }
            Event::Counts(_, stamp) => json!(["counts", stamp.sequence, stamp.micros]),
            Event::Text(line) => json!(["text", line]),
            Event::Unknown(kind) => json!(["unknown", kind]),
        }));
    }
    let losses = decoder.losses();
    let losses = json!({
        "bytes": losses.bytes, "damaged": losses.damaged, "malformed": losses.malformed,
        "missing": losses.missing, "restarts": losses.restarts,
    });
    (came, losses)
}

/// The same but for rounding.
fn alike(found: &Value, expected: &Value) -> Result<(), Failed> {
    let same = match (found, expected) {
        (Value::Number(a), Value::Number(b)) => {
            let [a, b] = [a, b].map(|number| number.as_f64().unwrap_or(f64::NAN));
            (a - b).abs() <= TOLERANCE
        }
        (Value::Array(a), Value::Array(b)) => {
            for (a, b) in a.iter().zip(b) {
                alike(a, b)?;
            }
            a.len() == b.len()
        }
        (Value::Object(a), Value::Object(b)) => {
            for (name, b) in b {
                alike(a.get(name).unwrap_or(&Value::Null), b)?;
            }
            a.len() == b.len()
        }
        _ => found == expected,
    };
    if same {
        return Ok(());
    }
    let short = |value: &Value| value.to_string().chars().take(400).collect::<String>();
    Err(format!("{} instead of {}", short(found), short(expected)).into())
}
