//! Opens the page in the user's browser.

use std::io::{self, Write};
use std::process::{Command, Stdio};
use std::thread;

/// Opens it, or says that the user has to.
pub fn open(url: &str) {
    let mut command = opener(url);
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    let url = url.to_owned();
    // Some of them stay for as long as the browser does.
    thread::spawn(move || {
        let opened = command.status().is_ok_and(|status| status.success());
        if !opened {
            let _ = writeln!(
                io::stderr(),
                "no browser could be opened: open {url} yourself"
            );
        }
    });
}

fn opener(url: &str) -> Command {
    let (program, arguments): (_, &[&str]) = if cfg!(windows) {
        // The empty word is the title of a window, for which the address would be taken.
        ("cmd", &["/C", "start", ""])
    } else if cfg!(target_os = "macos") {
        ("open", &[])
    } else {
        ("xdg-open", &[])
    };
    let mut command = Command::new(program);
    command.args(arguments).arg(url);
    command
}
