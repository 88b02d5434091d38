//! The board, and the guest that has it as a device.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::guest::Guest;

/// The guest takes a minute on a busy machine; a guest that hangs must not hang the tests.
const LIMIT: Duration = Duration::from_secs(600);

/// Boots the guest and returns what it wrote to its console.
pub fn console_of(guest: &Guest) -> Result<String, String> {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (file_system, console) = (
        directory.join("linux-initramfs.cpio"),
        directory.join("linux-console.txt"),
    );
    let said = |what: &Path| {
        let what = what.display().to_string();
        move |error: std::io::Error| format!("{what}: {error}")
    };
    fs::write(&file_system, guest.file_system()?).map_err(said(&file_system))?;
    let output = fs::File::create(&console).map_err(said(&console))?;
    let mut board = Board::start()?;
    let mut qemu = Command::new(&guest.qemu)
        // Without KVM, so that no rights are needed; without a disk or a display.
        .args(["-accel", "tcg", "-m", "256", "-nodefaults", "-no-reboot"])
        .args(["-display", "none", "-serial", "stdio"])
        .args(["-nic", "user,model=e1000"])
        .arg("-kernel")
        .arg(&guest.kernel)
        .arg("-initrd")
        .arg(&file_system)
        .args([
            "-append",
            &format!("console=ttyS0 quiet board={}", board.port),
        ])
        .stdin(Stdio::null())
        .stdout(output)
        .stderr(Stdio::inherit())
        .spawn()
        .map_err(said(&guest.qemu))?;
    let ended = wait(&mut qemu, &mut board.process);
    board.end(ended.is_ok())?;
    ended?;
    let text = fs::read(&console).map_err(said(&console))?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// Waits until the guest has switched itself off.
fn wait(qemu: &mut Child, board: &mut Child) -> Result<(), String> {
    let started = Instant::now();
    while qemu
        .try_wait()
        .map_err(|error| error.to_string())?
        .is_none()
    {
        let stopped = board.try_wait().is_ok_and(|status| status.is_some());
        if stopped || started.elapsed() > LIMIT {
            let _ = qemu.kill();
            let _ = qemu.wait();
            return Err(if stopped {
                "the emulator stopped while the guest had its device".into()
            } else {
                "the guest has not switched itself off".into()
            });
        }
        thread::sleep(Duration::from_millis(100));
    }
    Ok(())
}

/// `cargo emulate --usbip 0`.
struct Board {
    process: Child,
    port: u16,
    /// What it says after the port.
    rest: Option<thread::JoinHandle<String>>,
}

impl Board {
    fn start() -> Result<Board, String> {
        let mut process = Command::new(env!("CARGO_BIN_EXE_emulate"))
            .args(["--usbip", "0"])
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| format!("the emulator does not start: {error}"))?;
        let messages = process
            .stderr
            .take()
            .ok_or("the emulator has no messages")?;
        let mut messages = BufReader::new(messages);
        let mut said = String::new();
        let port = loop {
            let before = said.len();
            if !matches!(messages.read_line(&mut said), Ok(1..)) {
                let _ = process.wait();
                return Err(format!("the emulator offers no port:\n{said}"));
            }
            let port = said[before..]
                .strip_prefix("usb/ip  127.0.0.1:")
                .and_then(|rest| rest.split(',').next())
                .and_then(|port| port.parse().ok());
            if let Some(port) = port {
                break port;
            }
        };
        let rest = thread::spawn(move || {
            let _ = messages.read_to_string(&mut said);
            said
        });
        Ok(Board {
            process,
            port,
            rest: Some(rest),
        })
    }

    /// Ends it; a board that has ended by itself stepped into a trap.
    fn end(&mut self, well: bool) -> Result<(), String> {
        let trapped = matches!(self.process.try_wait(), Ok(Some(_)));
        let _ = self.process.kill();
        let _ = self.process.wait();
        let said = self.rest.take().and_then(|rest| rest.join().ok());
        if trapped || !well {
            return Err(format!("the emulator said:\n{}", said.unwrap_or_default()));
        }
        Ok(())
    }
}
