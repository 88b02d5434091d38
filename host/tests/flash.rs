//! Promise: what is flashed is sound, the board is asked into its loader and runs the new program afterwards; what goes
//! wrong on the way is said.
//!
//! The board is the emulated one on a pseudo-terminal: it goes into its loader when the port is opened at 134 baud, and
//! boots what a stand-in for `teensy_loader_cli` has been given.
#![cfg(unix)]

mod program;

mod pty;

use std::fs;
use std::io::{Read, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};

use program::{Ended, Program, place};
use pty::Pty;
use rustix::termios::tcgetattr;
use vrduino_emulator::board::{Board, Setup};
use vrduino_emulator::firmware::{self, BuildOptions};
use vrduino_emulator::image::Image;
use vrduino_emulator::motion::Turns;
use vrduino_emulator::time::MILLISECOND;

/// A folder with a loader in it, and what passes between that and the board.
struct Bench(PathBuf);

impl Bench {
    /// With a loader that does this.
    fn new(name: &str, script: &str) -> Self {
        let folder = place(name);
        fs::create_dir_all(&folder).expect("a folder");
        let loader = folder.join("teensy_loader_cli");
        fs::write(
            &loader,
            format!("#!/bin/sh\ncd '{}'\n{script}", folder.display()),
        )
        .expect("a script");
        fs::set_permissions(&loader, fs::Permissions::from_mode(0o755)).expect("executable");
        Self(folder)
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn flash(&self, words: &[&str]) -> Ended {
        let path = std::env::var_os("PATH").unwrap_or_default();
        let folders = std::iter::once(self.0.clone()).chain(std::env::split_paths(&path));
        let path = std::env::join_paths(folders).expect("a path");
        let mut command = program::command();
        Program::spawn(command.arg("flash").args(words).env("PATH", path)).end()
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Waits until the board is in its loader, takes the file, and waits until the board has it.
const WRITES: &str = "\
echo \"$@\" > words
echo 'Waiting for Teensy device...'
for i in $(seq 600); do [ -e in-loader ] && break; sleep 0.1; done
[ -e in-loader ] || exit 1
echo 'Found HalfKay Bootloader'
cp \"$4\" coming.hex && mv coming.hex new.hex
printf 'Programming...'
echo Booting
";

/// A board that can be flashed.
struct Flashable {
    path: String,
    wanted: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Flashable {
    /// Runs this until it is sent into its loader, and then what the bench's loader was given.
    fn new(bench: &Bench) -> Self {
        let image = firmware::build(BuildOptions { quiet: true }).expect("the firmware builds");
        let image = Image::open(&image).expect("an image");
        let Pty { mut device, path } = Pty::open();
        let wanted = Arc::new(AtomicBool::new(true));
        let flag = Arc::clone(&wanted);
        let (marker, new) = (bench.file("in-loader"), bench.file("new.hex"));
        let still = || Setup::new(Box::new(Turns::new(3600.0, 0.0)));
        let thread = thread::spawn(move || {
            let mut board = Board::new(image, still());
            let mut speed = 0;
            while flag.load(Ordering::Relaxed) {
                board.run(MILLISECOND);
                let now = tcgetattr(&device).expect("settings").output_speed();
                if now != std::mem::replace(&mut speed, now) {
                    board.chip().host.set_baud(now);
                }
                if board.in_loader().is_some() {
                    fs::write(&marker, "").expect("a marker");
                    if new.exists() {
                        let image = Image::open(&new).expect("what was judged");
                        board = Board::new(image, still());
                        fs::remove_file(&marker).expect("removed");
                        fs::remove_file(&new).expect("removed");
                    }
                    continue;
                }
                let mut typed = [0; 256];
                if let Ok(count) = device.read(&mut typed) {
                    board.chip().host.send(&typed[..count]);
                }
                // What nobody reads is lost.
                let bytes = board.chip_quietly().host.take_received();
                let _ = device.write(&bytes);
            }
        });
        Self {
            path,
            wanted,
            thread: Some(thread),
        }
    }
}

impl Drop for Flashable {
    fn drop(&mut self) {
        self.wanted.store(false, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[test]
fn a_board_runs_what_was_flashed() {
    let bench = Bench::new("writes", WRITES);
    let board = Flashable::new(&bench);
    bench
        .flash(&["--port", &board.path])
        .expect(0)
        .said("the image is sound")
        .said("was asked to go into its loader")
        .said("Found HalfKay Bootloader")
        .said("the board is back and says it is vrduino 0.1.0");
    let words = fs::read_to_string(bench.file("words")).expect("what it was called with");
    assert!(words.starts_with("--mcu=TEENSY32 -w -v /"), "{words}");
}

#[test]
fn a_dry_run_touches_nothing() {
    let bench = Bench::new("dry", WRITES);
    bench
        .flash(&["--dry-run", "--port", "/dev/there-is-none"])
        .expect(0)
        .said("would open /dev/there-is-none at 134 baud")
        .said("would run teensy_loader_cli --mcu=TEENSY32 -w -v ");
    assert!(!bench.file("words").exists());
}

#[test]
fn what_lies_beside_an_elf_file_stays_as_it_is() {
    let bench = Bench::new("beside", WRITES);
    let elf = firmware::build(BuildOptions { quiet: true }).expect("the firmware builds");
    let (mine, kept) = (bench.file("mine.elf"), bench.file("mine.hex"));
    fs::copy(elf, &mine).expect("a copy");
    fs::write(&kept, "kept").expect("a file");
    let ended = bench.flash(&[
        "--dry-run",
        "--hex",
        text(&mine),
        "--port",
        "/dev/there-is-none",
    ]);
    ended.expect(0);
    assert_eq!(fs::read_to_string(&kept).expect("the file"), "kept");
    let words = ended.out.split_whitespace();
    let hex = words.last().expect("what would be written");
    assert!(hex.ends_with("mine.hex") && hex != text(&kept), "{hex}");
    let image = Image::open(Path::new(hex)).expect("an image");
    assert_eq!(image.to_hex(), Image::open(&mine).expect("it").to_hex());
}

#[test]
fn what_would_lock_the_board_is_not_flashed() {
    let bench = Bench::new("locks", WRITES);
    let image = firmware::build(BuildOptions { quiet: true }).expect("the firmware builds");
    let hex = Image::open(&image).expect("an image").to_hex();
    // The flash configuration field is at 0x400: what secures the chip lies at 0x40C.
    let secured = bench.file("secured.hex");
    fs::write(&secured, changed(&hex, 0x40C, 0x00)).expect("a file");
    let port = Pty::open();
    bench
        .flash(&["--hex", text(&secured), "--port", &port.path])
        .expect(5)
        .said("nothing was flashed: ");
    assert!(!bench.file("words").exists(), "the loader was run");
}

/// The hex file with another byte at this address.
fn changed(hex: &str, address: usize, value: u8) -> String {
    let lines = hex.lines().map(|line| {
        let bytes: Vec<u8> = (1..line.len())
            .step_by(2)
            .map(|at| u8::from_str_radix(&line[at..at + 2], 16).expect("hexadecimal"))
            .collect();
        let start = usize::from(bytes[1]) << 8 | usize::from(bytes[2]);
        let mut body = bytes[..bytes.len() - 1].to_vec();
        if body[3] == 0 && (start..start + usize::from(body[0])).contains(&address) {
            body[4 + address - start] = value;
        }
        let sum = body.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
        body.push(sum.wrapping_neg());
        let digits: String = body.iter().map(|byte| format!("{byte:02X}")).collect();
        format!(":{digits}\n")
    });
    // Only the first 64 KiB have this address.
    let mut first = true;
    lines
        .zip(hex.lines())
        .map(|(new, old)| {
            first &= !old.starts_with(":02000004") || old.starts_with(":020000040000");
            if first { new } else { format!("{old}\n") }
        })
        .collect()
}

#[test]
fn a_loader_that_fails_is_explained() {
    let bench = Bench::new(
        "fails",
        "echo 'Found HalfKay Bootloader'\necho 'error writing to Teensy' >&2\nexit 1\n",
    );
    let port = Pty::open();
    bench
        .flash(&["--port", &port.path])
        .expect(3)
        .said("error writing to Teensy")
        .said("teensy_loader_cli has failed")
        .said("its cable is bad");
}

#[test]
fn without_a_loader_it_is_said_where_to_get_one() {
    let bench = Bench::new("none", "");
    fs::remove_file(bench.file("teensy_loader_cli")).expect("removed");
    let ended = bench.flash(&["--port", "/dev/there-is-none"]);
    if vrduino_host::computer::programs::installed("teensy_loader_cli").is_some() {
        // Here it is at hand: then the port is what is missing.
        ended.expect(3).said("is not there");
    } else {
        ended
            .expect(6)
            .said("https://www.pjrc.com/teensy/loader_cli.html");
    }
}

#[test]
fn a_port_that_is_not_there_or_no_port_is_said() {
    let bench = Bench::new("absent", WRITES);
    bench
        .flash(&["--port", "/dev/there-is-none"])
        .expect(3)
        .said("/dev/there-is-none is not there");
    bench
        .flash(&["--port", "tcp:127.0.0.1:1"])
        .expect(3)
        .said("has no loader");
    let no_image = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
    bench
        .flash(&["--hex", no_image])
        .expect(5)
        .said("nothing was flashed");
    assert!(!bench.file("words").exists());
}

fn text(path: &Path) -> &str {
    path.to_str().expect("plain letters")
}
