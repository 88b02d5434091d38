//! A pseudo-terminal as the system gives it: one for a person.

use std::fs::File;
use std::os::fd::OwnedFd;

use rustix::fs::{Mode, OFlags, open};
use rustix::io::{FdFlags, fcntl_setfd};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

/// Both ends.
pub struct Terminal {
    /// What a person types on and looks at.
    pub person: File,
    /// What a program reads from and writes to.
    pub program: OwnedFd,
}

impl Terminal {
    /// A new one. A program that is started meanwhile does not hold it open.
    pub fn open() -> Self {
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY;
        #[cfg(target_os = "linux")]
        let flags = flags | OpenptFlags::CLOEXEC;
        let person = openpt(flags).expect("a pseudo-terminal");
        fcntl_setfd(&person, FdFlags::CLOEXEC).expect("not inherited");
        grantpt(&person).expect("granted");
        unlockpt(&person).expect("unlocked");
        let path = ptsname(&person, Vec::new()).expect("a name");
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let program = open(path, flags, Mode::empty()).expect("opens");
        Self {
            person: person.into(),
            program,
        }
    }
}
