//! The built program, run to its end.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Nothing here takes so long, even on a busy machine.
const LIMIT: Duration = Duration::from_secs(300);

/// What came of it.
#[derive(Debug)]
pub struct Ended {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

/// Runs it with these words, in a terminal's absence.
pub fn vrduino(words: &[&str]) -> Ended {
    run(Command::new(env!("CARGO_BIN_EXE_vrduino")).args(words))
}

/// The same as it was set up.
pub fn run(command: &mut Command) -> Ended {
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let out = collect(child.stdout.take());
    let err = collect(child.stderr.take());
    let status = end(&mut child);
    let (out, err) = (text(out), text(err));
    let status = status.unwrap_or_else(|| panic!("it does not end within {LIMIT:?}:\n{out}{err}"));
    let code = status.code();
    Ended { code, out, err }
}

/// Waits for it; kills it where it takes too long.
fn end(child: &mut Child) -> Option<ExitStatus> {
    let began = Instant::now();
    while began.elapsed() < LIMIT {
        if let Some(status) = child.try_wait().expect("a child of ours") {
            return Some(status);
        }
        thread::sleep(Duration::from_millis(10));
    }
    child.kill().expect("it ends");
    child.wait().expect("it has ended");
    None
}

fn collect(pipe: Option<impl Read + Send + 'static>) -> JoinHandle<Vec<u8>> {
    let mut pipe = pipe.expect("a pipe");
    thread::spawn(move || {
        let mut bytes = Vec::new();
        pipe.read_to_end(&mut bytes).expect("a pipe is read");
        bytes
    })
}

fn text(bytes: JoinHandle<Vec<u8>>) -> String {
    String::from_utf8_lossy(&bytes.join().expect("it was read")).into_owned()
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

/// A file or folder of a test's own.
pub fn place(name: &str) -> PathBuf {
    let name = format!("{name}-{}", std::process::id());
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}
