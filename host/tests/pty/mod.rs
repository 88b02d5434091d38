//! A serial port without a cable: a pseudo-terminal, with whatever at its other end.

// Every test file compiles a copy of this and calls what it needs of it: the rest is unused there, not everywhere.
#![allow(dead_code, reason = "not every test asks for everything")]

mod terminal;

use std::fs::{self, File};
use std::io::{Read, Write};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use rustix::fs::{OFlags, fcntl_setfl};
use rustix::pty::ptsname;
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use terminal::Terminal;
use vrduino_emulator::board::{Board, Setup};
use vrduino_emulator::firmware::{self, BuildOptions};
use vrduino_emulator::image::Image;
use vrduino_emulator::motion;
use vrduino_emulator::time::MILLISECOND;

/// Both ends.
pub struct Pty {
    /// What a device would hold.
    pub device: File,
    /// What a program opens.
    pub path: String,
}

impl Pty {
    /// A new one, raw, whose device's end does not block.
    pub fn open() -> Self {
        let Terminal {
            person: device,
            program,
        } = Terminal::open();
        let path = ptsname(&device, Vec::new())
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        let mut settings = tcgetattr(&program).expect("settings");
        settings.make_raw();
        tcsetattr(&program, OptionalActions::Now, &settings).expect("raw");
        fcntl_setfl(&device, OFlags::NONBLOCK).expect("does not block");
        Self { device, path }
    }
}

/// The emulated board at the other end, running as fast as it can; it is pulled out when this is dropped.
pub struct PluggedIn {
    pub path: String,
    wanted: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl PluggedIn {
    /// With the head's motion; what `noise` gives comes before every millisecond of the board's bytes.
    pub fn new(noise: impl FnMut() -> Vec<u8> + Send + 'static) -> Self {
        Self::with(
            |image| Board::new(image, Setup::new(motion::built_in())),
            noise,
        )
    }

    /// This board.
    pub fn with(
        board: impl FnOnce(Image) -> Board + Send + 'static,
        mut noise: impl FnMut() -> Vec<u8> + Send + 'static,
    ) -> Self {
        let image = firmware::build(BuildOptions { quiet: true }).expect("the firmware builds");
        let image = Image::open(&image).expect("an image");
        let Pty { mut device, path } = Pty::open();
        let wanted = Arc::new(AtomicBool::new(true));
        let flag = Arc::clone(&wanted);
        let thread = thread::spawn(move || {
            let mut board = board(image);
            while flag.load(Ordering::Relaxed) {
                board.run(MILLISECOND);
                let mut typed = [0; 256];
                if let Ok(count) = device.read(&mut typed) {
                    board.chip().host.send(&typed[..count]);
                }
                let mut bytes = noise();
                bytes.extend(board.chip_quietly().host.take_received());
                write(&mut device, &bytes, &flag);
            }
        });
        Self {
            path,
            wanted,
            thread: Some(thread),
        }
    }
}

/// A name under which boards are plugged in and pulled out. That of a pseudo-terminal goes to whoever opens the next one.
pub struct Port(PathBuf);

impl Port {
    /// With nothing in it.
    pub fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let (program, count) = (std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
        Self(folder.join(format!("port-{program}-{count}")))
    }

    pub fn path(&self) -> &str {
        self.0.to_str().expect("plain letters")
    }

    /// A board is plugged in.
    pub fn plug(&self, board: &PluggedIn) {
        symlink(&board.path, &self.0).expect("a link");
    }

    /// And is pulled out again.
    pub fn pull(&self, board: PluggedIn) {
        fs::remove_file(&self.0).expect("a link");
        drop(board);
    }
}

impl Drop for Port {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

/// Waits for a reader who is slow; what nobody reads is lost, as on a cable.
pub fn write(device: &mut File, mut bytes: &[u8], wanted: &AtomicBool) {
    while !bytes.is_empty() && wanted.load(Ordering::Relaxed) {
        match device.write(bytes) {
            Ok(count) => bytes = &bytes[count..],
            Err(error) if error.kind() == std::io::ErrorKind::WouldBlock => {
                thread::sleep(Duration::from_millis(1))
            }
            Err(_) => return,
        }
    }
}

impl Drop for PluggedIn {
    fn drop(&mut self) {
        self.wanted.store(false, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
