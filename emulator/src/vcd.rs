//! A logic analyser: the board's lines in a Value Change Dump (IEEE 1364, chapter 18), which opens in GTKWave.
//!
//! | variable | |
//! |---|---|
//! | `scl`, `sda` | the sensor bus bit by bit, made from the bytes that crossed it and the time each took |
//! | `usb_dp`, `usb_dm` | levels between packets: J while attached and idle, SE0 while the bus is reset; within a packet both are `x`, since every bit would be megabytes for a second |
//! | `usb` | the packet on the bus, such as `IN_ep3_DATA1_64` |
//! | `asleep` | the processor is in WFI |
//! | `irq_…` | the handler runs |
//! | `exception` | what the processor is handling, `main` for nothing |
//!
//! Within a byte, SDA changes in the middle of SCL's low half, and a START or STOP takes one bit: the K20 manual gives
//! the times of neither edge. A held line ([`crate::peripherals::pins`]) shows where the program's pins change.

mod i2c;

mod usb;

use std::collections::BTreeMap;
use std::io::{self, Write};

use vcd::{IdCode, TimescaleUnit, Value, VarType, Writer};

use crate::board::watch::{Place, Watcher};
use crate::chip::{INTERRUPTS, interrupt_name};
use crate::journal::Happening;
use crate::time::{MILLISECOND, SECOND, Ticks};
use crate::trace::exception_name;
use i2c::Lines;

/// What changes.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Change {
    Level(IdCode, Value),
    Text(IdCode, String),
}

/// What is told at its end began at most so long before: ten bits of the slowest I2C clock.
const BACK: Ticks = 20 * MILLISECOND;

/// Writes the dump.
pub struct Vcd<W: Write> {
    out: Writer<W>,
    wires: Wires,
    lines: Lines,
    /// Changes to come or still uncertain, in order; the second number keeps those of one moment in theirs.
    queue: BTreeMap<(Ticks, u64), Change>,
    queued: u64,
    written_until: Option<u64>,
    handlers: Vec<u16>,
    failed: Option<io::Error>,
}

/// The variables.
#[derive(Debug, Clone)]
struct Wires {
    scl: IdCode,
    sda: IdCode,
    dp: IdCode,
    dm: IdCode,
    usb: IdCode,
    asleep: IdCode,
    exception: IdCode,
    irqs: Vec<IdCode>,
}

impl<W: Write + Send> Vcd<W> {
    /// A dump to `out`, with its header.
    ///
    /// # Errors
    ///
    /// Whatever `out` says.
    pub fn new(out: W) -> io::Result<Vcd<W>> {
        let mut out = Writer::new(out);
        out.version(concat!("vrduino-emulator ", env!("CARGO_PKG_VERSION")))?;
        out.timescale(1, TimescaleUnit::NS)?;
        out.add_module("board")?;
        out.add_module("sensor_bus")?;
        let (scl, sda) = (out.add_wire(1, "scl")?, out.add_wire(1, "sda")?);
        out.upscope()?;
        out.add_module("usb_bus")?;
        let (dp, dm) = (out.add_wire(1, "usb_dp")?, out.add_wire(1, "usb_dm")?);
        let usb = out.add_var(VarType::String, 1, "usb", None)?;
        out.upscope()?;
        out.add_module("processor")?;
        let asleep = out.add_wire(1, "asleep")?;
        let exception = out.add_var(VarType::String, 1, "exception", None)?;
        let mut irqs = Vec::new();
        for number in INTERRUPTS {
            let name = match interrupt_name(number) {
                Some(name) => format!("irq_{name}"),
                None => format!("irq_{number}"),
            };
            irqs.push(out.add_wire(1, &name)?);
        }
        out.upscope()?;
        out.upscope()?;
        out.enddefinitions()?;
        let mut dump = Vcd {
            out,
            wires: Wires {
                scl,
                sda,
                dp,
                dm,
                usb,
                asleep,
                exception,
                irqs,
            },
            lines: Lines::default(),
            queue: BTreeMap::new(),
            queued: 0,
            written_until: None,
            handlers: Vec::new(),
            failed: None,
        };
        dump.level(0, scl, true);
        dump.level(0, sda, true);
        dump.level(0, dp, false);
        dump.level(0, dm, false);
        dump.level(0, asleep, false);
        dump.text(0, usb, "-");
        dump.text(0, exception, "main");
        for irq in dump.wires.irqs.clone() {
            dump.level(0, irq, false);
        }
        Ok(dump)
    }

    fn queue(&mut self, at: Ticks, change: Change) {
        self.queue.insert((at, self.queued), change);
        self.queued += 1;
    }

    fn level(&mut self, at: Ticks, wire: IdCode, level: bool) {
        self.queue(at, Change::Level(wire, level.into()));
    }

    fn text(&mut self, at: Ticks, variable: IdCode, text: &str) {
        // White space would end the value.
        let text = text.replace(char::is_whitespace, "_");
        self.queue(at, Change::Text(variable, text));
    }

    /// Writes what nothing can come before any more.
    fn write_until(&mut self, until: Ticks) {
        while let Some(entry) = self.queue.first_entry()
            && entry.key().0 <= until
        {
            let ((at, _), change) = entry.remove_entry();
            if self.failed.is_none() {
                self.failed = self.write(at, change).err();
            }
        }
    }

    fn write(&mut self, at: Ticks, change: Change) -> io::Result<()> {
        let nanoseconds = (u128::from(at) * 1_000_000_000 / u128::from(SECOND)) as u64;
        // What begins earlier than anything could be is shown late rather than out of order.
        let nanoseconds = self
            .written_until
            .map_or(nanoseconds, |last| last.max(nanoseconds));
        if self.written_until != Some(nanoseconds) {
            self.written_until = Some(nanoseconds);
            self.out.timestamp(nanoseconds)?;
        }
        match change {
            Change::Level(wire, value) => self.out.change_scalar(wire, value),
            Change::Text(variable, text) => self.out.change_string(variable, &text),
        }
    }

    fn follow_handler(&mut self, at: Ticks, exception: u16, runs: bool) {
        if runs {
            self.handlers.push(exception);
        } else {
            self.handlers.pop();
        }
        let index = INTERRUPTS
            .iter()
            .position(|&number| number + 16 == exception);
        if let Some(index) = index {
            self.level(at, self.wires.irqs[index], runs);
        }
        let name = self
            .handlers
            .last()
            .map_or("main".into(), |&exception| exception_name(exception));
        self.text(at, self.wires.exception, &name);
    }
}

impl<W: Write + Send> Watcher for Vcd<W> {
    fn saw(&mut self, at: Ticks, happening: &Happening, _place: Place<'_>) {
        self.write_until(at.saturating_sub(BACK));
        for (at, scl, sda) in self.lines.follow(at, happening) {
            self.level(at, self.wires.scl, scl);
            self.level(at, self.wires.sda, sda);
        }
        for state in usb::states(at, happening) {
            let Wires { dp, dm, usb, .. } = self.wires;
            self.queue(state.at, Change::Level(dp, state.dp));
            self.queue(state.at, Change::Level(dm, state.dm));
            self.text(state.at, usb, &state.text);
        }
        match *happening {
            Happening::Entered { exception, .. } => self.follow_handler(at, exception, true),
            Happening::Left { exception } => self.follow_handler(at, exception, false),
            Happening::Asleep(asleep) => self.level(at, self.wires.asleep, asleep),
            Happening::Reset => {
                while let Some(exception) = self.handlers.last().copied() {
                    self.follow_handler(at, exception, false);
                }
                self.level(at, self.wires.asleep, false);
            }
            _ => {}
        }
    }

    fn finish(&mut self, at: Ticks) -> io::Result<()> {
        self.write_until(at);
        self.queue.clear();
        match self.failed.take() {
            Some(error) => Err(error),
            None => self.out.flush(),
        }
    }
}
