//! The program under test, as a user starts it.

// Every test file compiles a copy of this and calls what it needs of it: the rest is unused there, not everywhere.
#![allow(dead_code, reason = "not every test asks for everything")]

use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::{Duration, Instant};

/// Nothing takes longer, the board's image to be built included.
pub const PATIENCE: Duration = Duration::from_secs(300);

/// A program that runs; it is ended when this is dropped.
pub struct Program {
    child: Child,
    stdin: Option<ChildStdin>,
    lines: Receiver<String>,
    errors: Receiver<String>,
}

/// How it ended, and what it said.
#[derive(Debug)]
pub struct Ended {
    pub code: Option<i32>,
    /// Standard output, what was not asked for before.
    pub out: String,
    /// Standard error, likewise.
    pub err: String,
}

/// The program, to be set up.
pub fn command() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vrduino"));
    command.env("RUST_BACKTRACE", "0").stdin(Stdio::null());
    command
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
        Self::spawn(command().args(arguments))
    }

    /// Starts it as it was set up.
    pub fn spawn(command: &mut Command) -> Self {
        let mut child = command
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        Self {
            stdin: child.stdin.take(),
            lines: collect(child.stdout.take().expect("piped")),
            errors: collect(child.stderr.take().expect("piped")),
            child,
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

    /// Waits until it says this on its standard error.
    pub fn complains(&self, wanted: &str) {
        let complaint = self.errors.iter().find(|line| line.contains(wanted));
        assert!(complaint.is_some(), "it has ended without: {wanted}");
    }

    /// Types this.
    pub fn type_in(&mut self, text: &str) {
        let stdin = self.stdin.as_mut().expect("a pipe");
        stdin.write_all(text.as_bytes()).expect("it is read");
    }

    /// Presses Ctrl-C.
    #[cfg(unix)]
    pub fn interrupt(&self) {
        let pid = rustix::process::Pid::from_child(&self.child);
        rustix::process::kill_process(pid, rustix::process::Signal::INT).expect("it runs");
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
        let rest = |lines: &Receiver<String>| lines.iter().map(|line| line + "\n").collect();
        Ended {
            code: status.code(),
            out: rest(&self.lines),
            err: rest(&self.errors),
        }
    }
}

fn collect(pipe: impl Read + Send + 'static) -> Receiver<String> {
    let (said, lines) = mpsc::channel();
    thread::spawn(move || {
        for line in BufReader::new(pipe).lines().map_while(Result::ok) {
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
