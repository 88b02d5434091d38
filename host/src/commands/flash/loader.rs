//! PJRC's `teensy_loader_cli`: run, listened to, and explained.

use std::ffi::OsString;
use std::io::{self, Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread;
use std::time::{Duration, Instant};

use crate::computer::halfkay;
use crate::failure::{Failure, Kind};
use crate::interrupt::Interrupt;

/// Its name.
pub const LOADER: &str = "teensy_loader_cli";

/// What to do without it.
pub const WHERE_TO_GET_IT: &str = "\
Debian and Ubuntu have it: sudo apt install teensy-loader-cli; for other systems see https://www.pjrc.com/teensy/loader_cli.html\n\
PJRC's graphical loader (https://www.pjrc.com/teensy/loader.html) writes the same file: `cargo image` makes target/vrduino.hex, press the button on the board";

/// What it says when it has the board.
const FOUND: &str = "Found HalfKay";
/// And when it is done.
const DONE: &str = "Booting";

/// After so long without the board a hint is due.
const HINT: Duration = Duration::from_secs(8);
/// So long somebody may look for the button.
const PATIENCE: Duration = Duration::from_secs(120);
/// So long the rest may take once the board is found: all of the flash takes some ten seconds.
const WRITING: Duration = Duration::from_secs(60);

/// Between two looks at whether to go on.
const NAP: Duration = Duration::from_millis(100);

/// What it is called with.
pub fn arguments(hex: &Path) -> [OsString; 4] {
    [
        "--mcu=TEENSY32".into(),
        "-w".into(),
        "-v".into(),
        hex.into(),
    ]
}

/// Writes the image; what the loader says is passed on.
///
/// # Errors
///
/// It does not start, finds no board, or fails.
pub fn write(loader: &Path, hex: &Path, interrupt: &Interrupt) -> Result<(), Failure> {
    run(
        Command::new(loader).args(arguments(hex)),
        interrupt,
        WRITING,
    )
}

/// Runs the loader, which may write for so long.
fn run(loader: &mut Command, interrupt: &Interrupt, writing: Duration) -> Result<(), Failure> {
    let mut child = loader
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| {
            let program = Path::new(loader.get_program()).display();
            let sentence = format!("{program} does not start: {error}");
            Failure::new(Kind::Computer, sentence)
        })?;
    let heard = listen(&mut child, interrupt, writing);
    let status = match &heard {
        Ok(_) => child.wait(),
        Err(_) => {
            // Both fail only where it has ended by itself.
            let _ = child.kill();
            child.wait()
        }
    };
    let said = heard?;
    match status {
        Ok(status) if status.success() && said.contains(DONE) => Ok(()),
        Ok(status) if status.success() => {
            Err(failed(&said, "it has not said that the board starts"))
        }
        Ok(status) => Err(failed(&said, &format!("it ended with {status}"))),
        Err(error) => Err(failed(&said, &error.to_string())),
    }
}

/// Passes on what it says until it ends: all of that.
fn listen(child: &mut Child, interrupt: &Interrupt, writing: Duration) -> Result<String, Failure> {
    let (said, chunks) = mpsc::channel();
    if let Some(output) = child.stdout.take() {
        pass_on(output, io::stdout(), said.clone());
    }
    if let Some(errors) = child.stderr.take() {
        pass_on(errors, io::stderr(), said.clone());
    }
    drop(said);
    let began = Instant::now();
    let mut all = String::new();
    let mut hinted = false;
    let mut found = None;
    loop {
        match chunks.recv_timeout(NAP) {
            Ok(chunk) => all += &chunk,
            Err(RecvTimeoutError::Timeout) => {}
            // Silence is not the end yet.
            Err(RecvTimeoutError::Disconnected) => match child.try_wait() {
                Ok(None) => thread::sleep(NAP),
                Ok(Some(_)) | Err(_) => return Ok(all),
            },
        }
        if interrupt.has_come() {
            return Err(Failure::new(
                Kind::Board,
                "stopped: if the loader had begun, the board has no program now; run this again",
            ));
        }
        if all.contains(FOUND) {
            if found.get_or_insert_with(Instant::now).elapsed() > writing {
                return Err(Failure::new(
                    Kind::Board,
                    format!(
                        "{LOADER} has found the board and comes to no end: unplug the board, plug it in again, press the button on it and run this again"
                    ),
                ));
            }
            continue;
        }
        if began.elapsed() > HINT && !hinted {
            hinted = true;
            // Where nobody can read it, it need not be said.
            let _ = writeln!(io::stderr(), "{}", hint());
        }
        if began.elapsed() > PATIENCE {
            return Err(Failure::new(
                Kind::Board,
                format!("no board came into its loader: {}", hint()),
            ));
        }
    }
}

fn hint() -> &'static str {
    if halfkay::waiting() > 0 {
        // It is there for everybody to see, and the loader does not see it.
        "a Teensy is in its loader, but may not be opened by you: `vrduino doctor` prints the udev rule"
    } else {
        "press the button on the board; if nothing happens then, take a cable that carries data too"
    }
}

/// A thread that ends with its pipe.
fn pass_on(
    mut from: impl Read + Send + 'static,
    mut to: impl Write + Send + 'static,
    said: Sender<String>,
) {
    thread::spawn(move || {
        let mut buffer = [0; 1024];
        // Dots come one by one, without an end of line.
        while let Ok(count @ 1..) = from.read(&mut buffer) {
            let _ = to.write_all(&buffer[..count]).and_then(|()| to.flush());
            let chunk = String::from_utf8_lossy(&buffer[..count]).into_owned();
            if said.send(chunk).is_err() {
                break;
            }
        }
    });
}

/// What its last words mean.
fn failed(said: &str, how: &str) -> Failure {
    let advice = if said.contains("error writing") {
        "the board was unplugged, or its cable is bad, while it was written: press the button on it and run this again"
    } else if said.contains("nable to open") {
        "the board's loader may not be opened by you: `vrduino doctor` prints the udev rule"
    } else if said.contains("nknown MCU") {
        "this loader does not know the Teensy 3.2: get a newer one"
    } else if said.contains("intel hex") {
        "the loader does not read the file: is it on a disk that the loader can see?"
    } else {
        "press the button on the board and run this again"
    };
    Failure::new(
        Kind::Board,
        format!("{LOADER} has failed ({how}): {advice}"),
    )
}

#[cfg(test)]
mod tests {
    use super::failed;

    #[cfg(unix)]
    #[test]
    fn a_loader_that_hangs_is_ended() {
        use super::run;
        use crate::interrupt::Interrupt;
        use std::process::Command;
        use std::time::Duration;

        // Silently, and with its mouth shut.
        for how in ["", ">&- 2>&-"] {
            let script = format!("echo 'Found HalfKay Bootloader'; exec sleep 600 {how}");
            let mut loader = Command::new("sh");
            let failure = run(
                loader.args(["-c", &script]),
                &Interrupt::default(),
                Duration::from_millis(300),
            )
            .unwrap_err();
            assert!(failure.sentence.contains("comes to no end"), "{failure}");
        }
    }

    #[test]
    fn last_words_are_explained() {
        for (said, word) in [
            ("Programming....error writing to Teensy\n", "cable"),
            ("Unable to open device\n", "udev"),
            ("Unknown MCU type \"TEENSY32\"\n", "newer"),
            ("error reading intel hex file \"x\"\n", "read the file"),
            ("", "button"),
        ] {
            let sentence = failed(said, "it ended").sentence;
            assert!(sentence.contains(word), "{said:?} {sentence}");
        }
    }
}
