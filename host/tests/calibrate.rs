//! Promise: what the calibration finds is what is wrong with the part, the board keeps it, and poor data is refused.

mod program;

#[cfg(unix)]
mod pty;

use program::{Ended, place, vrduino};
use vrduino_emulator::mpu9250::Part;

const G: f64 = 9.80665;

/// The three numbers behind this word in the line that begins with that name.
fn three(ended: &Ended, name: &str, word: &str) -> [f64; 3] {
    let line = ended.out.lines().find(|line| line.starts_with(name));
    let line = line.unwrap_or_else(|| panic!("{name}: {ended:?}"));
    let (_, rest) = line.split_once(word).expect("the word");
    let numbers: Vec<f64> = rest
        .split([' ', ','])
        .filter(|word| !word.is_empty())
        .map_while(|word| word.parse().ok())
        .collect();
    numbers[..3].try_into().expect("three numbers")
}

#[track_caller]
fn near(found: [f64; 3], truth: [f64; 3], within: f64) {
    for (found, truth) in found.iter().zip(truth) {
        assert!((found - truth).abs() < within, "{found} for {truth}");
    }
}

#[test]
fn the_faults_of_a_typical_part_are_found_and_kept() {
    let picture = place("typical.svg");
    let ended = vrduino(&[
        "calibrate",
        "--emulate",
        "--unpaced",
        "--part",
        "typical",
        "--seed",
        "5",
        "--yes",
        "--picture",
        picture.to_str().expect("plain letters"),
    ]);
    ended
        .expect(0)
        .said("all six faces")
        .said("the board keeps it: field");
    let part = Part::typical(5);
    near(three(&ended, "gyro", "bias"), part.gyro.bias, 0.1);
    near(
        three(&ended, "accelerometer", "bias"),
        part.accel.bias.map(|bias| bias * G),
        0.02,
    );
    near(
        three(&ended, "accelerometer", "factors"),
        part.accel.scale.map(|scale| 1.0 / (1.0 + scale)),
        0.002,
    );
    // Exchanged, and negated: the magnetometer has axes of its own.
    let [x, y, z] = part.magnetic.offset;
    near(three(&ended, "magnetometer", "hard iron"), [y, x, -z], 1.0);
    let drawn = std::fs::read_to_string(&picture).expect("the picture");
    assert!(drawn.matches("<circle").count() > 200, "{}", drawn.len());
    std::fs::remove_file(&picture).expect("removed");
}

#[test]
fn a_board_that_only_lies_there_is_refused_with_what_is_missing() {
    let lines = place("still.keep");
    let picture = place("still.svg");
    vrduino(&[
        "calibrate",
        "--emulate",
        "--unpaced",
        "--motion",
        "still",
        "--seconds",
        "3",
        "--dry-run",
        lines.to_str().expect("plain letters"),
        "--picture",
        picture.to_str().expect("plain letters"),
    ])
    .expect(4)
    .said("accelerometer  refused: not still long enough with x up, x down, y down, z up, z down")
    .said("magnetometer   refused: ")
    .said("nothing sent");
    // The gyro's bias alone is worth keeping.
    let lines_said = std::fs::read_to_string(&lines).expect("the lines");
    assert_eq!(lines_said.lines().count(), 7, "{lines_said}");
    assert!(lines_said.starts_with(":keep 0 5643"), "{lines_said}");
    assert!(lines_said.ends_with(":keep done\n"), "{lines_said}");
    for file in [lines, picture] {
        std::fs::remove_file(file).expect("removed");
    }
}

#[test]
fn what_makes_no_sense_is_refused_at_once() {
    vrduino(&["calibrate", "--emulate", "--seconds", "0"]).expect(2);
    vrduino(&["calibrate", "--replay", "x.csv"])
        .expect(2)
        .said("unexpected argument '--replay'");
    vrduino(&["calibrate", "--port", "tcp:127.0.0.1:1"])
        .expect(3)
        .said("nothing answers");
}

#[cfg(unix)]
mod in_a_terminal {
    use std::fs::File;
    use std::io::{ErrorKind, Read, Write};
    use std::os::fd::OwnedFd;
    use std::process::{Child, Stdio};
    use std::thread;
    use std::time::{Duration, Instant};

    use rustix::fs::{Mode, OFlags, open};
    use rustix::process::{Pid, Signal, kill_process};

    use super::program::{PATIENCE, command, place};
    use super::pty::Pty;

    /// A calibration of a board that only lies there, in a terminal of its own.
    struct Seat {
        user: File,
        /// Held open: what the program said last can be read when it has ended.
        _terminal: OwnedFd,
        child: Child,
        seen: String,
    }

    impl Seat {
        fn take() -> Self {
            let Pty { device, path } = Pty::open();
            let terminal = open(
                path,
                OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC,
                Mode::empty(),
            )
            .expect("opens");
            let end = || terminal.try_clone().expect("one more");
            let child = command()
                .args(["calibrate", "--emulate", "--unpaced", "--motion", "still"])
                .args(["--seconds", "3", "--picture"])
                .arg(place("asked.svg"))
                .stdin(end())
                .stdout(end())
                .stderr(Stdio::null())
                .spawn()
                .expect("the program starts");
            Self {
                user: device,
                _terminal: terminal,
                child,
                seen: String::new(),
            }
        }

        fn until(&mut self, words: &str) {
            let began = Instant::now();
            while !self.seen.contains(words) {
                assert!(began.elapsed() < PATIENCE, "no {words}: {}", self.seen);
                let mut buffer = [0; 4096];
                match self.user.read(&mut buffer) {
                    Ok(count) => self.seen += &String::from_utf8_lossy(&buffer[..count]),
                    Err(error) if error.kind() == ErrorKind::WouldBlock => {
                        thread::sleep(Duration::from_millis(10));
                    }
                    Err(error) => panic!("{error}; no {words}: {}", self.seen),
                }
            }
        }

        fn end(mut self) -> Option<i32> {
            let began = Instant::now();
            loop {
                if let Some(status) = self.child.try_wait().expect("a child") {
                    return status.code();
                }
                assert!(began.elapsed() < PATIENCE, "it does not end");
                thread::sleep(Duration::from_millis(10));
            }
        }
    }

    impl Drop for Seat {
        fn drop(&mut self) {
            let _ = self.child.kill();
            let _ = self.child.wait();
            let _ = std::fs::remove_file(place("asked.svg"));
        }
    }

    #[test]
    fn the_question_can_be_answered_and_left() {
        let mut seat = Seat::take();
        seat.until("[y/N]");
        let pid = Pid::from_child(&seat.child);
        kill_process(pid, Signal::INT).expect("it runs");
        seat.until("stopped: the board is as it was");
        assert_eq!(seat.end(), Some(0));

        // What was refused makes it a 4.
        let mut seat = Seat::take();
        seat.until("[y/N]");
        seat.user.write_all(b"n\n").expect("typed");
        seat.until("nothing sent: the board is as it was");
        assert_eq!(seat.end(), Some(4));

        let mut seat = Seat::take();
        seat.until("[y/N]");
        seat.user.write_all(b"y\n").expect("typed");
        seat.until("the board keeps it");
        assert_eq!(seat.end(), Some(4));
    }
}
