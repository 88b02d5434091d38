//! The sketch that measures a real board, and the sheet that says what to expect of it.

use std::fs;
use std::path::Path;

use vrduino_emulator::cpu::Pace;
use vrduino_emulator::witness::Trap;

use crate::bench::Bench;

/// Rows of the sheet that hold a figure of the sketch: name and figure.
fn expected() -> Vec<(String, f64)> {
    let sheet = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/bring-up.md");
    let text = fs::read_to_string(sheet).expect("the sheet is there");
    text.lines()
        .filter_map(|line| {
            let mut cells = line.strip_prefix("| `")?.split('|');
            let name = cells.next()?.trim().trim_matches('`').to_owned();
            let figure = cells.next()?.split_whitespace().next()?.parse().ok()?;
            Some((name, figure))
        })
        .collect()
}

/// The figure of `soft-float` at the upper end of the cycle band, which its row names.
fn slowest_soft_float() -> f64 {
    let sheet = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/bring-up.md");
    let text = fs::read_to_string(sheet).expect("the sheet is there");
    let (_, rest) = text.split_once("the upper end is ").expect("an upper end");
    let figure = rest.split_whitespace().next().expect("a figure");
    figure.parse().expect("a number of cycles")
}

pub fn bring_up(bench: &mut Bench) {
    // Asking a sensor that is still in its reset is what the sketch does, to see how long it takes.
    let mut slow = bench.at_pace(Pace::Greatest, &[Trap::SensorNotReady]);
    slow.wait_for("done", 10.0);
    close(&mut slow, "soft-float", slowest_soft_float());
    let mut bench = bench.again(&[Trap::SensorNotReady]);
    bench.wait_for("done", 10.0);
    let rows = expected();
    assert!(rows.len() >= 15, "{rows:?}");
    for (name, figure) in rows {
        close(&mut bench, &name, figure);
    }
}

fn close(bench: &mut Bench, name: &str, figure: f64) {
    let measured = bench.number(&format!("{name} "), 0.0);
    assert!(
        (measured - figure).abs() <= 0.05 * figure.abs() + 0.01,
        "{name}: the sheet says {figure}, the board {measured}\n{}",
        bench.text
    );
}
