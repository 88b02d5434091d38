//! `gdb-multiarch` itself debugs the tracker. Without it, the tests are shown as ignored.

#[path = "runs/tracker.rs"]
#[expect(dead_code, reason = "shared with the other tests of runs")]
mod tracker;

use std::process::{Command, ExitCode};
use std::thread;

use libtest_mimic::{Arguments, Failed, Trial};
use vrduino_emulator::gdb::Server;
use vrduino_emulator::time::{MILLISECOND, SECOND};

const GDB: &str = "gdb-multiarch";

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let missing = Command::new(GDB).arg("--version").output().is_err();
    let name = "gdb_steps_breaks_watches_and_sees_a_trap";
    let trial = if missing {
        // Asked for all the same (`--ignored`), it fails: a test that did not run has not passed.
        Trial::test(name, || Err(format!("{GDB} is not installed").into()))
            .with_kind(format!("{GDB} is not installed"))
            .with_ignored_flag(true)
    } else {
        Trial::test(name, debug)
    };
    libtest_mimic::run(&arguments, vec![trial]).exit_code()
}

fn debug() -> Result<(), Failed> {
    let mut server = Server::open(0)?;
    let address = server.address()?;
    let board = thread::spawn(move || {
        let mut board = tracker::board(tracker::setup());
        // A debugger that misses its breakpoint must not wait for ever.
        while server.holds() && board.now() < SECOND {
            server.run(&mut board, MILLISECOND);
        }
    });
    let target = format!("target remote {address}");
    let script = [
        "set language c",
        "set pagination off",
        "set confirm off",
        &target,
        "echo A:\\n",
        "info registers sp xpsr msp",
        // SRAM is not zero at power-on, until the start-up code makes it so.
        "watch *(unsigned int*)&vrduino_dropped_lines",
        "continue",
        "delete",
        "hbreak main",
        "continue",
        "echo B:\\n",
        "stepi",
        "stepi",
        "print/x *(unsigned char*)0x40064006",
        "set $r3 = 0x1234",
        "print/x $r3",
        "set {int}0x20007000 = 0x55aa",
        "x/xw 0x20007000",
        "delete",
        "set $pc = 0x40000000",
        "continue",
        "monitor why",
        "detach",
    ];
    let mut gdb = Command::new(GDB);
    gdb.args(["-nx", "-q", "-batch"]);
    for command in script {
        gdb.args(["-ex", command]);
    }
    let output = gdb.arg(tracker::path()).output()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned()
        + &String::from_utf8_lossy(&output.stderr);
    board.join().map_err(|_| "the board has panicked")?;
    for expected in [
        "0x20008000",
        "Breakpoint 2, ",
        "$1 = 0x10",
        "$2 = 0x1234",
        "0x000055aa",
        "atchpoint 1",
        "Old value",
        "SIGABRT",
        "stopped ",
        "rule    ",
    ] {
        if !text.contains(expected) {
            return Err(format!("gdb did not say {expected:?}, but:\n{text}").into());
        }
    }
    Ok(())
}
