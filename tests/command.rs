//! Keys and lines from the host, byte by byte.

#[path = "random/mod.rs"]
mod random;

use random::Random;
use vrduino::command::request::{Choice, CoreClock, Format, Request, Setting, UseCompass};
use vrduino::command::{Command, Mode, Parser};
use vrduino::sampling::Lock;
use vrduino::wire::{Decimals, LINE_LEN, Provenance, Q30, frame};

#[test]
fn keys_are_single_bytes_and_others_mean_nothing() {
    let expected = [
        (b'0', Command::Mode(Mode::Info)),
        (b'1', Command::Mode(Mode::Flat)),
        (b'2', Command::Mode(Mode::ThreeD)),
        (b'3', Command::Mode(Mode::Gyro)),
        (b'4', Command::Mode(Mode::Accel)),
        (b'5', Command::Mode(Mode::Quaternion)),
        (b'r', Command::Reset),
        (b'b', Command::MeasureBias),
    ];
    for byte in 0..=u8::MAX {
        let meant = expected.iter().find(|(key, _)| *key == byte);
        let command = Parser::new().push(byte);
        assert_eq!(command, meant.map(|(_, command)| command.clone()), "{byte}");
    }
}

fn commands(bytes: &[u8]) -> Vec<Command> {
    let mut parser = Parser::new();
    bytes.iter().filter_map(|&b| parser.push(b)).collect()
}

/// What one line asks for; in words where it is refused.
fn line(text: &str) -> Result<Request, String> {
    match commands(format!(":{text}\n").as_bytes()).as_slice() {
        [Command::Line(line)] => line.clone().map_err(|refusal| refusal.to_string()),
        other => panic!("{text:?} is {other:?}"),
    }
}

#[test]
fn the_words_of_a_line_press_no_keys() {
    for end in ["\n", "\r", "\r\n"] {
        let typed = commands(format!(":compass off{end}b").as_bytes());
        let off = Command::Line(Ok(Request::Compass(Some(UseCompass::Off))));
        assert_eq!(typed, [off, Command::MeasureBias]);
    }
    assert_eq!(commands(b":a:b").len(), 0, "it has not ended");
    assert_eq!(
        line("a:b"),
        Err("a:b: no such verb, :help lists them".into())
    );
    // A colon that no newline follows does not silence the keys for ever.
    let noise = [b":".as_slice(), &[b'r'; 202], b"r"].concat();
    let typed = commands(&noise);
    assert_eq!(typed.len(), 2, "{typed:?}");
    assert_eq!(typed[1], Command::Reset);
}

#[test]
fn every_verb_is_understood() {
    for (text, request) in [
        ("help", Request::Help),
        ("version", Request::Version),
        ("defaults", Request::Defaults),
        ("bias", Request::Bias),
        ("estimator", Request::Estimator(None)),
        ("estimator notes", Request::Estimator(Some(Choice::Notes))),
        (
            "estimator default",
            Request::Estimator(Some(Choice::Default)),
        ),
        ("decimals", Request::Decimals(None)),
        ("decimals 5", Request::Decimals(Decimals::new(5))),
        ("stream", Request::Stream(None)),
        ("stream text", Request::Stream(Some(Format::Text))),
        ("stream timed", Request::Stream(Some(Format::Timed))),
        ("stream binary", Request::Stream(Some(Format::Binary))),
        ("stream counts", Request::Stream(Some(Format::Counts))),
        ("every", Request::Every(None)),
        ("every 1", Request::Every(Some(1))),
        ("every 1000", Request::Every(Some(1000))),
        ("core", Request::Core(None)),
        ("core 72", Request::Core(Some(CoreClock::Full))),
        ("core 36", Request::Core(Some(CoreClock::Half))),
        ("lock", Request::Lock(None)),
        ("lock sensor", Request::Lock(Some(Lock::Sensor))),
        ("lock usb", Request::Lock(Some(Lock::Usb))),
        ("compass", Request::Compass(None)),
        ("compass on", Request::Compass(Some(UseCompass::On))),
        ("compass auto", Request::Compass(Some(UseCompass::Auto))),
        ("compass adjustment", Request::CompassAdjustment),
        ("calibration", Request::Calibration),
        ("keep done", Request::KeepDone),
        ("forget", Request::Forget),
        ("get notes-alpha", Request::Get(Setting::NotesAlpha)),
        (
            "set notes-alpha 0.98",
            Request::Set(Setting::NotesAlpha, 0.98),
        ),
        ("  set   lead  2.5  ", Request::Set(Setting::Lead, 2.5)),
        ("set tilt-time +3", Request::Set(Setting::TiltTime, 3.0)),
        ("set damping .25", Request::Set(Setting::Damping, 0.25)),
    ] {
        assert_eq!(line(text), Ok(request), "{text}");
    }
    for setting in Setting::ALL {
        assert_eq!(
            line(&format!("get {}", setting.name())),
            Ok(Request::Get(setting))
        );
        for end in setting.range() {
            let text = format!("set {} {end}", setting.name());
            assert_eq!(line(&text), Ok(Request::Set(setting, end)), "{text}");
        }
    }
}

#[test]
fn a_refusal_names_the_word_and_fits_a_line() {
    for (text, refusal) in [
        ("", ": no such verb, :help lists them"),
        ("HELP", "HELP: no such verb, :help lists them"),
        ("estimator kalman", "kalman: default or notes is wanted"),
        ("core 48", "48: 72 or 36 is wanted"),
        ("lock moon", "moon: sensor or usb is wanted"),
        (
            "compass maybe",
            "maybe: auto, on, off or adjustment is wanted",
        ),
        ("get tau", "tau: no such setting, :set lists them"),
        ("set lead", "lead: a number like 0.98 is wanted"),
        ("set lead fast", "fast: a number like 0.98 is wanted"),
        ("set lead 1e3", "1e3: a number like 0.98 is wanted"),
        ("set lead nan", "nan: a number like 0.98 is wanted"),
        ("set lead -1", "-1: lead is 0 to 100 ms"),
        ("set damping 0", "0: damping is 0.1 to 5 "),
        ("set notes-alpha 1.001", "1.001: notes-alpha is 0 to 1 "),
        ("set tilt-time 0.05", "0.05: tilt-time is 0.1 to 100 s"),
        ("set field-tolerance 0", "0: field-tolerance is 0.01 to 1 "),
        ("decimals 2", "2: 3 to 6 is wanted"),
        ("decimals many", "many: 3 to 6 is wanted"),
        ("stream hex", "hex: text, timed, binary or counts is wanted"),
        ("every 0", "0: 1 to 1000 is wanted"),
        ("every 1001", "1001: 1 to 1000 is wanted"),
        ("every -1", "-1: 1 to 1000 is wanted"),
        ("every 99999999", "99999999: 1 to 1000 is wanted"),
        ("bias now", "now: one word too many"),
        ("help me", "me: one word too many"),
        ("caf\u{e9}", "caf??: no such verb, :help lists them"),
    ] {
        assert_eq!(line(text), Err(refusal.into()), "{text}");
    }
    let settings = line("set").unwrap_err();
    for setting in Setting::ALL {
        assert!(settings.contains(setting.name()), "{settings}");
    }
    let longest = "w".repeat(72);
    for text in [
        "set",
        "get",
        "set lead",
        &longest,
        &format!("set lead {longest}")[..72],
    ] {
        let refusal = line(text).unwrap_err();
        assert!("ERR ".len() + refusal.len() < LINE_LEN, "{refusal}");
    }
    let typed = commands(format!(":set {}\n5", "x".repeat(200)).as_bytes());
    let Command::Line(Err(refusal)) = &typed[0] else {
        panic!("{typed:?}");
    };
    assert_eq!(refusal.to_string(), "set: the line is too long");
    assert_eq!(typed.len(), 2, "{typed:?}");
}

#[test]
fn numbers_are_those_of_the_standard_library() {
    let mut random = Random(1);
    for round in 0..100_000 {
        let decimals = round % 5;
        let text = format!("{:.decimals$}", random.between(0.0, 1000.0));
        let Ok(Request::Set(_, value)) = line(&format!("set heading-time {text}")) else {
            // Below the setting's range.
            assert!(text.parse::<f32>().unwrap() < 0.1, "{text}");
            continue;
        };
        let exact: f32 = text.parse().unwrap();
        assert!(
            (value - exact).abs() <= exact * f32::EPSILON,
            "{text}: {value}"
        );
    }
    for text in [
        "",
        ".",
        "-",
        "+-1",
        "1.2.3",
        "1,5",
        "0x10",
        "1234567890",
        "١",
    ] {
        assert!(line(&format!("set lead {text}")).is_err(), "{text}");
    }
}

#[test]
fn whatever_is_typed_is_a_command_or_nothing() {
    let mut random = Random(2);
    let mut parser = Parser::new();
    let alphabet = b":setlad .0129-\n\r\xFF\0br";
    let mut answers = 0;
    for round in 0..2_000_000 {
        let index = (random.unit() * alphabet.len() as f64) as usize;
        if round % 10 == 0 {
            // Or a zero would silence it for good.
            (0..20).for_each(|_| parser.idle());
        }
        if let Some(Command::Line(Err(refusal))) = parser.push(alphabet[index]) {
            assert!(refusal.to_string().len() < LINE_LEN - 4);
            answers += 1;
        }
    }
    assert!(answers > 10_000, "{answers}");
}

#[test]
fn an_echo_of_the_stream_presses_no_keys_and_a_mistyped_key_is_soon_forgotten() {
    let mut parser = Parser::new();
    let stream = "vrduino 0.1.0\nMeasuring bias\nBias: 0.1 5 2 deg/s (still)\nQC 1.000 0.000 0.000 0.000\n\
                  error: the IMU stopped answering; look at its wires\r\nnReads/sec: 1000\nGYR: 1 2 3\n";
    for byte in stream.bytes() {
        assert_eq!(parser.push(byte), None);
    }
    assert_eq!(parser.push(b'x'), None);
    assert_eq!(parser.push(b'2'), None);
    for _ in 0..20 {
        parser.idle();
    }
    assert_eq!(parser.push(b'2'), Some(Command::Mode(Mode::ThreeD)));
    // A line of ours may be typed by hand.
    parser.push(b':');
    for _ in 0..1000 {
        parser.idle();
    }
    assert_eq!(parser.push(b'2'), None);
    // But not for ever.
    for _ in 0..10_000 {
        parser.idle();
    }
    assert_eq!(parser.push(b'2'), Some(Command::Mode(Mode::ThreeD)));
}

#[test]
fn an_echo_of_frames_presses_no_keys() {
    let mut random = Random(3);
    let mut byte = || (random.unit() * 256.0) as u8;
    for cooked in [false, true] {
        let mut parser = Parser::new();
        assert_eq!(parser.push(b'2'), Some(Command::Mode(Mode::ThreeD)));
        for _ in 0..100_000 {
            let q = Q30([(); 4].map(|()| i32::from_le_bytes([(); 4].map(|()| byte()))));
            let frame = frame::orientation(q, Provenance::default());
            let line = b"OK stream binary every 1\n".as_slice();
            for &byte in frame.iter().chain(line) {
                // As a terminal in its default state shows what is no letter.
                let shown = match byte {
                    b'\r' if cooked => vec![b'\n'],
                    0..32 if cooked && byte != b'\n' => vec![b'^', byte + 64],
                    127 if cooked => b"^?".to_vec(),
                    other => vec![other],
                };
                for byte in shown {
                    assert_eq!(parser.push(byte), None);
                }
            }
            (0..5).for_each(|_| parser.idle());
        }
        // It ends when the echo does.
        (0..20).for_each(|_| parser.idle());
        assert_eq!(parser.push(b'2'), Some(Command::Mode(Mode::ThreeD)));
    }
}
