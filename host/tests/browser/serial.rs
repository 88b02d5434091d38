//! Web Serial, with a port that is none: the browser has no board to offer here.

use data_encoding::BASE64;
use libtest_mimic::Failed;

use super::bytes;
use super::chromium::Chromium;
use super::server::Server;
use super::tab::Size;

/// Frames that the port has to give.
const FRAMES: u32 = 20_000;

/// Takes the place of the browser's own `navigator.serial`: a port that gives twenty milliseconds of
/// frames at a time, cut anywhere, and answers a few lines as the board does. What it is told takes its
/// time, and a port that closes forgets the rest; the first port that was ever allowed is another one's.
const MOCK: &str = "(() => {
    const frames = Uint8Array.from(atob('FRAMES'), (letter) => letter.charCodeAt(0));
    const listeners = {};
    const mock = { at: 0, written: '', said: '', opened: 0, plugged: true, stream: 'timed every 7' };
    const answers = {
        ':help': 'OK verbs: help version',
        ':estimator': 'OK estimator notes', ':get tilt-time': 'OK tilt-time 4.0000 s',
        ':get notes-alpha': 'OK notes-alpha 0.990000',
    };
    const answer = (line) => {
        const [verb, value] = line.split(' ');
        if (verb === ':stream' && value) mock.stream = `${value} every ${value === 'binary' ? 1 : 10}`;
        if (verb === ':every') mock.stream = mock.stream.replace(/\\d+$/, value);
        return verb === ':stream' || verb === ':every' ? `OK stream ${mock.stream}` : answers[line];
    };
    const port = {
        async open({ baudRate }) {
            if (!mock.plugged || mock.timer) throw new DOMException('Failed to open serial port.', 'NetworkError');
            mock.opened += 1;
            mock.baudRate = baudRate;
            let control;
            port.readable = new ReadableStream({ start: (c) => { control = c; } });
            port.writable = new WritableStream({ async write(chunk) {
                await new Promise((done) => setTimeout(done, 5));
                mock.written += new TextDecoder().decode(chunk);
                for (let end; (end = mock.written.indexOf('\\n')) >= 0;) {
                    const said = answer(mock.written.slice(0, end));
                    mock.written = mock.written.slice(end + 1);
                    if (said) mock.said += `${said}\\n`;
                }
            } });
            mock.timer = setInterval(() => {
                // After 29 · 20 bytes or so: frames are cut in two. Answers stand between them.
                const next = Math.min(frames.length, mock.at + 577);
                const whole = Math.min(next, Math.ceil(mock.at / 29) * 29);
                const said = new TextEncoder().encode(mock.said);
                mock.said = '';
                for (const part of [frames.slice(mock.at, whole), said, frames.slice(whole, next)]) {
                    if (part.length) control.enqueue(part);
                }
                mock.at = next;
            }, 20);
            mock.unplug = () => {
                clearInterval(mock.timer);
                mock.timer = null;
                mock.plugged = false;
                control.error(new DOMException('The device has been lost.', 'NetworkError'));
            };
        },
        async close() {
            await port.writable.abort();
            clearInterval(mock.timer);
            mock.timer = null;
        },
    };
    const another = {
        async open() { throw new DOMException('Failed to open serial port.', 'NetworkError'); },
    };
    const serial = {
        requestPort: async () => port,
        getPorts: async () => (mock.plugged ? [another, port] : [another]),
        addEventListener(name, act) { listeners[name] = act; },
    };
    mock.plug = (stream) => {
        mock.plugged = true;
        mock.at = 0;
        mock.stream = stream;
        listeners.connect({ target: port });
    };
    Object.defineProperty(Navigator.prototype, 'serial', { get: () => serial, configurable: true });
    window.mock = mock;
})()";

pub fn read(chromium: &Chromium) -> Result<(), Failed> {
    let program = Server::view(&["--port", "/dev/no-such-port"]);
    let mut stream = Vec::new();
    (0..FRAMES).for_each(|number| stream.extend(bytes::frame(number).as_ref()));
    let script = MOCK.replace("FRAMES", &BASE64.encode(&stream));
    let mut tab = chromium.open_as(&program.url(), Size::DESK, &script)?;
    tab.until("it is offered", "vrduino.status.state === 'waiting' && !document.querySelector('#notice .open-serial').hidden", 20)?;
    tab.click("#notice .open-serial")?;
    let open = "vrduino.status.kind === 'serial' && vrduino.status.state === 'connected'";
    tab.until("the port is open", open, 10)?;
    tab.until(
        "samples arrive",
        "vrduino.count > 500 && document.getElementById('notice').hidden",
        20,
    )?;
    // A frame is a millisecond and a thousandth of a radian.
    let [time, w, x, y, z] = tab.numbers("[vrduino.time, ...vrduino.quaternion]")?[..] else {
        return Err("not five numbers".into());
    };
    let (sin, cos) = (time / 2.0).sin_cos();
    let off = [w - cos, x, y - sin, z]
        .into_iter()
        .fold(0.0, |most: f64, part| most.max(part.abs()));
    if off > 1e-6 {
        return Err(format!("at {time} s the page has {w} {x} {y} {z}").into());
    }
    let learnt =
        "vrduino.status.estimator === 'notes' && vrduino.status.settings['tilt-time'] === 4";
    tab.until("the board was asked", learnt, 10)?;
    tab.until("for frames", "mock.stream === 'binary every 1'", 10)?;
    tab.until(
        "nothing was lost",
        "vrduino.lost === 0 && vrduino.status.malformed === 0",
        1,
    )?;

    tab.eval("dispatchEvent(new PageTransitionEvent('pagehide'))")?;
    let given_back = "mock.stream === 'timed every 7'";
    tab.until("a page that goes gives it back", given_back, 10)?;

    tab.eval("mock.unplug()")?;
    let gone = "vrduino.status.state === 'lost' && !document.getElementById('notice').hidden";
    tab.until("unplugged, it says so", gone, 10)?;
    let before = tab.eval("vrduino.count")?;
    tab.eval("mock.plug('counts every 3')")?;
    let again = format!(
        "vrduino.status.state === 'connected' && vrduino.count > {before} + 300 && mock.opened === 2"
    );
    tab.until("plugged in, it goes on", &again, 20)?;
    let anew = "mock.stream === 'binary every 1' && vrduino.status.estimator === 'notes'";
    tab.until("and is asked anew", anew, 10)?;

    tab.click("#close-serial")?;
    tab.until(
        "the program has the page again",
        "vrduino.status.kind !== 'serial' && vrduino.status.state === 'waiting'",
        10,
    )?;
    let given_back = "mock.stream === 'counts every 3'";
    tab.until("the board has its stream again", given_back, 1)?;
    tab.close()
}
