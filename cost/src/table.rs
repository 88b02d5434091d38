//! The figures, for people and for programs.

use std::io::{self, Write};

use vrduino_emulator::board::figures::Figures;
use vrduino_emulator::image::{FLASH_SIZE, RAM_SIZE};

use crate::count::Count;
use crate::firmware::{MEASURED_S, Mode};
use crate::json::Value;
use crate::published::{PUBLISHED, Published};
use crate::subject::Subject;

/// A filter that was counted.
#[derive(Debug, Clone)]
pub struct Row {
    /// Which.
    pub subject: Subject,
    /// What it costs.
    pub count: Count,
    /// The largest angle to its reference in degrees, if it has one.
    pub error: Option<f64>,
}

/// Prints what an update costs; `yardstick` is the number of instructions that ratios are to.
///
/// # Errors
///
/// As of the writer.
pub fn filters(out: &mut impl Write, rows: &[Row], yardstick: f64) -> io::Result<()> {
    writeln!(
        out,
        "{:<52} {:>12} {:>8} {:>7} {:>15} {:>13} {:>8}",
        "one update", "instructions", "most", "ratio", "cycles", "us at 72 MHz", "error"
    )?;
    for Row {
        subject,
        count,
        error,
    } in rows
    {
        let [least, greatest] = count.mean_cycles();
        let [quick, slow] = count.mean_us();
        writeln!(
            out,
            "{:<52} {:>12.1} {:>8} {:>7.1} {:>15} {:>13} {:>8}",
            subject.label,
            count.mean(),
            count.most,
            count.mean() / yardstick,
            format!("{least:.0}-{greatest:.0}"),
            format!("{quick:.1}-{slow:.1}"),
            error.map_or("-".to_owned(), |degrees| format!("{degrees:.0e}")),
        )?;
    }
    writeln!(out, "in C and C++, as published, not in this run:")?;
    for Published {
        label,
        instructions,
    } in PUBLISHED
    {
        writeln!(
            out,
            "{label:<52} {instructions:>12} {:>8} {:>7.1}",
            "",
            f64::from(instructions) / yardstick
        )?;
    }
    Ok(())
}

/// Prints what the tracker takes.
///
/// # Errors
///
/// As of the writer.
pub fn firmware(out: &mut impl Write, runs: &[(Mode, Figures)]) -> io::Result<()> {
    writeln!(
        out,
        "{:<38} {:>12} {:>5} {:>25} {:>25} {:>8}",
        "the tracker; ms: median, 99 %, most", "CPU load", "I2C", "to USB", "to the host", "stack"
    )?;
    let milliseconds = |times: Option<[f64; 3]>| {
        times.map_or("-".to_owned(), |times| {
            let [median, most, worst] = times.map(|seconds| seconds * 1e3);
            format!("{median:.3}, {most:.3}, {worst:.3}")
        })
    };
    for (mode, figures) in runs {
        let (least, greatest) = figures.load;
        writeln!(
            out,
            "{:<38} {:>12} {:>5} {:>25} {:>25} {:>6} B",
            mode.label,
            format!("{:.1}-{:.1} %", least * 100.0, greatest * 100.0),
            format!("{:.0} %", figures.bus * 100.0),
            milliseconds(figures.latency),
            milliseconds(figures.to_host),
            figures.stack,
        )?;
    }
    if let Some((_, figures)) = runs.first() {
        let ram = figures.ram.unwrap_or(0);
        writeln!(
            out,
            "flash {} of {FLASH_SIZE} bytes, static RAM {ram} of {RAM_SIZE} bytes",
            figures.flash
        )?;
    }
    Ok(())
}

/// The same for programs; cost/README.md says what each member is.
pub fn json(rows: &[Row], yardstick: f64, runs: &[(Mode, Figures)]) -> Value {
    let filters = rows.iter().map(|row| {
        let count = &row.count;
        Value::Object(vec![
            ("name", row.subject.name.into()),
            ("label", row.subject.label.into()),
            ("updates", (count.updates as f64).into()),
            ("instructions", (count.instructions as f64).into()),
            ("instructions_mean", count.mean().into()),
            ("instructions_most", (count.most as f64).into()),
            ("cycles_mean", count.mean_cycles().into()),
            ("us_mean", count.mean_us().into()),
            ("ratio", (count.mean() / yardstick).into()),
            ("error_degrees", row.error.into()),
        ])
    });
    let published = PUBLISHED.iter().map(|published| {
        Value::Object(vec![
            ("label", published.label.into()),
            ("instructions", f64::from(published.instructions).into()),
        ])
    });
    let firmware = runs.iter().map(|(mode, figures)| {
        let (least, greatest) = figures.load;
        Value::Object(vec![
            ("label", mode.label.into()),
            ("seconds", (MEASURED_S as f64).into()),
            ("load", [least, greatest].into()),
            ("bus", figures.bus.into()),
            ("to_usb_s", figures.latency.into()),
            ("to_host_s", figures.to_host.into()),
            ("stack_bytes", f64::from(figures.stack).into()),
            ("flash_bytes", (figures.flash as f64).into()),
            ("ram_bytes", figures.ram.map(|bytes| bytes as f64).into()),
            ("interrupts", (figures.interrupts as f64).into()),
        ])
    });
    Value::Object(vec![
        ("filters", Value::List(filters.collect())),
        ("published", Value::List(published.collect())),
        ("firmware", Value::List(firmware.collect())),
    ])
}
