//! Promise: who asks which ports there are is told, and what to do where there is none.

mod program;

#[cfg(unix)]
mod pty;

use program::vrduino;

/// Whether a board is plugged in or not, for nobody knows where this is run.
#[test]
fn boards_are_listed_or_it_is_said_what_to_do() {
    let listed = vrduino(&["list"]);
    match listed.code {
        Some(0) => assert!(
            !listed.out.is_empty() && listed.err.is_empty(),
            "{listed:?}"
        ),
        _ => {
            listed
                .expect(3)
                .said("no board is plugged in")
                .said("--emulate");
        }
    }
}

#[test]
fn programs_get_json() {
    let all = vrduino(&["list", "--all", "--json"]);
    let rows: serde_json::Value = serde_json::from_str(&all.out).expect("JSON");
    let rows = rows.as_array().expect("a list");
    all.expect(if rows.is_empty() { 3 } else { 0 });
    for row in rows {
        let what = row["what"].as_str().expect("a word");
        assert!(["board", "loader", "usb", "plain"].contains(&what), "{row}");
        assert_eq!(row["name"].is_null(), what == "loader", "{row}");
    }
}

#[cfg(unix)]
#[test]
fn a_port_that_is_in_use_is_told_from_one_that_is_not_there() {
    use std::thread::sleep;
    use std::time::{Duration, Instant};
    use vrduino_host::source::port::{Cause, open_at, try_port};

    let pty::Pty { device, path } = pty::Pty::open();
    let held = open_at(&path, 115_200).expect("opens");
    let (cause, failure) = try_port(&path).expect_err("held");
    assert_eq!(cause, Cause::InUse, "{failure}");
    drop(held);
    // A program that another test begins at this moment holds it as well, until it has become that program.
    let began = Instant::now();
    while let Err((cause, failure)) = try_port(&path) {
        assert_eq!(cause, Cause::InUse, "{failure}");
        assert!(began.elapsed() < Duration::from_secs(20), "free: {failure}");
        sleep(Duration::from_millis(10));
    }
    drop(device);
    let (cause, failure) = try_port("/dev/there-is-none").expect_err("none");
    assert_eq!(cause, Cause::Absent, "{failure}");
}
