//! `cargo emulate` itself: ports, recordings, and how it ends.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use crate::tracker;

fn emulate(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_emulate"));
    command
        .arg("--image")
        .arg(tracker::path())
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

fn run(arguments: &[&str]) -> Output {
    emulate(arguments).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The line of the report that begins with `name`.
fn line(output: &Output, name: &str) -> String {
    let said = said(output);
    let found = said.lines().find(|line| line.starts_with(name));
    found.unwrap_or_else(|| panic!("no {name}:\n{said}")).into()
}

fn file(name: &str) -> PathBuf {
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    fs::create_dir_all(&directory).unwrap();
    directory.join(format!("{}-{name}", std::process::id()))
}

#[test]
fn a_recorded_run_is_replayed_byte_for_byte() {
    let path = file("replayed.run");
    let path = path.to_str().unwrap();
    let options = ["--who-am-i", "0x73", "--pessimistic"];
    let inputs = [
        "--seconds",
        "1.7",
        "--type",
        "2@1.3",
        "--fault",
        "stuck-sda@1.4-1.5",
    ];
    let record = ["--record", path];
    let recorded = run(&[&options[..], &inputs, &record].concat());
    assert!(recorded.status.success(), "{}", said(&recorded));
    let text = fs::read_to_string(path).unwrap();
    assert!(
        text.contains(" typed 2\n") && text.contains(" fault stuck-sda on\n"),
        "{text}"
    );
    let replay = ["--replay", path];
    let replayed = run(&[&options[..], &replay].concat());
    assert!(replayed.status.success(), "{}", said(&replayed));
    assert_eq!(replayed.stdout, recorded.stdout);
    assert_eq!(line(&replayed, "hash "), line(&recorded, "hash "));
    assert!(line(&replayed, "replay ").contains("the same"));

    let refused = |arguments: &[&str], reason: &str| {
        let output = run(arguments);
        assert_eq!(output.status.code(), Some(1));
        assert!(said(&output).contains(reason), "{}", said(&output));
        assert!(output.stdout.is_empty());
    };
    refused(&replay, "other options for the sensor");
    let elsewhere = [&replay[..], &options, &["--start", "1"]].concat();
    refused(&elsewhere, "another motion");
    fs::write(path, text.replacen("image ", "image 1", 1)).unwrap();
    refused(&[&replay[..], &options].concat(), "is not a hash");
    let image = text.lines().nth(1).unwrap();
    fs::write(path, text.replace(image, "image 0000000000000001")).unwrap();
    refused(&[&replay[..], &options].concat(), "another image");
    fs::write(path, text.lines().take(5).collect::<Vec<_>>().join("\n")).unwrap();
    refused(&[&replay[..], &options].concat(), "cut short");
    fs::write(path, text.replace("fault stuck-sda on", "fault absent on")).unwrap();
    let other = run(&[&replay[..], &options].concat());
    assert!(
        said(&other).contains("went another way"),
        "{}",
        said(&other)
    );
    fs::remove_file(path).unwrap();
}

/// The address that is printed behind `name`.
fn address(child: &mut Child, name: &str) -> (String, BufReader<std::process::ChildStderr>) {
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    loop {
        line.clear();
        assert!(stderr.read_line(&mut line).unwrap() > 0, "no {name}");
        if line.starts_with(name) {
            let address = line.split_whitespace().last().unwrap();
            return (address.to_owned(), stderr);
        }
    }
}

#[test]
fn the_stream_is_served_on_a_tcp_port_to_one_client_after_the_other() {
    let mut child = emulate(&["--tcp", "0", "--seconds", "600"])
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let (address, stderr) = address(&mut child, "tcp");
    for key in [b"2", b"3"] {
        let mut client = TcpStream::connect(&address).unwrap();
        client
            .set_read_timeout(Some(Duration::from_secs(60)))
            .unwrap();
        let mut lines = BufReader::new(client.try_clone().unwrap()).lines();
        let is_orientation = |line: &String| line.starts_with("QC ");
        assert!(
            lines
                .by_ref()
                .map(Result::unwrap)
                .any(|line| is_orientation(&line))
        );
        // The firmware answers a key, so both directions work.
        client.write_all(key).unwrap();
        assert!(lines.map(Result::unwrap).any(|line| !is_orientation(&line)));
    }
    let mut last = TcpStream::connect(&address).unwrap();
    last.set_read_timeout(Some(Duration::from_secs(60)))
        .unwrap();
    let mut start = [0; 100];
    last.read_exact(&mut start).unwrap();
    terminate(&child);
    // The rest of the stream, and then its end.
    let mut rest = Vec::new();
    last.read_to_end(&mut rest).unwrap();
    assert!(child.wait().unwrap().success());
    let report: Vec<String> = stderr.lines().map(Result::unwrap).collect();
    assert!(
        report.iter().any(|line| line.starts_with("hash ")),
        "{report:?}"
    );
}

fn terminate(child: &Child) {
    let killed = Command::new("kill")
        .arg("-TERM")
        .arg(child.id().to_string())
        .status();
    assert!(killed.unwrap().success());
}

#[test]
fn a_port_that_is_taken_is_refused_with_a_way_out() {
    let taken = std::net::TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    for option in ["--tcp", "--gdb"] {
        let output = run(&[option, &port, "--seconds", "0.1"]);
        assert_eq!(output.status.code(), Some(1));
        assert!(
            said(&output).contains("0 for any free one"),
            "{}",
            said(&output)
        );
    }
}

#[test]
fn standard_error_that_nobody_reads_is_no_reason_to_fail() {
    let mut child = emulate(&["--seconds", "0.2", "--trace", "i2c"])
        .spawn()
        .unwrap();
    drop(child.stderr.take());
    let mut stdout = Vec::new();
    child
        .stdout
        .take()
        .unwrap()
        .read_to_end(&mut stdout)
        .unwrap();
    let status = child.wait().unwrap();
    assert_ne!(status.code(), Some(101));
    let quiet = emulate(&["--seconds", "0.2"]);
    let mut quiet = { quiet }.spawn().unwrap();
    drop(quiet.stderr.take());
    assert!(quiet.wait().unwrap().success());
}

#[test]
fn options_that_do_not_go_together_are_refused() {
    for arguments in [
        &["--trace-from", "1"][..],
        &["--trace", "everything"],
        &["--record", "a", "--replay", "b"],
        &["--gdb", "0", "--record", "a"],
        &["--replay", "b", "--type", "2@1"],
        &["--gdb", "70000"],
    ] {
        assert_eq!(run(arguments).status.code(), Some(2), "{arguments:?}");
    }
    for arguments in [
        &["--trace", "all", "--trace-file", "/no/such/place"][..],
        &["--vcd", "/no/such/place"],
        &["--record", "/no/such/place"],
        &["--replay", "/no/such/place"],
    ] {
        let output = run(&[arguments, &["--seconds", "0.1"]].concat()[..]);
        assert!(
            matches!(output.status.code(), Some(1 | 2)),
            "{arguments:?}: {}",
            said(&output)
        );
    }
}

#[test]
fn the_eeprom_goes_from_one_run_to_the_next_in_a_file() {
    let path = file("eeprom.bin");
    let _ = fs::remove_file(&path);
    let options = ["--seconds", "0.2", "--eeprom", path.to_str().unwrap()];
    let first = run(&options);
    assert!(first.status.success(), "{}", said(&first));
    // The tracker has made it, and kept nothing yet.
    assert_eq!(fs::read(&path).unwrap(), [0xFF; 2048]);
    let mut sketch = vec![0xFF; 2048];
    sketch[..4].copy_from_slice(b"mine");
    fs::write(&path, &sketch).unwrap();
    let second = run(&options);
    assert!(second.status.success(), "{}", said(&second));
    assert_eq!(fs::read(&path).unwrap(), sketch);
    // A board in another state is another run.
    assert_ne!(line(&first, "hash"), line(&second, "hash"));
    fs::remove_file(&path).unwrap();
}

#[test]
fn a_file_that_is_no_eeprom_is_refused() {
    let path = file("no-eeprom.bin");
    fs::write(&path, [0; 100]).unwrap();
    let refused = run(&["--seconds", "0.1", "--eeprom", path.to_str().unwrap()]);
    assert_eq!(refused.status.code(), Some(1));
    let said = said(&refused);
    assert!(
        said.contains("100 bytes are no EEPROM's contents: it has 2048"),
        "{said}"
    );
    fs::remove_file(&path).unwrap();
}
