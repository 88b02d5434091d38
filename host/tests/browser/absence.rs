//! Boards that are not there, cables that are pulled, programs that have ended.

use libtest_mimic::Failed;

use super::chromium::Chromium;
use super::moving::START;
use super::server::Server;
use super::tab::Size;

const NOTICE: &str = "!document.getElementById('notice').hidden";
const CLEAR: &str = "document.getElementById('notice').hidden";

pub fn cable(chromium: &Chromium) -> Result<(), Failed> {
    let program = Server::view(&["--emulate"]);
    let mut tab = chromium.open(&program.url())?;
    tab.until("samples arrive", "vrduino.count > 1000", START)?;
    // What would be gone if the page were loaded again.
    tab.eval("window.stayed = true")?;
    for _ in 0..2 {
        tab.click("#cable")?;
        tab.until(
            "it shows",
            &format!("vrduino.status.state === 'lost' && {NOTICE}"),
            20,
        )?;
        let said = "document.getElementById('notice-text').textContent.length > 10";
        tab.until("it says why", said, 5)?;
        tab.picture("page-unplugged.png")?;
        let before = tab.eval("vrduino.count")?;
        tab.click("#replug")?;
        let again = format!(
            "vrduino.status.state === 'connected' && {CLEAR} && vrduino.count > {before} + 1000"
        );
        tab.until("the stream goes on", &again, 60)?;
        tab.until("at a kilohertz", "vrduino.hertz > 900", 30)?;
    }
    tab.until("it was the same page", "window.stayed", 1)?;
    tab.close()
}

pub fn no_board(chromium: &Chromium) -> Result<(), Failed> {
    let program = Server::view(&["--port", "/dev/no-such-port"]);
    let mut tab = chromium.open(&program.url())?;
    tab.until(
        "it says so",
        &format!("vrduino.status.state === 'waiting' && {NOTICE}"),
        30,
    )?;
    tab.until("nothing has come", "vrduino.count === 0", 1)?;
    tab.picture("page-no-board.png")?;
    tab.click("#start-emulated")?;
    let there = format!(
        "vrduino.status.kind === 'emulated' && vrduino.status.state === 'connected' && {CLEAR}"
    );
    tab.until("the emulated board is there", &there, START)?;
    tab.until("it streams", "vrduino.count > 1000", 60)?;
    tab.click("#leave")?;
    tab.until(
        "it can be left",
        &format!("vrduino.status.kind !== 'emulated' && {NOTICE}"),
        30,
    )?;
    tab.close()
}

/// Takes the place of the program: tells one status, and keeps what it is asked.
const TOLD: &str = "window.asked = [];
    window.WebSocket = class {
        static OPEN = 1;
        readyState = 1;
        constructor() { window.socket = this; }
        send(text) { window.asked.push(text); }
        tell(state, message) {
            const status = { type: 'status', kind: 'emulated', source: 'emulated board', motions: [], state, message };
            this.onmessage({ data: JSON.stringify(status) });
        }
    }";

pub fn not_yet_and_no_more(chromium: &Chromium) -> Result<(), Failed> {
    let program = Server::view(&["--port", "/dev/no-such-port"]);
    let mut tab = chromium.open_as(&program.url(), Size::DESK, TOLD)?;
    let says = |state: &str, title: &str, text: &str, start: bool| {
        format!(
            "{NOTICE} && [['state', '{state}'], ['notice-title', '{title}'], ['notice-text', '{text}']]
                .every(([id, words]) => document.getElementById(id).textContent === words)
                && document.getElementById('start-emulated').hidden !== {start}"
        )
    };
    tab.until("the page is there", "window.socket?.onmessage", 20)?;
    tab.eval("socket.tell('waiting', 'the image is being built')")?;
    let built = says(
        "starting",
        "The emulated board is starting",
        "The image is being built",
        false,
    );
    tab.until("it says what is done", &built, 5)?;
    tab.eval("socket.tell('ended', 'it has stopped')")?;
    let stopped = says("ended", "The board has stopped", "It has stopped", true);
    tab.until("it says so", &stopped, 5)?;
    tab.click("#start-emulated")?;
    let asked = r#"asked.join() === '{"start":"emulated"}'"#;
    tab.until("it can be started again", asked, 5)?;
    tab.close()
}

pub fn no_program(chromium: &Chromium) -> Result<(), Failed> {
    let program = Server::view(&["--emulate"]);
    let port = program.port;
    let mut tab = chromium.open(&program.url())?;
    // Its attempts are what the browser reports.
    tab.expect("ERR_CONNECTION_REFUSED");
    tab.until("samples arrive", "vrduino.count > 1000", START)?;
    drop(program);
    tab.until(
        "it says so",
        &format!("vrduino.status.state === 'gone' && {NOTICE}"),
        20,
    )?;
    let before = tab.eval("vrduino.count")?;
    let again = Server::view_at(port, &["--emulate"]);
    let back = format!(
        "vrduino.status.state === 'connected' && {CLEAR} && vrduino.count > {before} + 1000"
    );
    tab.until("the page goes on", &back, START)?;
    drop(again);
    tab.close()
}
