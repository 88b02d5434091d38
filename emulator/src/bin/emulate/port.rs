//! The serial port for other programs: a pseudo-terminal that behaves like the board's port.

#[cfg(unix)]
pub use unix::PseudoTerminal;

#[cfg(not(unix))]
pub use absent::PseudoTerminal;

#[cfg(unix)]
mod unix {
    use std::collections::VecDeque;
    use std::io;
    use std::os::fd::OwnedFd;

    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    use rustix::fs::{Mode, OFlags, fcntl_setfl, open};
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

    /// Bytes that may wait for a reader before the host stops reading the board.
    const WAITING: usize = 4096;

    /// The pseudo-terminal's master side.
    pub struct PseudoTerminal {
        master: OwnedFd,
        path: String,
        waiting: VecDeque<u8>,
        attached: bool,
    }

    impl PseudoTerminal {
        /// Opens a new one, in raw mode.
        pub fn open() -> io::Result<PseudoTerminal> {
            let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
            grantpt(&master)?;
            unlockpt(&master)?;
            let path = ptsname(&master, Vec::new())?.to_string_lossy().into_owned();
            // Settings belong to the other side; once it is closed again, nobody counts as attached.
            let slave = open(path.as_str(), OFlags::RDWR | OFlags::NOCTTY, Mode::empty())?;
            let mut settings = tcgetattr(&slave)?;
            settings.make_raw();
            tcsetattr(&slave, OptionalActions::Now, &settings)?;
            drop(slave);
            fcntl_setfl(&master, OFlags::NONBLOCK)?;
            Ok(PseudoTerminal {
                master,
                path,
                waiting: VecDeque::new(),
                attached: false,
            })
        }

        /// What other programs open.
        pub fn path(&self) -> Option<&str> {
            Some(&self.path)
        }

        /// Whether another program has it open.
        pub fn is_attached(&mut self) -> bool {
            let mut descriptors = [PollFd::new(&self.master, PollFlags::IN)];
            let now = Timespec {
                tv_sec: 0,
                tv_nsec: 0,
            };
            let polled = poll(&mut descriptors, Some(&now));
            let attached = polled.is_ok() && !descriptors[0].revents().contains(PollFlags::HUP);
            if !attached {
                self.waiting.clear();
            }
            self.attached = attached;
            attached
        }

        /// Whether the reader has fallen behind.
        pub fn is_full(&self) -> bool {
            self.waiting.len() >= WAITING
        }

        /// Takes what was typed.
        pub fn read(&mut self) -> Vec<u8> {
            let mut buffer = [0; 256];
            match rustix::io::read(&self.master, &mut buffer) {
                Ok(count) => buffer[..count].to_vec(),
                // Nothing typed, or nobody there.
                Err(_) => Vec::new(),
            }
        }

        /// Queues part of the stream, for whoever was attached when last asked.
        pub fn write(&mut self, bytes: &[u8]) {
            if self.attached {
                self.waiting.extend(bytes);
            }
        }

        /// Hands over as much as the reader takes.
        pub fn flush(&mut self) {
            while !self.waiting.is_empty() {
                let (front, _) = self.waiting.as_slices();
                match rustix::io::write(&self.master, front) {
                    Ok(count) if count > 0 => drop(self.waiting.drain(..count)),
                    _ => return,
                }
            }
        }
    }
}

#[cfg(not(unix))]
mod absent {
    use std::io;

    /// Systems without pseudo-terminals have the stream on standard output only.
    pub struct PseudoTerminal;

    impl PseudoTerminal {
        /// Does nothing.
        pub fn open() -> io::Result<PseudoTerminal> {
            Ok(PseudoTerminal)
        }

        /// There is none.
        pub fn path(&self) -> Option<&str> {
            None
        }

        /// Never.
        pub fn is_attached(&mut self) -> bool {
            false
        }

        /// Never.
        pub fn is_full(&self) -> bool {
            false
        }

        /// Nothing.
        pub fn read(&mut self) -> Vec<u8> {
            Vec::new()
        }

        /// Nowhere.
        pub fn write(&mut self, _bytes: &[u8]) {}

        /// Nothing to do.
        pub fn flush(&mut self) {}
    }
}
