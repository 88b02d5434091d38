//! A run in words: one line for every register access, bus transaction, USB transaction and interrupt.
//!
//! ```text
//!    1.0012345  registers   I2C0_C1 <- 0xf0 IICEN IICIE MST TX            firmware::board::imu::start + 0x1c
//!    1.0015432  i2c         0x68 write [3a] read [01 00 10]
//!    1.0020000  usb         IN ep3 DATA1 64 bytes "QC 1.000 0.000 …" ACK
//!    1.0020417  interrupts  enter USBOTG (73) after 0.31 µs               main + 0x40
//! ```

mod i2c;

mod registers;

mod usb;

use std::io::{self, Write};
use std::str::FromStr;

use crate::board::watch::{Place, Watcher};
use crate::chip;
use crate::journal::Happening;
use crate::time::{self, Ticks};
use i2c::Transaction;
use usb::Naks;

/// What a trace may tell of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Topic {
    /// Accesses to peripherals' registers.
    Registers,
    /// Whole transactions on the sensor bus.
    I2c,
    /// USB transactions; NAKs are counted, frames left out.
    Usb,
    /// Exceptions, sleep and resets.
    Interrupts,
}

impl Topic {
    /// All of them.
    pub const ALL: [Topic; 4] = [Topic::Registers, Topic::I2c, Topic::Usb, Topic::Interrupts];

    /// Its name in traces and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Topic::Registers => "registers",
            Topic::I2c => "i2c",
            Topic::Usb => "usb",
            Topic::Interrupts => "interrupts",
        }
    }
}

impl FromStr for Topic {
    type Err = String;

    fn from_str(text: &str) -> Result<Topic, String> {
        Topic::ALL
            .into_iter()
            .find(|topic| topic.name() == text)
            .ok_or_else(|| "give registers, i2c, usb, interrupts or all".into())
    }
}

/// A register access that the next one may repeat.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Last {
    text: String,
    repeated: u64,
}

/// Writes a trace.
pub struct Trace<W> {
    out: W,
    topics: Vec<Topic>,
    from: Ticks,
    until: Ticks,
    transaction: Option<Transaction>,
    naks: Naks,
    last: Option<Last>,
    failed: Option<io::Error>,
}

impl<W: Write + Send> Trace<W> {
    /// A trace of `topics` to `out`, from the moment `from` until `until`.
    pub fn new(out: W, topics: &[Topic], from: Ticks, until: Ticks) -> Trace<W> {
        Trace {
            out,
            topics: topics.to_vec(),
            from,
            until,
            transaction: None,
            naks: Naks::default(),
            last: None,
            failed: None,
        }
    }

    fn line(&mut self, at: Ticks, topic: Topic, text: &str, place: Option<Place<'_>>) {
        if !self.topics.contains(&topic) || !(self.from..self.until).contains(&at) {
            return;
        }
        if topic == Topic::Registers {
            // A loop that polls does so from more than one place.
            if let Some(last) = &mut self.last
                && last.text == text
            {
                last.repeated += 1;
                return;
            }
            self.end_of_repetition();
            self.last = Some(Last {
                text: text.to_owned(),
                repeated: 0,
            });
        } else {
            self.end_of_repetition();
        }
        let text = match place {
            Some(place) => format!("{text:<44} {}", name_of(place)),
            None => text.to_owned(),
        };
        self.write(format_args!(
            "{:12.7}  {:10}  {}\n",
            time::seconds(at),
            topic.name(),
            text.trim_end()
        ));
    }

    fn end_of_repetition(&mut self) {
        if let Some(last) = self.last.take()
            && last.repeated > 0
        {
            let times = last.repeated;
            self.write(format_args!("{:14}the same {times} times more\n", ""));
        }
    }

    fn write(&mut self, text: std::fmt::Arguments<'_>) {
        if self.failed.is_none() {
            self.failed = self.out.write_fmt(text).err();
        }
    }

    fn end_transaction(&mut self, at: Ticks, how: &str) {
        if let Some(transaction) = self.transaction.take() {
            self.line(at, Topic::I2c, &format!("{transaction}{how}"), None);
        }
    }
}

impl<W: Write + Send> Watcher for Trace<W> {
    fn saw(&mut self, at: Ticks, happening: &Happening, place: Place<'_>) {
        match happening {
            &Happening::Register {
                address,
                width,
                value,
                store,
            } => {
                let text = registers::access(address, width, value, store);
                self.line(at, Topic::Registers, &text, Some(place));
            }
            &Happening::I2cByte {
                kind,
                byte,
                acknowledged,
                ..
            } => {
                let transaction = self.transaction.get_or_insert_default();
                transaction.byte(kind, byte, acknowledged);
            }
            Happening::I2cStop { .. } => self.end_transaction(at, ""),
            Happening::Usb {
                address,
                endpoint,
                token,
                answer,
            } => {
                if let Some(text) = self.naks.transaction(*address, *endpoint, token, answer) {
                    self.line(at, Topic::Usb, &text, None);
                }
            }
            Happening::UsbReset => self.line(at, Topic::Usb, "bus reset", None),
            &Happening::Entered { exception, waited } => {
                let mut text = format!("enter {}", exception_name(exception));
                if let Some(waited) = waited {
                    text += &format!(" after {:.2} µs", time::seconds(waited) * 1e6);
                }
                self.line(at, Topic::Interrupts, &text, Some(place));
            }
            &Happening::Left { exception } => {
                let text = format!("leave {}", exception_name(exception));
                self.line(at, Topic::Interrupts, &text, None);
            }
            &Happening::Asleep(asleep) => {
                let text = if asleep { "sleep" } else { "wake" };
                self.line(at, Topic::Interrupts, text, Some(place));
            }
            Happening::Reset => {
                self.end_transaction(at, ", cut short by a reset");
                self.line(at, Topic::Interrupts, "reset", Some(place));
            }
            Happening::UsbFrame(_) | Happening::Wires { .. } => {}
        }
    }

    fn finish(&mut self, at: Ticks) -> io::Result<()> {
        self.end_transaction(at, ", not ended");
        self.end_of_repetition();
        match self.failed.take() {
            Some(error) => Err(error),
            None => self.out.flush(),
        }
    }
}

fn name_of(place: Place<'_>) -> String {
    match place.image.symbol_at(place.pc) {
        Some((name, offset)) => format!("{name} + {offset:#x}"),
        None => format!("{:#010x}", place.pc),
    }
}

/// An exception by its name in the architecture, or by the peripheral that asks for it.
pub fn exception_name(exception: u16) -> String {
    let name = match exception {
        2 => "NMI",
        3 => "HardFault",
        4 => "MemManage",
        5 => "BusFault",
        6 => "UsageFault",
        11 => "SVCall",
        12 => "DebugMonitor",
        14 => "PendSV",
        15 => "SysTick",
        16.. => {
            let number = exception - 16;
            return match chip::interrupt_name(number) {
                Some(name) => format!("{name} ({number})"),
                None => format!("interrupt {number}"),
            };
        }
        _ => return format!("exception {exception}"),
    };
    name.into()
}
