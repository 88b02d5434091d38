//! The logic analyser's dump, read by somebody who knows nothing of the emulator.

use std::collections::HashMap;

use vrduino_emulator::vcd::Vcd;

use crate::trace::Paper;
use crate::tracker::{board, run, setup};

/// Changes of the one-bit variable `name`: nanoseconds and level.
struct Dump {
    /// Code of each variable by its name.
    codes: HashMap<String, String>,
    /// Time, code, value.
    changes: Vec<(u64, String, String)>,
}

impl Dump {
    fn parse(text: &str) -> Dump {
        let (header, body) = text.split_once("$enddefinitions $end").unwrap();
        let mut codes = HashMap::new();
        for line in header.lines().filter(|line| line.starts_with("$var")) {
            let words: Vec<&str> = line.split_whitespace().collect();
            assert_eq!(codes.insert(words[4].into(), words[3].into()), None);
        }
        let mut changes = Vec::new();
        let mut now = 0;
        for line in body.lines().filter(|line| !line.is_empty()) {
            if let Some(time) = line.strip_prefix('#') {
                let time = time.parse().unwrap();
                assert!(time >= now, "time goes back to {time}");
                now = time;
            } else if let Some(text) = line.strip_prefix('s') {
                let (value, code) = text.split_once(' ').unwrap();
                changes.push((now, code.into(), value.into()));
            } else {
                let (value, code) = line.split_at(1);
                assert!("01x".contains(value), "{line}");
                changes.push((now, code.into(), value.into()));
            }
        }
        Dump { codes, changes }
    }

    fn of<'a>(&'a self, name: &str) -> impl Iterator<Item = (u64, &'a str)> {
        let code = self.codes[name].clone();
        self.changes
            .iter()
            .filter(move |(_, other, _)| *other == code)
            .map(|(at, _, value)| (*at, value.as_str()))
    }
}

/// A transfer on the bus: what was decoded from a START to the next START or STOP.
#[derive(Debug, Default, Clone, PartialEq)]
struct Transfer {
    /// Each byte, and whether it was acknowledged.
    bytes: Vec<(u8, bool)>,
}

/// Decodes edges as UM10204 (3.1) has them: data is sampled while SCL is high, SDA moves there only for START and STOP.
fn decode(dump: &Dump) -> (Vec<Transfer>, Vec<u64>) {
    let (scl_code, sda_code) = (&dump.codes["scl"], &dump.codes["sda"]);
    let (mut scl, mut sda) = (true, true);
    let mut transfers = Vec::new();
    let mut current: Option<(Transfer, Vec<bool>)> = None;
    let (mut periods, mut rose) = (Vec::new(), 0);
    for (at, code, value) in &dump.changes {
        let level = value == "1";
        if code == scl_code && level != scl {
            scl = level;
            if !scl {
                continue;
            }
            if let Some((transfer, bits)) = &mut current {
                if !bits.is_empty() {
                    periods.push(at - rose);
                }
                bits.push(sda);
                if bits.len() == 9 {
                    let byte = bits[..8]
                        .iter()
                        .fold(0, |byte, &bit| byte << 1 | u8::from(bit));
                    transfer.bytes.push((byte, !bits[8]));
                    bits.clear();
                }
            }
            rose = *at;
        } else if code == sda_code && level != sda {
            sda = level;
            if scl {
                // The clock pulse in which SDA moved was no data.
                transfers.extend(current.take().map(|(transfer, _)| transfer));
                if !sda {
                    current = Some(Default::default());
                }
            }
        }
    }
    (transfers, periods)
}

fn dump(seconds: f64) -> (Dump, Vec<[u8; 15]>) {
    let paper = Paper::default();
    let mut board = board(setup());
    board.chip().sensor.recording = Some(Vec::new());
    board.watch(Box::new(Vcd::new(paper.clone()).unwrap()));
    run(&mut board, seconds);
    board.finish_watching().unwrap();
    let recording = board.chip().sensor.recording.take().unwrap();
    let bursts = recording.iter().map(|burst| burst.bytes).collect();
    (Dump::parse(&paper.text()), bursts)
}

#[test]
fn the_edges_on_the_sensor_bus_say_what_the_sensor_has_sent() {
    let (dump, bursts) = dump(0.4);
    let (transfers, periods) = decode(&dump);
    assert!(bursts.len() > 50, "{} bursts", bursts.len());
    let seen: Vec<Vec<u8>> = transfers
        .iter()
        .filter(|transfer| transfer.bytes.first() == Some(&(0xD1, true)))
        .map(|transfer| transfer.bytes[1..].iter().map(|(byte, _)| *byte).collect())
        .filter(|bytes: &Vec<u8>| bytes.len() == 15)
        .collect();
    let sent: Vec<Vec<u8>> = bursts.iter().map(|burst| burst.to_vec()).collect();
    assert_eq!(seen, sent);
    // The first question to the sensor, while it still starts up, is not answered.
    assert!(transfers.iter().any(|one| one.bytes == [(0xD0, false)]));
    // The reader refuses the last byte of every burst, and no other.
    for transfer in transfers.iter().filter(|one| one.bytes.len() == 16) {
        let (last, others) = transfer.bytes.split_last().unwrap();
        assert!(!last.1 && others.iter().all(|(_, acknowledged)| *acknowledged));
    }
    // 400 kHz at most, and never slower within a byte than the firmware has chosen.
    let (least, most) = (periods.iter().min().unwrap(), periods.iter().max().unwrap());
    assert!(*least >= 2_498 && *most < 3_500, "{least} to {most} ns");
}

#[test]
fn the_dump_shows_usb_sleep_and_interrupts() {
    let (dump, _) = dump(0.4);
    let packets: Vec<&str> = dump.of("usb").map(|(_, text)| text).collect();
    let has = |packet: &str| assert!(packets.contains(&packet), "no {packet}");
    has("SE0_reset");
    has("SETUP_ep0_DATA0_8_ACK");
    has("IN_ep0_DATA1_18_ACK");
    has("SOF_1");
    let frames: Vec<u64> = dump
        .of("usb")
        .filter(|(_, text)| text.starts_with("SOF_"))
        .map(|(at, _)| at)
        .collect();
    assert!(frames.len() > 100);
    for pair in frames.windows(2).skip(50) {
        assert!((pair[1] - pair[0]).abs_diff(1_000_000) < 2_000);
    }
    for wire in ["asleep", "irq_I2C0", "irq_USBOTG"] {
        let levels: Vec<&str> = dump.of(wire).map(|(_, level)| level).collect();
        assert!(levels.len() > 20, "{wire} moves");
        for pair in levels.windows(2) {
            assert_ne!(pair[0], pair[1], "{wire} only changes");
        }
    }
    let handled: Vec<&str> = dump.of("exception").map(|(_, text)| text).collect();
    assert!(handled.contains(&"main") && handled.contains(&"I2C0_(24)"));
}
