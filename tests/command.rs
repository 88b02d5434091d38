//! Keys and lines from the host, byte by byte.

use vrduino::command::{Command, Mode, Parser};

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
        assert_eq!(command, meant.map(|(_, command)| *command), "{byte}");
    }
}

#[test]
fn the_words_of_a_line_press_no_keys() {
    let commands = |bytes: &[u8]| {
        let mut parser = Parser::new();
        let meant: Vec<_> = bytes.iter().filter_map(|&b| parser.push(b)).collect();
        meant
    };
    assert_eq!(commands(b":rate 100\nr"), [Command::Reset]);
    assert_eq!(commands(b":rate 100\r\nb"), [Command::MeasureBias]);
    assert_eq!(commands(b":rate 100\rb"), [Command::MeasureBias]);
    assert_eq!(commands(b":a:b\n"), []);
    // A colon that no newline follows does not silence the keys for ever.
    let noise = [b":".as_slice(), &[b'r'; 129], b"r"].concat();
    assert_eq!(commands(&noise), [Command::Reset]);
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
}
