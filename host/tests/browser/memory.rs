//! Ten minutes of a kilohertz, faster than they would come, and what they leave behind.

use data_encoding::BASE64;
use libtest_mimic::Failed;
use serde_json::json;

use super::bytes;
use super::chromium::Chromium;
use super::server::Server;
use super::tab::{Size, Tab};

const MINUTES: u32 = 10;
/// So many more are given to a browser that is still compiling then, for it has no core of its own.
const MORE: u32 = 10;
/// Samples of a minute.
const MINUTE: u32 = 60_000;
/// What the heap may be larger after the last minute than after the first, in bytes: a third of a byte a
/// sample. It is what the browser compiles as it goes, and ends with that.
const GROWTH: f64 = 180_000.0;
/// And than three minutes before: a sixth of a byte a sample.
const GROWTH_AT_THE_END: f64 = 30_000.0;

/// Frames by the page's decoder, from there as batches, which the program sends, into its intake; a
/// picture after every five seconds of them. Defined once, since the browser keeps every script.
const FEED: &str = "window.feed = async () => {
    const { Decoder } = await import('/wire.js');
    const { takeBatch } = await import('/stream.js');
    const { intake } = await import('/main.js');
    const bytes = Uint8Array.from(atob(window.given), (letter) => letter.charCodeAt(0));
    delete window.given;
    const batch = new DataView(new ArrayBuffer(4 + 8 * 40));
    batch.setUint16(0, 0x0101, true);
    batch.setUint16(2, 8, true);
    let filled = 0;
    let taken = 0;
    const decoder = window.decoder ??= new Decoder({ text: intake.line, orientation: (...args) => window.put(...args) });
    window.put = (w, x, y, z, sequence, micros, status) => {
        const at = 4 + 40 * filled;
        batch.setFloat64(at, micros / 1e6, true);
        [w, x, y, z, 0.3].forEach((value, i) => batch.setFloat32(at + 8 + 4 * i, value, true));
        batch.setUint32(at + 28, sequence, true);
        batch.setUint32(at + 32, status | 0x300, true);
        filled = (filled + 1) % 8;
        if (filled === 0 && takeBatch(batch.buffer, intake.sample)) taken += 8;
    };
    const seconds = 5;
    for (let at = 0; at < bytes.length; at += seconds * 29000) {
        decoder.push(bytes.subarray(at, at + seconds * 29000));
        // The console is full after the first minute.
        for (let i = 0; i < (window.lines ?? 20); i += 1) intake.line(`OK second ${at / 29000}, line ${i}`);
        await new Promise((done) => (window.ownFrame ?? requestAnimationFrame)(done));
    }
    return taken;
};";

/// A page that is not seen has no animation frames; and the board has much to say meanwhile.
const HIDDEN: &str = "window.ownFrame = (act) => setTimeout(act, 0);
    window.requestAnimationFrame = () => 0;
    window.lines = 5000;";

/// What waits for the next picture of a hidden page, in bytes at most.
const WAITING: f64 = 200_000.0;

pub fn ten_minutes(chromium: &Chromium) -> Result<(), Failed> {
    let growth = |heaps: &[f64], minutes| heaps[heaps.len() - 1] - heaps[heaps.len() - 1 - minutes];
    let is_calm = |heaps: &[f64]| growth(heaps, 3) <= GROWTH_AT_THE_END;
    let heaps = feed(chromium, "", MINUTES, MORE, is_calm)?;
    println!("heap after each minute, in bytes: {heaps:?}");
    for (minutes, allowed) in [(heaps.len() - 1, GROWTH), (3, GROWTH_AT_THE_END)] {
        let growth = growth(&heaps, minutes);
        if growth > allowed {
            return Err(
                format!("{growth} bytes more than {minutes} minutes before: {heaps:?}").into(),
            );
        }
    }
    Ok(())
}

pub fn hidden(chromium: &Chromium) -> Result<(), Failed> {
    let heaps = feed(chromium, HIDDEN, 3, 0, |_| true)?;
    let growth = heaps[2] - heaps[0];
    if growth > WAITING {
        return Err(format!("{growth} bytes have piled up: {heaps:?}").into());
    }
    Ok(())
}

/// Bytes in use after each minute; of some more minutes, until it is calm.
fn feed(
    chromium: &Chromium,
    script: &str,
    minutes: u32,
    more: u32,
    is_calm: impl Fn(&[f64]) -> bool,
) -> Result<Vec<f64>, Failed> {
    // A stream of its own would come in between.
    let program = Server::view(&["--port", "/dev/no-such-port"]);
    // A small picture, of which many can be drawn.
    let mut tab = chromium.open_as(&program.url(), Size(500, 400, 1), script)?;
    tab.eval(&format!("{FEED} 0"))?;
    let mut heaps = Vec::new();
    for minute in 0..minutes + more {
        if minute >= minutes && is_calm(&heaps) {
            break;
        }
        let mut stream = Vec::new();
        (minute * MINUTE..(minute + 1) * MINUTE)
            .for_each(|number| stream.extend(bytes::frame(number).as_ref()));
        tab.give(&BASE64.encode(&stream))?;
        let taken = tab.eval("feed()")?;
        if taken != json!(MINUTE) {
            return Err(format!("minute {minute}: {taken} samples were taken").into());
        }
        heaps.push(heap(&mut tab)?);
    }
    let [count, lost, time] = tab.numbers("[vrduino.count, vrduino.lost, vrduino.time]")?[..]
    else {
        return Err("not three numbers".into());
    };
    let all = heaps.len() as f64 * f64::from(MINUTE);
    if count != all || lost != 0.0 || (time - (all - 1.0) / 1000.0).abs() > 1e-3 {
        return Err(format!("{count} samples, {lost} lost, until {time} s").into());
    }
    tab.close()?;
    Ok(heaps)
}

/// Bytes in use, when all that can go has gone.
fn heap(tab: &mut Tab) -> Result<f64, Failed> {
    // What DevTools keeps of a call's text is not the page's.
    tab.call("Runtime.discardConsoleEntries", &json!({}))?;
    for _ in 0..2 {
        tab.call("HeapProfiler.collectGarbage", &json!({}))?;
    }
    let usage = tab.call("Runtime.getHeapUsage", &json!({}))?;
    usage["usedSize"]
        .as_f64()
        .ok_or_else(|| "no size of the heap".into())
}
