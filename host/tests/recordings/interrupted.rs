//! What happens to a recording that does not end as it was meant to.

use std::fs::{self, File};
use std::io::Read;
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use vrduino_emulator::firmware::{self, BuildOptions};
use vrduino_host::recording::{Entry, Voice};

use crate::fixture::{Scratch, entries, read, samples};
use crate::program::{Program, vrduino};
use crate::pty::{self, PluggedIn, Port, Pty};

/// Nothing here takes so long, even on a busy machine.
const LIMIT: Duration = Duration::from_secs(120);

fn wait(what: &str, mut is_so: impl FnMut() -> bool) {
    let began = Instant::now();
    while !is_so() {
        assert!(began.elapsed() < LIMIT, "{what} does not come");
        thread::sleep(Duration::from_millis(20));
    }
}

fn lines(file: &Scratch) -> usize {
    fs::read(&file.0).map_or(0, |bytes| {
        bytes.iter().filter(|&&byte| byte == b'\n').count()
    })
}

#[test]
fn ctrl_c_brings_it_to_its_end() {
    let file = Scratch::new("ctrl-c.csv");
    let recorder = Program::start(&["record", "--emulate", file.path()]);
    wait("some samples", || lines(&file) > 500);
    recorder.interrupt();
    assert_eq!(recorder.end().code, Some(0));
    assert!(samples(&entries(file.path())).len() > 400);
}

#[test]
fn a_crash_loses_little_and_the_rest_is_read() {
    let file = Scratch::new("crash.csv");
    let recorder = Program::start(&["record", "--emulate", file.path()]);
    wait("some samples", || lines(&file) > 500);
    // It is killed.
    drop(recorder);
    let (entries, warning) = read(file.path());
    let samples = samples(&entries);
    assert!(samples.len() > 400);
    let in_order = samples.windows(2).all(|pair| pair[0].time < pair[1].time);
    assert!(in_order);
    let warning = warning.expect("it is cut off");
    assert!(warning.contains("is cut off"), "{warning}");
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_told() {
    let words = ["record", "--emulate", "--seconds", "1", "/dev/full"];
    vrduino(&words)
        .expect(5)
        .said("the disk is full; nothing is recorded");
}

#[test]
#[cfg(target_os = "linux")]
fn what_was_written_before_there_was_no_room_can_be_read() {
    let file = Scratch::new("quota.csv");
    // Not within the limit.
    let image = firmware::build(BuildOptions { quiet: true }).expect("the firmware builds");
    // 64 kB; as the system does it where a quota is used up.
    let script =
        r#"trap '' XFSZ; ulimit -f 128; exec "$0" record --emulate --image "$2" --seconds 20 "$1""#;
    let mut shell = Command::new("bash");
    shell.args(["-c", script, env!("CARGO_BIN_EXE_vrduino"), file.path()]);
    shell.arg(image);
    let ended = Program::spawn(&mut shell).end();
    ended.expect(5).said("may not grow any further");
    let (entries, warning) = read(file.path());
    let count = samples(&entries).len();
    assert!(count > 200, "{count}");
    ended.said(&format!("its {count} samples so far are kept"));
    assert!(
        warning
            .expect("it is cut off")
            .contains(&format!("its {count} samples"))
    );
}

#[test]
fn a_board_that_goes_and_comes_back_is_one_recording() {
    let port = Port::new();
    let file = Scratch::new("replugged.csv");
    let board = PluggedIn::new(Vec::new);
    port.plug(&board);
    let recorder = Program::start(&["record", "--port", port.path(), file.path()]);
    wait("some samples", || lines(&file) > 500);
    port.pull(board);
    wait("a note", || {
        fs::read_to_string(&file.0)
            .is_ok_and(|text| text.contains("# note") && text.contains("is gone"))
    });
    let before = lines(&file);
    let board = PluggedIn::new(Vec::new);
    port.plug(&board);
    wait("more samples", || lines(&file) > before + 1500);
    recorder.interrupt();
    assert_eq!(recorder.end().code, Some(0));
    drop(board);
    let entries = entries(file.path());
    let notes: Vec<_> = entries
        .iter()
        .filter_map(|entry| match entry {
            Entry::Remark(remark) if remark.voice == Voice::Recorder => Some(remark.text.as_str()),
            _ => None,
        })
        .collect();
    assert!(
        notes.iter().any(|note| note.contains("is gone")),
        "{notes:?}"
    );
    assert!(
        notes.iter().any(|note| note.contains("is there again")),
        "{notes:?}"
    );
    let samples = samples(&entries);
    // The second time begins with the lines that a board sends after power-on, then come the frames.
    let firsts = samples.iter().filter(|sample| sample.is_first).count();
    assert!((2..=3).contains(&firsts), "{firsts}");
    assert!(samples.last().expect("one").sequence.is_some());
    for pair in samples.windows(2).filter(|pair| !pair[1].is_first) {
        let next = pair[0].sequence.map(|number| number.wrapping_add(1));
        assert_eq!(pair[1].sequence, next);
    }
}

/// Half the angle between two samples of [`course_firmware`], in radians: three decimals tell them apart.
const HALF_STEP: f64 = 4e-3;

/// After so many samples it begins again, short of half a turn.
const TICKS: u32 = 750;

/// The course's firmware: samples of 200 Hz known by their angles, no word of itself.
/// Comes to the number of the sample before which it first heard something.
fn course_firmware(mut device: File, wanted: &AtomicBool) -> Option<u32> {
    let mut asked_before = None;
    for tick in 0_u32.. {
        if asked_before.is_none() && matches!(device.read(&mut [0; 64]), Ok(1..)) {
            asked_before = Some(tick);
        }
        let half = f64::from(tick % TICKS) * HALF_STEP;
        let line = format!("QC {:.3} 0.000 {:.3} 0.000\n", half.cos(), half.sin());
        pty::write(&mut device, line.as_bytes(), wanted);
        thread::sleep(Duration::from_millis(5));
        if !wanted.load(Ordering::Relaxed) {
            break;
        }
    }
    asked_before
}

/// Nothing is left out of what comes once the port is open: the program's question is its first sign.
#[test]
fn a_board_that_does_not_answer_is_recorded_from_its_first_sample_on() {
    let file = Scratch::new("course.csv");
    let Pty { device, path } = Pty::open();
    let wanted = Arc::new(AtomicBool::new(true));
    let flag = Arc::clone(&wanted);
    let course = thread::spawn(move || course_firmware(device, &flag));
    let recorder = Program::start(&["record", "--port", &path, "--seconds", "4", file.path()]);
    let code = recorder.end().code;
    wanted.store(false, Ordering::Relaxed);
    let asked_before = course.join().expect("it ends").expect("a question");
    assert_eq!(code, Some(0));
    let samples = samples(&entries(file.path()));
    assert!(samples.len() > 10, "{}", samples.len());
    let last = samples.len() - 1;
    assert!(samples[last].arrival - samples[0].arrival >= 3.9);
    let ticks = samples.iter().map(|sample| {
        let half = sample.orientation.j.atan2(sample.orientation.w);
        (half / HALF_STEP).round() as u32
    });
    let first = ticks.clone().next().expect("a sample");
    assert!(
        first <= asked_before,
        "{first}, asked before {asked_before}"
    );
    for ((number, sample), tick) in samples.iter().enumerate().zip(ticks) {
        assert_eq!(
            (sample.sequence, sample.status, sample.delay),
            (None, None, None)
        );
        assert_eq!(sample.is_first, number == 0);
        assert_eq!(
            tick,
            (first + number as u32) % TICKS,
            "{number}: {sample:?}"
        );
    }
}

#[test]
fn the_time_is_over_even_if_the_board_has_gone() {
    let file = Scratch::new("gone.csv");
    let port = Port::new();
    let board = PluggedIn::new(Vec::new);
    port.plug(&board);
    let words = [
        "record",
        "--port",
        port.path(),
        "--seconds",
        "8",
        file.path(),
    ];
    let recorder = Program::start(&words);
    wait("the first samples", || lines(&file) > 100);
    port.pull(board);
    let ended = recorder.end();
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    assert!(ended.err.contains("is gone"), "{}", ended.err);
    let count = samples(&entries(file.path())).len();
    assert!(
        ended.out.contains(&format!("{count} samples in")),
        "{}",
        ended.out
    );
}

#[test]
fn without_a_board_nothing_is_left_behind() {
    let file = Scratch::new("nobody.csv");
    let recorder = Program::start(&["record", "--port", "/dev/no-such-port", file.path()]);
    wait("the file", || file.0.exists());
    recorder.complains("is not there");
    recorder.interrupt();
    assert_eq!(recorder.end().code, Some(3));
    assert!(!file.0.exists());
}
