//! What the board streams is what the page shows.

use libtest_mimic::Failed;
use vrduino::nalgebra::{Matrix4, UnitQuaternion};
use vrduino::orientation::quaternion::axis_angle;
use vrduino::view::from_stream;
use vrduino::view::gl_rotate::gl_rotate;

use super::chromium::Chromium;
use super::server::Server;
use super::tab::Tab;

/// The image may have to be built first.
pub const START: u64 = 300;

/// For eight seconds of the board's, every truth that comes, with what the page had at that moment.
const WATCH: &str = "(async () => {
    const seen = [];
    let last = null;
    const end = vrduino.truth.t + 8;
    while (vrduino.truth.t < end) {
        await new Promise((done) => setTimeout(done, 20));
        const { truth } = vrduino;
        if (!truth || truth === last) continue;
        // The sample after it is still on its way.
        await new Promise((done) => setTimeout(done, 60));
        const at = vrduino.at(truth.t);
        last = truth;
        if (at) seen.push([...truth.q, ...at]);
    }
    return seen;
})()";

/// With the head still or turning the page is never off by more, in degrees: what the estimator is
/// off, and the moments between the sensor's samples and the truth.
const TOLERANCE: f64 = 2.0;

pub fn turns(chromium: &Chromium) -> Result<(), Failed> {
    let program = Server::view(&["--emulate", "--motion", "turns"]);
    let mut tab = chromium.open(&program.url())?;
    tab.until(
        "samples arrive",
        "vrduino.count > 1000 && vrduino.truth",
        START,
    )?;
    // The bias is measured first.
    tab.until("the sensor turns", "vrduino.truth.t > 3", 60)?;
    let seen: Vec<[f64; 8]> = serde_json::from_value(tab.eval(WATCH)?)?;
    let first = seen.first().ok_or("no truth has come")?;
    let start = rotation(&first[..4])?;
    let mut farthest = 0.0_f64;
    for pair in &seen {
        let (truth, shown) = (rotation(&pair[..4])?, rotation(&pair[4..])?);
        let off = truth.angle_to(&shown).to_degrees();
        if off > TOLERANCE {
            return Err(format!("the page is {off:.2} deg off the sensor: {pair:?}").into());
        }
        farthest = farthest.max(start.angle_to(&truth).to_degrees());
    }
    if seen.len() < 20 || farthest < 60.0 {
        return Err(format!(
            "{} truths, {farthest:.0} deg: too little to see",
            seen.len()
        )
        .into());
    }
    let turned = "Math.abs(vrduino.picture.quaternion[0]) < 0.9";
    tab.until("the board is turned", turned, 20)?;
    // Algorithm 1: what the board is drawn with is the library's matrix.
    let drawn = tab.numbers("[...vrduino.picture.quaternion, ...vrduino.picture.model]")?;
    let turn = axis_angle(rotation(&drawn[..4])?);
    let expected = gl_rotate(turn.angle, turn.axis.into_inner())?;
    close_to(&drawn[4..], &expected, 1e-6)?;
    // And what is drawn is the latest, as soon as it rests.
    let latest =
        "vrduino.quaternion.every((c, i) => Math.abs(c - vrduino.picture.quaternion[i]) < 0.01)";
    tab.until("the picture is up to date", latest, 10)?;
    let bytes = tab.picture("page-board.png")?;
    if bytes < 50_000 {
        return Err(format!("{bytes} bytes of picture: it shows nothing").into());
    }
    tab.close()
}

/// How many colours there are along the middle of this lane of four, to the right of the names.
const COLOURS: &str = "(canvas, lane) => {
    const { width, height } = canvas, y = Math.round((lane + 0.5) * height / 4);
    const row = canvas.getContext('2d').getImageData(width * 0.4, y, width * 0.6 - 16, 1).data;
    const found = new Set();
    for (let i = 0; i < row.length; i += 4) if (row[i + 3] === 255) found.add(row.slice(i, i + 3).join());
    return found.size;
}";

/// The page of a board that was taken into the hand and turned to the left, by `down` pixels upwards too,
/// and stays there.
pub fn turned_by_hand(chromium: &Chromium, down: f64) -> Result<(Server, Tab), Failed> {
    let program = Server::view(&["--emulate", "--motion", "hand"]);
    let mut tab = chromium.open(&program.url())?;
    tab.until(
        "samples arrive",
        "vrduino.count > 1000 && vrduino.truth",
        START,
    )?;
    // To the right and down: to the left and upwards is what the board then faces.
    tab.drag([400.0, 300.0], [500.0, 300.0 + down])?;
    let turned = "2 * Math.atan2(vrduino.truth.q[2], vrduino.truth.q[0]) > 0.7";
    tab.until("the sensor has turned", turned, 20)?;
    Ok((program, tab))
}

pub fn by_hand(chromium: &Chromium) -> Result<(), Failed> {
    let (_program, mut tab) = turned_by_hand(chromium, 40.0)?;
    let angles = "vrduino.angles[0] > 40 && vrduino.angles[1] > 10";
    tab.until("so has the board", angles, 10)?;
    let off = "parseFloat(document.getElementById('truth').textContent) < 2";
    tab.until("as far", off, 10)?;
    // That it was at rest and then was not stands in the second of four lanes, and the sensor was never clipped.
    for (lane, colours) in [(1, 2), (3, 1)] {
        let shown = format!("({COLOURS})(document.getElementById('chart-status'), {lane})");
        tab.until("its status is drawn", &format!("{shown} === {colours}"), 10)?;
    }
    tab.close()
}

pub fn two_pages(chromium: &Chromium) -> Result<(), Failed> {
    let program = Server::view(&["--emulate"]);
    let mut one = chromium.open(&program.url())?;
    let mut other = chromium.open(&program.url())?;
    for tab in [&mut one, &mut other] {
        tab.until("samples arrive", "vrduino.count > 1000", START)?;
    }
    one.eval("document.getElementById('typed').value = ':decimals'; document.querySelector('#type button').click()")?;
    for tab in [&mut one, &mut other] {
        let answer = "vrduino.lines.includes('OK decimals 3')";
        tab.until("both see the answer", answer, 20)?;
        let before = tab.eval("vrduino.count")?;
        tab.until(
            "samples go on",
            &format!("vrduino.count > {before} + 1000"),
            30,
        )?;
    }
    one.close()?;
    other.close()
}

/// w, x, y, z.
pub fn rotation(components: &[f64]) -> Result<UnitQuaternion<f64>, Failed> {
    let components = components.try_into()?;
    Ok(from_stream(components)?)
}

/// Sixteen numbers, column after column.
pub fn close_to(found: &[f64], expected: &Matrix4<f64>, tolerance: f64) -> Result<(), Failed> {
    let off = expected
        .iter()
        .zip(found)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    if found.len() == 16 && off <= tolerance {
        return Ok(());
    }
    Err(format!("off by {off}: {found:?} instead of {expected}").into())
}
