//! What is said at the end of a run.

use std::time::Instant;

use vrduino_emulator::board::Board;
use vrduino_emulator::chip::{INTERRUPTS, interrupt_name};
use vrduino_emulator::time::{self, Ticks};

use super::say;

/// Functions of a profile that are told.
const PROFILE_ROWS: usize = 40;

/// Counts the stream's lines.
pub struct Report {
    started: Instant,
    lines: u64,
    orientations: u64,
    /// When the first orientation ended, and the last.
    first: Option<Ticks>,
    last: Ticks,
    rest: Vec<u8>,
}

impl Report {
    /// A run begins.
    pub fn new() -> Report {
        Report {
            started: Instant::now(),
            lines: 0,
            orientations: 0,
            first: None,
            last: 0,
            rest: Vec::new(),
        }
    }

    /// Takes in a piece of the stream.
    pub fn take_in(&mut self, now: Ticks, bytes: &[u8]) {
        for &byte in bytes {
            if byte != b'\n' {
                // Enough to tell what a line is; a stream without line ends must not grow without end.
                if self.rest.len() < 8 {
                    self.rest.push(byte);
                }
                continue;
            }
            self.lines += 1;
            if self.rest.starts_with(b"QC ") {
                self.orientations += 1;
                self.first.get_or_insert(now);
                self.last = now;
            }
            self.rest.clear();
        }
    }

    /// Prints it to standard error; `function` is the one that was timed.
    pub fn print(&self, board: &mut Board, function: &str) {
        let (emulated, wall) = (
            time::seconds(board.now()),
            self.started.elapsed().as_secs_f64(),
        );
        say!(
            "ran     {emulated:.3} s in {wall:.1} s, {:.2} times real time",
            emulated / wall.max(1e-9)
        );
        {
            let chip = board.chip();
            match chip.host.identity() {
                Some(device) => say!(
                    "device  {} by {}, {:04x}:{:04x}, serial number {}",
                    device.product_name,
                    device.manufacturer,
                    device.vendor,
                    device.product,
                    device.serial_number
                ),
                None => say!("device  none: the image did not bring up its USB port"),
            }
            for (at, complaint) in chip.sensor.complaints.list() {
                say!(
                    "sensor  {complaint} ({}), first at {:.4} s",
                    complaint.section(),
                    time::seconds(*at)
                );
            }
        }
        match self.first {
            Some(first) => {
                let span = time::seconds(self.last - first);
                let rate = if span > 0.0 {
                    (self.orientations - 1) as f64 / span
                } else {
                    0.0
                };
                say!(
                    "lines   {}, of these {} QC: the first at {:.3} s, then {rate:.1} in a second",
                    self.lines,
                    self.orientations,
                    time::seconds(first)
                );
            }
            None => say!("lines   {}", self.lines),
        }
        // Before the image has started, the counter's memory holds anything.
        match board.variable("vrduino_dropped_lines") {
            Some(count) if self.lines > 0 => {
                say!("dropped {count} lines, for want of a reader")
            }
            // Another image than the tracker's has no such counter.
            _ => {}
        }
        say!("resets  {}", board.resets());
        let figures = board.figures();
        let load = (100.0 * figures.load.0, 100.0 * figures.load.1);
        let rate = board.instructions() as f64 / emulated.max(1e-9) / 1e6;
        if load.0 > 99.9 {
            say!("cpu     never sleeps, {rate:.1} million instructions a second");
        } else {
            say!(
                "cpu     {:.1} to {:.1} % busy, {rate:.1} million instructions a second",
                load.0,
                load.1
            );
        }
        say!("stack   {} bytes at its deepest", figures.stack);
        say!("bus     {:.1} % in use, I2C", 100.0 * figures.bus);
        let ways = [
            ("to the packet at its endpoint", figures.latency),
            ("to the host", figures.to_host),
        ];
        for (way, times) in ways {
            if let Some(times) = times {
                let [median, most, worst] = times.map(|seconds| 1e3 * seconds);
                say!(
                    "latency {median:.3} ms from data-ready {way} in the median, {most:.3} ms at 99 %, {worst:.3} ms at worst"
                );
            }
        }
        for (number, latency) in INTERRUPTS.iter().zip(&board.measure().latencies) {
            if latency.count > 0 {
                say!(
                    "irq     {} taken {} times, after {:.2} µs at worst",
                    interrupt_name(*number).unwrap_or("?"),
                    latency.count,
                    time::seconds(latency.worst) * 1e6
                );
            }
        }
        for (name, share) in board.profiled().iter().take(PROFILE_ROWS) {
            say!(
                "profile {:>10} instructions, {:>10} to {:>10} cycles in {name}",
                share.instructions,
                share.cycles.least,
                share.cycles.greatest
            );
        }
        say!("hash    {:016x}", board.state_hash());
        let calls = &board.measure().calls;
        if calls.count > 0 {
            say!(
                "timed   {function}, {} calls: {} instructions on average, {} at most; {} to {} cycles on average, {} to {} at worst",
                calls.count,
                calls.instructions / calls.count,
                calls.most_instructions,
                calls.cycles.least / calls.count,
                calls.cycles.greatest / calls.count,
                calls.worst.least,
                calls.worst.greatest
            );
        }
    }
}
