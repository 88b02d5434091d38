//! The program under test, as a user starts it.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::{Duration, Instant};

/// Nothing takes longer, the board's image to be built included.
pub const LIMIT: Duration = Duration::from_secs(300);

/// A program that runs; it is ended when this is dropped.
pub struct Program {
    child: Child,
    stdin: Option<ChildStdin>,
    said: Receiver<String>,
    complained: Receiver<String>,
    /// Of this computer, where it serves.
    pub port: u16,
}

impl Program {
    /// `vrduino view` at any free port.
    pub fn view(arguments: &[&str]) -> Self {
        let all = [&["view", "--no-open", "--http-port", "0"], arguments].concat();
        Self::serve_at(Command::new(vrduino()).args(all).stdin(Stdio::piped()))
    }

    /// `vrduino serve` at any free port.
    pub fn serve(arguments: &[&str]) -> Self {
        let all = [&["serve", "--ws-port", "0"], arguments].concat();
        Self::serve_at(Command::new(vrduino()).args(all).stdin(Stdio::piped()))
    }

    /// Whatever serves, once it has said where.
    pub fn serve_at(command: &mut Command) -> Self {
        let mut child = command
            .env("RUST_BACKTRACE", "0")
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut program = Self {
            stdin: child.stdin.take(),
            said: collect(child.stdout.take().expect("piped")),
            complained: collect(child.stderr.take().expect("piped")),
            port: 0,
            child,
        };
        let address = program.line();
        let port = address.trim_end_matches('/').rsplit(':').next();
        program.port = port.and_then(|port| port.parse().ok()).expect("a port");
        program
    }

    /// The next line of its standard output.
    pub fn line(&self) -> String {
        self.said.recv_timeout(LIMIT).expect("it says something")
    }

    /// Waits until it says this on its standard output.
    pub fn says(&self, wanted: &str) {
        wait_for(&self.said, wanted);
    }

    /// Waits until it says this on its standard error.
    pub fn complains(&self, wanted: &str) {
        wait_for(&self.complained, wanted);
    }

    /// Types this.
    pub fn type_in(&mut self, text: &str) {
        let stdin = self.stdin.as_mut().expect("a pipe");
        stdin.write_all(text.as_bytes()).expect("it is read");
    }

    /// Ctrl-C.
    #[cfg(unix)]
    pub fn interrupt(&self) {
        let pid = rustix::process::Pid::from_child(&self.child);
        rustix::process::kill_process(pid, rustix::process::Signal::INT).expect("it runs");
    }

    /// Waits for its end.
    pub fn end(&mut self) -> ExitStatus {
        let began = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().expect("a child") {
                return status;
            }
            assert!(began.elapsed() < LIMIT, "it does not end");
            thread::sleep(Duration::from_millis(10));
        }
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

pub fn vrduino() -> &'static str {
    env!("CARGO_BIN_EXE_vrduino")
}

/// The exit code and the complaint of one that does not come to serve.
pub fn fails(arguments: &[&str]) -> (Option<i32>, String) {
    let output = Command::new(vrduino())
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .expect("the program starts");
    let complaint = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code(), complaint)
}

fn wait_for(lines: &Receiver<String>, wanted: &str) {
    let began = Instant::now();
    let mut heard = Vec::new();
    while began.elapsed() < LIMIT {
        match lines.recv_timeout(Duration::from_millis(100)) {
            Ok(line) if line.contains(wanted) => return,
            Ok(line) => heard.push(line),
            Err(mpsc::RecvTimeoutError::Timeout) => {}
            Err(mpsc::RecvTimeoutError::Disconnected) => break,
        }
    }
    panic!("it never says {wanted:?}, but {heard:#?}");
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
