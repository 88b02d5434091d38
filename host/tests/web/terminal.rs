//! `vrduino serve` at a terminal: keys work without Enter, and the terminal is left as it was.

use std::io::Write;
use std::os::fd::AsFd;

use rustix::termios::{LocalModes, tcgetattr};

use crate::client::serve;
use crate::program::command;
use crate::pty::Terminal;
use crate::server::Server;

fn modes(terminal: impl AsFd) -> LocalModes {
    tcgetattr(terminal).expect("a terminal").local_modes
}

#[test]
fn keys_work_at_once_and_the_terminal_is_left_as_it_was() {
    let Terminal {
        mut person,
        program: stdin,
    } = Terminal::open();
    let before = modes(&stdin);
    assert!(before.contains(LocalModes::ICANON | LocalModes::ECHO));
    let own = stdin.try_clone().expect("another");
    let program = Server::spawn(
        command()
            .args(["serve", "--emulate", "--ws-port", "0"])
            .stdin(own),
    );
    let mut page = serve(program.port);
    program.until("QC ", |line| line.contains("QC "));
    assert!(
        !modes(&stdin).contains(LocalModes::ICANON),
        "keys come at once"
    );
    person.write_all(b"d").expect("typed");
    program.complains("not printing any more");
    person.write_all(b"0").expect("typed");
    page.find("what key 0 shows", |message| {
        message
            .to_text()
            .ok()?
            .starts_with("nReads/sec")
            .then_some(())
    });
    // Within a line a d is a letter.
    person.write_all(b":damping\r").expect("typed");
    page.find("an answer", |message| {
        message
            .to_text()
            .ok()?
            .starts_with("ERR damping")
            .then_some(())
    });
    person.write_all(b"d").expect("typed");
    program.complains("printing what the board sends");
    program.until("nReads/sec", |line| line.contains("nReads/sec"));
    // Ctrl-C is a key like any other here.
    person.write_all(b"\x03").expect("typed");
    assert!(page.ends_with_good_bye());
    program.end().expect(0);
    assert_eq!(modes(&stdin), before);
}
