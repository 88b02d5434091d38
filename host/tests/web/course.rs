//! The course's programs find on `vrduino serve` what they find on the course's server.

use crate::client::{Stream, a_while, serve};
use crate::server::Server;

/// As the `visualizer` page reads: words between single spaces, `parseFloat` of each.
fn visualizer(line: &str) -> Option<[f64; 4]> {
    let words: Vec<_> = line.split(' ').collect();
    let number = |i: usize| words.get(i).and_then(|word| word.parse().ok());
    (words[0] == "QC").then_some(())?;
    Some([number(1)?, number(2)?, number(3)?, number(4)?])
}

/// As the render page reads: quotes taken out, `Number` of each word, and no word too many.
fn render(line: &str) -> Option<[f64; 4]> {
    let line = line.replace('"', "");
    let words: Vec<_> = line.split(' ').collect();
    (words.len() == 5).then(|| visualizer(&line))?
}

/// As `ReadUSB.cs` reads: the last line but one of 64 bytes.
fn unity(window: &[u8]) -> Option<[f64; 4]> {
    let window = std::str::from_utf8(window).ok()?;
    let lines: Vec<_> = window.split('\n').collect();
    visualizer(lines.get(lines.len().checked_sub(2)?)?)
}

/// Orientations, once they have begun to come.
fn orientations(stream: &mut Stream, count: usize) -> Vec<String> {
    let first = stream.find("an orientation", |message| {
        let line = message.to_text().ok()?;
        line.starts_with("QC ").then(|| line.to_owned())
    });
    let mut found = vec![first];
    while found.len() < count {
        let lines = stream.lines(1);
        found.extend(lines.into_iter().filter(|line| line.starts_with("QC ")));
    }
    found
}

#[test]
fn every_program_of_the_course_reads_the_lines() {
    let program = Server::serve(&["--emulate"]);
    let lines = orientations(&mut serve(program.port), 300);
    for line in &lines {
        let q = visualizer(line).expect("numbers");
        assert_eq!(render(line), Some(q), "{line}");
        let length = q.iter().map(|part| part * part).sum::<f64>().sqrt();
        assert!((length - 1.0).abs() < 2e-3, "{line}: {length}");
        assert!(!line.contains(['\n', '\r', '\0']), "{line:?}");
    }
    let moved = lines.iter().any(|line| *line != lines[0]);
    assert!(moved, "the head turns: {}", lines[0]);
    let port = lines.join("\n") + "\n";
    for window in port.as_bytes().windows(64) {
        let text = String::from_utf8_lossy(window);
        assert!(unity(window).is_some(), "nothing in {text:?}");
    }
}

#[test]
fn several_pages_get_the_same_and_what_they_send_is_not_read() {
    let program = Server::serve(&["--emulate", "--motion", "turns"]);
    let mut pages = [serve(program.port), serve(program.port)];
    for page in &mut pages {
        page.find("the stream", |message| {
            message.to_text().ok()?.starts_with("QC ").then_some(())
        });
        // Keys and a command that would end this stream.
        page.say("0");
        page.say(":stream binary");
    }
    // From a line on that both have: the last one said before the sensor first turns.
    let turns = |line: &String| line.starts_with("QC ") && *line != "QC 1.000 0.000 0.000 0.000";
    let [first, second] = pages.each_mut().map(|page| {
        let mut lines = Vec::new();
        while lines.len() < 200 {
            lines.extend(page.lines(1));
            if !turns(&lines[0]) {
                lines.clear();
            }
        }
        lines
    });
    assert_eq!(first, second);
    assert!(first.iter().all(|line| line.starts_with("QC ")));
    // One that leaves takes nobody with it.
    let [left, mut other] = pages;
    left.hang_up();
    a_while();
    assert!(orientations(&mut other, 100).len() >= 100);
}

#[test]
fn what_is_typed_reaches_the_board() {
    let mut program = Server::serve(&["--emulate", "--quiet"]);
    // At once: it waits until the board is there.
    program.type_in("0");
    let mut page = serve(program.port);
    let says = |page: &mut Stream, wanted: &str| {
        page.find(wanted, |message| {
            message.to_text().ok()?.starts_with(wanted).then_some(())
        })
    };
    says(&mut page, "nReads/sec: ");
    program.type_in("5");
    says(&mut page, "QC ");
    program.type_in(":deci");
    a_while();
    program.type_in("mals 5\n");
    says(&mut page, "OK decimals 5");
    let long = page.find("five decimals", |message| {
        let line = message.to_text().ok()?;
        line.starts_with("QC ").then(|| line.to_owned())
    });
    assert_eq!(
        long.split(['.', ' ']).nth(2).map(str::len),
        Some(5),
        "{long}"
    );
}

/// Frames are lines for them all the same, and no more than they keep up with.
#[test]
fn a_binary_stream_is_made_lines_of() {
    let mut program = Server::serve(&["--emulate", "--quiet"]);
    let mut page = serve(program.port);
    orientations(&mut page, 1);
    program.type_in(":stream binary\n:decimals 5\n");
    page.find("frames", |message| {
        let line = message.to_text().ok()?;
        (line == "OK decimals 5").then_some(())
    });
    for line in page.lines(400) {
        assert!(render(&line).is_some(), "{line:?}");
        assert!(line.len() <= 30, "three decimals: {line}");
    }
}

#[cfg(unix)]
#[test]
fn it_ends_with_a_good_bye() {
    let program = Server::serve(&["--emulate"]);
    let mut page = serve(program.port);
    program.until("QC ", |line| line.contains("QC "));
    program.interrupt();
    assert!(page.ends_with_good_bye());
    program.end().expect(0);
}
