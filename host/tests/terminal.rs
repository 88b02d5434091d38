//! `vrduino tui` in a terminal of its own: what it finds there it leaves there.

#![cfg(all(unix, feature = "tui"))]

mod program;

#[path = "pty/terminal.rs"]
mod pty;

use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::os::fd::OwnedFd;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use program::Program;
use pty::Terminal;
use rustix::fs::{OFlags, fcntl_setfl};
use rustix::termios::{LocalModes, Winsize, tcgetattr, tcsetwinsize};

/// Nothing here takes longer, the image to be built included.
const PATIENCE: Duration = Duration::from_secs(300);

const TO_THE_OTHER_SCREEN: &str = "\x1b[?1049h";
const BACK: &str = "\x1b[?1049l";

/// A terminal with the program in it.
struct Seat {
    user: File,
    terminal: OwnedFd,
    child: Child,
    seen: Vec<u8>,
}

impl Seat {
    fn take(arguments: &[&str]) -> Self {
        let Terminal {
            person: user,
            program: terminal,
        } = Terminal::open();
        let size = Winsize {
            ws_row: 24,
            ws_col: 80,
            ws_xpixel: 0,
            ws_ypixel: 0,
        };
        tcsetwinsize(&terminal, size).expect("a size");
        fcntl_setfl(&user, OFlags::NONBLOCK).expect("does not block");
        let end = || terminal.try_clone().expect("one more");
        let child = Command::new(env!("CARGO_BIN_EXE_vrduino"))
            .args(arguments)
            .env("TERM", "xterm-256color")
            .stdin(end())
            .stdout(end())
            .stderr(end())
            .spawn()
            .expect("the program starts");
        Self {
            user,
            terminal,
            child,
            seen: Vec::new(),
        }
    }

    /// Whether there was anything.
    fn look(&mut self) -> bool {
        let mut buffer = [0; 65536];
        match self.user.read(&mut buffer) {
            Ok(count) => self.seen.extend(&buffer[..count]),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {
                std::thread::sleep(Duration::from_millis(10));
                return false;
            }
            Err(error) => panic!("{error}"),
        }
        true
    }

    fn has_seen(&self, words: &str) -> bool {
        String::from_utf8_lossy(&self.seen).contains(words)
    }

    fn until(&mut self, words: &str) {
        let began = Instant::now();
        while !self.has_seen(words) {
            assert!(began.elapsed() < PATIENCE, "no {words}");
            self.look();
        }
    }

    fn type_in(&mut self, keys: &[u8]) {
        self.user.write_all(keys).expect("typed");
    }

    /// Waits for the end, after which everything is to be as it was.
    fn leave(&mut self) {
        let began = Instant::now();
        let status = loop {
            self.look();
            if let Some(status) = self.child.try_wait().expect("a child") {
                break status;
            }
            assert!(began.elapsed() < PATIENCE, "it does not end");
        };
        while self.look() {}
        assert!(status.success(), "{status}");
        assert!(self.has_seen(BACK), "the other screen is left on");
        let modes = tcgetattr(&self.terminal).expect("settings").local_modes;
        assert!(modes.contains(LocalModes::ICANON | LocalModes::ECHO));
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn the_terminal_is_given_back() {
    // By a key, by Ctrl-C, which raw mode makes a key, and by the system.
    for end in ["q", "\x03", "SIGTERM"] {
        let mut seat = Seat::take(&["tui", "--emulate"]);
        seat.until(TO_THE_OTHER_SCREEN);
        seat.until("connected");
        if end == "SIGTERM" {
            let id = seat.child.id().to_string();
            let killed = Command::new("kill").arg(id).status().expect("kill");
            assert!(killed.success());
        } else {
            seat.type_in(end.as_bytes());
        }
        seat.leave();
    }
}

#[test]
fn with_nothing_plugged_in_enter_starts_the_emulated_board() {
    let mut seat = Seat::take(&["tui", "--port", "no-such-port"]);
    seat.until("Enter");
    seat.type_in(b"\r");
    seat.until("connected");
    seat.type_in(b"q");
    seat.leave();
}

#[test]
fn where_no_terminal_is_it_says_so() {
    let ended = Program::start(&["tui", "--emulate"]).end();
    assert_eq!(ended.code, Some(6), "{ended:?}");
    assert!(ended.err.contains("vrduino monitor"), "{ended:?}");
    assert!(ended.out.is_empty(), "{ended:?}");
}
