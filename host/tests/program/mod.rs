//! The program under test, as a user starts it.

#![allow(dead_code)] // not every test asks for everything

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::{Duration, Instant};

/// Nothing takes longer, the board's image to be built included.
const PATIENCE: Duration = Duration::from_secs(300);

/// A program that runs; it is ended when this is dropped.
pub struct Program {
    child: Child,
    lines: Receiver<String>,
    errors: Receiver<String>,
}

/// How it ended, and what it said.
#[derive(Debug)]
pub struct Ended {
    pub code: Option<i32>,
    /// Standard output, what was not asked for before.
    pub out: String,
    /// Standard error.
    pub err: String,
}

/// Runs it to its end.
pub fn vrduino(arguments: &[&str]) -> Ended {
    Program::start(arguments).end()
}

/// A file or folder of a test's own.
pub fn place(name: &str) -> PathBuf {
    let name = format!("{name}-{}", std::process::id());
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

impl Ended {
    /// Fails unless it ended so.
    #[track_caller]
    pub fn expect(&self, code: i32) -> &Self {
        assert_eq!(self.code, Some(code), "{}{}", self.out, self.err);
        self
    }

    /// Fails unless it has said so, somewhere.
    #[track_caller]
    pub fn said(&self, words: &str) -> &Self {
        let said = self.out.contains(words) || self.err.contains(words);
        assert!(said, "not said: {words}\n{}{}", self.out, self.err);
        self
    }
}

impl Program {
    /// Starts it with these arguments, and nothing to read.
    pub fn start(arguments: &[&str]) -> Self {
        Self::spawn(Command::new(env!("CARGO_BIN_EXE_vrduino")).args(arguments))
    }

    /// Starts it as it was set up, with nothing to read.
    pub fn spawn(command: &mut Command) -> Self {
        let mut child = command
            .env("RUST_BACKTRACE", "0")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let stdout = child.stdout.take().expect("piped");
        let mut stderr = child.stderr.take().expect("piped");
        let (said, errors) = mpsc::channel();
        thread::spawn(move || {
            let mut text = String::new();
            let _ = stderr.read_to_string(&mut text);
            let _ = said.send(text);
        });
        Self {
            child,
            lines: collect(stdout),
            errors,
        }
    }

    /// The next line it prints; none if it has ended.
    pub fn line(&self) -> Option<String> {
        match self.lines.recv_timeout(PATIENCE) {
            Ok(line) => Some(line),
            Err(mpsc::RecvTimeoutError::Disconnected) => None,
            Err(mpsc::RecvTimeoutError::Timeout) => panic!("it says nothing any more"),
        }
    }

    /// Reads on until a line is so.
    pub fn until(&self, what: &str, is_so: impl Fn(&str) -> bool) -> String {
        loop {
            match self.line() {
                Some(line) if is_so(&line) => return line,
                Some(_) => {}
                None => panic!("it has ended without: {what}"),
            }
        }
    }

    /// Presses Ctrl-C.
    #[cfg(unix)]
    pub fn interrupt(&self) {
        let id = self.child.id().to_string();
        let sent = Command::new("kill").args(["-INT", &id]).status();
        assert!(sent.expect("kill").success());
    }

    /// Waits for its end.
    pub fn end(mut self) -> Ended {
        let began = Instant::now();
        let status = loop {
            if let Some(status) = self.child.try_wait().expect("a child") {
                break status;
            }
            assert!(began.elapsed() < PATIENCE, "it does not end");
            thread::sleep(Duration::from_millis(10));
        };
        Ended {
            code: status.code(),
            out: self.lines.iter().map(|line| line + "\n").collect(),
            err: self.errors.recv().unwrap_or_default(),
        }
    }
}

fn collect(stdout: ChildStdout) -> Receiver<String> {
    let (said, lines) = mpsc::channel();
    thread::spawn(move || {
        for line in BufReader::new(stdout).lines().map_while(Result::ok) {
            if said.send(line).is_err() {
                break;
            }
        }
    });
    lines
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
