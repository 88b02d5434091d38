//! What is switched and moved on the page reaches the board, which says so.

use libtest_mimic::Failed;

use super::chromium::Chromium;
use super::moving::{START, turned_by_hand};
use super::server::Server;

/// Bit of a sample's flags: the notes' estimator made it.
const NOTES: u32 = 1 << 5;

pub fn reach_the_board(chromium: &Chromium) -> Result<(), Failed> {
    let program = Server::view(&["--emulate"]);
    let mut tab = chromium.open(&program.url())?;
    let told = "vrduino.count > 1000 && vrduino.status.estimator === 'default' && 'notes-alpha' in vrduino.status.settings";
    tab.until("the board has told its settings", told, START)?;

    tab.click("label[for=estimator-notes]")?;
    tab.until(
        "the board has changed",
        "vrduino.status.estimator === 'notes'",
        20,
    )?;
    tab.until(
        "its samples say so",
        &format!("vrduino.flags & {NOTES}"),
        20,
    )?;
    let words = "document.getElementById('estimator').textContent.startsWith('course notes')";
    tab.until("the page says so", words, 5)?;
    tab.until(
        "it shows the answer",
        "document.getElementById('answer').textContent === 'OK estimator notes'",
        5,
    )?;
    tab.press("e")?;
    tab.until(
        "a key takes it back",
        &format!("vrduino.status.estimator === 'default' && !(vrduino.flags & {NOTES})"),
        20,
    )?;

    // Sliders go by powers of ten: 0.3 is 2.00 s, and 2 is α = 0.99.
    tab.slide("tilt-time", 0.301)?;
    tab.until(
        "tilt-time has changed",
        "vrduino.status.settings['tilt-time'] === 2",
        20,
    )?;
    tab.until(
        "it shows the value",
        "document.getElementById('tilt-time-value').textContent === '2 s'",
        5,
    )?;
    tab.slide("notes-alpha", 2.0)?;
    tab.until(
        "alpha has changed",
        "Math.abs(vrduino.status.settings['notes-alpha'] - 0.99) < 1e-3",
        20,
    )?;

    // What the board refuses shows as well.
    tab.press(":")?;
    for key in ["s", "e", "t", " ", "x", "Enter"] {
        tab.press(key)?;
    }
    tab.until(
        "the board refuses",
        "document.getElementById('answer').textContent.startsWith('ERR x')",
        20,
    )?;
    // And what is neither key nor line is not sent.
    tab.eval("document.getElementById('typed').value = 'hello'; document.querySelector('#type button').click()")?;
    tab.until(
        "the page refuses",
        "vrduino.lines.some((line) => line.startsWith('error: “hello”'))",
        5,
    )?;

    tab.eval("document.activeElement.blur()")?;
    tab.click("#defaults")?;
    let back = "Math.abs(vrduino.status.settings['tilt-time'] - 3) < 1e-3";
    tab.until("all is as before", back, 20)?;
    let before = tab.eval("vrduino.count")?;
    tab.until(
        "at a kilohertz",
        &format!("vrduino.count > {before} + 1000 && vrduino.hertz > 900"),
        30,
    )?;

    tab.press("?")?;
    tab.until("the help opens", "document.getElementById('help').open", 5)?;
    tab.press("?")?;
    tab.until("and closes", "!document.getElementById('help').open", 5)?;
    tab.close()
}

pub fn recenter(chromium: &Chromium) -> Result<(), Failed> {
    // By hand, for it stays where it was turned to, however long the click takes.
    let (_program, mut tab) = turned_by_hand(chromium, 0.0)?;
    tab.until("so has the board", "vrduino.angles[0] > 45", 10)?;
    let yaw = tab.numbers("[vrduino.angles[0]]")?[0];
    tab.click("button[data-act=recenter]")?;
    tab.until("it is ahead", "Math.abs(vrduino.angles[0]) < 1", 20)?;
    // The truth is not turned with it: by how much the page is off it then is by how much ahead has moved.
    let shown = "document.getElementById('truth').textContent";
    tab.until(
        "ahead has moved as far",
        &format!("Math.abs(parseFloat({shown}) - {yaw}) < 2"),
        20,
    )?;
    let tilt = tab.numbers(&format!("[parseFloat(/tilt (.*)°/.exec({shown})[1])]"))?[0];
    if tilt > 2.0 {
        return Err(format!("from a yaw of {yaw:.0} deg the tilt is {tilt} deg off").into());
    }
    tab.close()
}
