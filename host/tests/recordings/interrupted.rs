//! What happens to a recording that does not end as it was meant to.

use std::fs;
use std::io::{self, Write};
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use nalgebra::{UnitQuaternion, Vector3};
use vrduino_host::recording::{Entry, Voice};

use crate::fixture::{Scratch, entries, read, samples};
use crate::program::{Program, vrduino};
use crate::pty::{PluggedIn, Pty};

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
    // 64 kB; as the system does it where a quota is used up.
    let script = r#"trap '' XFSZ; ulimit -f 128; exec "$0" record --emulate --seconds 20 "$1""#;
    let mut shell = Command::new("bash");
    shell.args(["-c", script, env!("CARGO_BIN_EXE_vrduino"), file.path()]);
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
    let link = Scratch::new("plug");
    let file = Scratch::new("replugged.csv");
    let point_to = |path: &str| -> io::Result<()> {
        let _ = fs::remove_file(&link.0);
        std::os::unix::fs::symlink(path, &link.0)
    };
    let board = PluggedIn::new(Vec::new);
    point_to(&board.path).expect("a link");
    let recorder = Program::start(&["record", "--port", link.path(), file.path()]);
    wait("some samples", || lines(&file) > 500);
    drop(board);
    wait("a note", || {
        fs::read_to_string(&file.0)
            .is_ok_and(|text| text.contains("# note") && text.contains("is gone"))
    });
    let before = lines(&file);
    let board = PluggedIn::new(Vec::new);
    point_to(&board.path).expect("a link");
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

/// The course's firmware says nothing of itself: nothing of it is left out.
#[test]
fn a_board_that_does_not_answer_is_recorded_from_its_first_sample_on() {
    let file = Scratch::new("course.csv");
    let Pty { mut device, path } = Pty::open();
    let wanted = Arc::new(AtomicBool::new(true));
    let flag = Arc::clone(&wanted);
    let course = thread::spawn(move || {
        // Angles by which they are known again; the first is 0.
        for tick in 0_u32.. {
            let half = f64::from(tick % 3000) * 1e-3;
            let (w, y) = (half.cos(), half.sin());
            let line = format!("QC {w:.3} 0.000 {y:.3} 0.000\n");
            while device.write_all(line.as_bytes()).is_err() {
                if !flag.load(Ordering::Relaxed) {
                    return;
                }
                thread::sleep(Duration::from_millis(5));
            }
            thread::sleep(Duration::from_millis(5));
            if !flag.load(Ordering::Relaxed) {
                return;
            }
        }
    });
    let recorder = Program::start(&["record", "--port", &path, "--seconds", "4", file.path()]);
    let code = recorder.end().code;
    wanted.store(false, Ordering::Relaxed);
    course.join().expect("it ends");
    assert_eq!(code, Some(0));
    let samples = samples(&entries(file.path()));
    assert!(samples.len() > 100, "{}", samples.len());
    let last = samples.len() - 1;
    assert!(samples[last].arrival - samples[0].arrival >= 3.9);
    for (tick, sample) in samples.iter().enumerate() {
        assert_eq!(
            (sample.sequence, sample.status, sample.delay),
            (None, None, None)
        );
        assert_eq!(sample.is_first, tick == 0);
        let angle = tick as f64 * 2e-3;
        let turned = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angle);
        assert!(
            sample.orientation.angle_to(&turned) < 5e-3,
            "{tick}: {sample:?}"
        );
    }
}

#[test]
fn the_time_is_over_even_if_the_board_has_gone() {
    let file = Scratch::new("gone.csv");
    let board = PluggedIn::new(Vec::new);
    let words = [
        "record",
        "--port",
        &board.path,
        "--seconds",
        "8",
        file.path(),
    ];
    let recorder = Program::start(&words);
    wait("the first samples", || lines(&file) > 100);
    drop(board);
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
    recorder.interrupt();
    assert_eq!(recorder.end().code, Some(3));
    assert!(!file.0.exists());
}
