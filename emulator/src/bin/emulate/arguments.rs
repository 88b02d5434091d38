//! The command line.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Parser, ValueEnum};
use vrduino_emulator::mpu9250::Part;
use vrduino_emulator::time::{self, Ticks};
use vrduino_emulator::witness::Trap;

use crate::values::{byte, celsius, percent, positive, seed};

use super::input::{Input, Kind};
use super::tools::Tools;

/// Boots the tracker's image on an emulated VRduino board and prints what it streams.
///
/// The stream goes to standard output and to a pseudo-terminal whose path is printed; everything else goes to
/// standard error. Without --image the tracker is built first. Without --motion a head moves: still for three seconds,
/// then yaw, pitch and roll. The world is y-up: recordings in a z-up world (x east, y north, z up) are turned to
/// (x, z, -y); the sensor's axes are fed as they were recorded.
#[derive(Parser, Debug)]
#[command(name = "cargo emulate", version)]
pub struct Arguments {
    /// Seconds of emulated time to run; else until the motion ends, or Ctrl-C
    #[arg(long, value_name = "N", value_parser = positive, allow_negative_numbers = true)]
    pub seconds: Option<f64>,

    /// What moves the sensor: an .imub recording, a CSV file with the columns t,gx,gy,gz,ax,ay,az (s, rad/s, m/s²), or
    /// the course's six-column rows at 2 ms (°/s, m/s²)
    #[arg(long, value_name = "FILE")]
    pub motion: Option<PathBuf>,

    /// Begin the motion here, in seconds
    #[arg(long, value_name = "S", default_value = "0", value_parser = positive, allow_negative_numbers = true)]
    pub start: f64,

    /// An image to boot instead of the tracker's: ELF or Intel HEX
    #[arg(long, value_name = "FILE")]
    pub image: Option<PathBuf>,

    /// What is in the EEPROM, as from the run before: read at the start, written at the end; a file that is not there is
    /// a chip that was never partitioned
    #[arg(long, value_name = "FILE")]
    pub eeprom: Option<PathBuf>,

    /// Run no faster than real time; also done while something reads the pseudo-terminal
    #[arg(long)]
    pub realtime: bool,

    /// Offer the device to another host over USB/IP on this port of 127.0.0.1, in real time, instead of reading it; 0 is
    /// any free port, which is printed
    #[arg(long, value_name = "PORT", conflicts_with = "typed")]
    pub usbip: Option<u16>,

    /// Type these keys on the serial port, e.g. 2@3.5 for the key 2 at 3.5 s; may be given more than once
    #[arg(long = "type", value_name = "KEYS@S")]
    pub typed: Vec<Typed>,

    /// Break something, from S on (else from the start) and until T (else for good); may be given more than once
    #[arg(long, value_name = "FAULT[@S[-T]]", help = FAULT_HELP)]
    pub fault: Vec<Fault>,

    /// Let time pass by the pessimistic end of the band of cycle counts: with the flash's wait states
    #[arg(long)]
    pub pessimistic: bool,

    /// Time the calls of this function, by the end of its path; else the tracker's filter, Tracker::track
    #[arg(long, value_name = "FUNCTION")]
    pub time: Option<String>,

    /// Go on as silicon would after stepping into this trap, instead of stopping with exit code 3; `all` allows
    /// every one; may be given more than once
    #[arg(long, value_name = "TRAP", value_parser = allowed)]
    pub allow: Vec<Allowed>,

    /// List the traps, each with the rule it stands for, and end
    #[arg(long)]
    pub traps: bool,

    /// The individual sensor: perfect, typical (errors drawn within the data sheet's limits) or worst (all at the limit)
    #[arg(long, value_name = "KIND", default_value = "perfect")]
    pub part: PartKind,

    /// Which of the typical or worst parts, and which noise: the same seed gives the same run
    #[arg(long, value_name = "N", default_value = "1", value_parser = seed, allow_negative_numbers = true)]
    pub seed: u64,

    /// The sensor's WHO_AM_I; 0x70 and 0x75 are clones without magnetometer
    #[arg(long, value_name = "BYTE", default_value = "0x71", value_parser = byte)]
    pub who_am_i: u8,

    /// Nothing answers where the magnetometer should be
    #[arg(long)]
    pub no_magnetometer: bool,

    /// Error of the sensor's own oscillator in percent, else the part's; the data sheet allows 1
    #[arg(long, value_name = "PERCENT", value_parser = percent, allow_negative_numbers = true)]
    pub sensor_clock: Option<f64>,

    /// Temperature of the sensor in °C
    #[arg(long, value_name = "C", default_value = "25", value_parser = celsius, allow_negative_numbers = true)]
    pub temperature: f64,

    /// What is written down about the run.
    #[command(flatten)]
    pub tools: Tools,
}

/// Which individual.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PartKind {
    /// No error but quantisation.
    Perfect,
    /// Errors drawn within the data sheet's limits.
    Typical,
    /// Errors at the data sheet's limits.
    Worst,
}

const FAULT_HELP: &str = "Break something, from S on (else from the start) and until T (else for good): absent (no sensor \
                          answers), frozen (no new samples), magnetometer-absent, magnetometer-frozen, brown-out (the sensor loses its settings), stuck-sda (held \
                          until it is clocked free), stuck-scl, no-pull-ups, unread (nobody reads the port), unplugged, noisy-usb (damaged packets and lost handshakes); may be given \
                          more than once";

/// One trap, or all.
#[derive(Debug, Clone, Copy)]
pub struct Allowed(Option<Trap>);

fn allowed(text: &str) -> Result<Allowed, String> {
    if text == "all" {
        return Ok(Allowed(None));
    }
    text.parse().map(|trap| Allowed(Some(trap)))
}

/// Keys to type, and when.
#[derive(Debug, Clone)]
pub struct Typed {
    keys: String,
    at: Ticks,
}

impl FromStr for Typed {
    type Err = String;

    fn from_str(text: &str) -> Result<Typed, String> {
        let (keys, at) = text
            .rsplit_once('@')
            .ok_or("give keys and a time, such as 2@3.5")?;
        if keys.is_empty() {
            return Err("give at least one key before the @, such as 2@3.5".into());
        }
        Ok(Typed {
            keys: keys.into(),
            at: time::ticks(positive(at)?),
        })
    }
}

/// Something broken for a while.
#[derive(Debug, Clone)]
pub struct Fault {
    kind: Kind,
    from: Ticks,
    until: Ticks,
}

impl FromStr for Fault {
    type Err = String;

    fn from_str(text: &str) -> Result<Fault, String> {
        let (kind, span) = text
            .split_once('@')
            .map_or((text, None), |(kind, span)| (kind, Some(span)));
        let (from, until) = match span.map(|span| {
            span.split_once('-')
                .map_or((span, None), |(s, t)| (s, Some(t)))
        }) {
            None => (0.0, None),
            Some((from, until)) => (positive(from)?, until.map(positive).transpose()?),
        };
        if until.is_some_and(|until| until <= from) {
            return Err("the fault has to end after it begins, as in absent@2-4".into());
        }
        Ok(Fault {
            kind: Kind::from_str(kind, true)
                .map_err(|_| "give one of absent, frozen, magnetometer-absent, magnetometer-frozen, brown-out, stuck-sda, stuck-scl, no-pull-ups, unread, unplugged, noisy-usb")?,
            from: time::ticks(from),
            until: until.map_or(Ticks::MAX, time::ticks),
        })
    }
}

/// What is to be done to the board, in time.
pub struct Script {
    typed: Vec<Typed>,
    /// Each fault, and whether it is on.
    faults: Vec<(Fault, bool)>,
}

impl Arguments {
    /// The function to time: the tracker's update of its estimators by one sample, unless another was named.
    pub fn timed(&self) -> &str {
        self.time.as_deref().unwrap_or("Tracker<M>::track")
    }

    /// The sensor on the board.
    pub fn part(&self) -> Part {
        let kind = match self.part {
            PartKind::Perfect => Part::perfect(),
            PartKind::Typical => Part::typical(self.seed),
            PartKind::Worst => Part::worst(self.seed),
        };
        let part = kind.who_am_i(self.who_am_i).temperature(self.temperature);
        let part = match self.sensor_clock {
            Some(percent) => part.clock_error(percent / 100.0),
            None => part,
        };
        if self.no_magnetometer {
            part.without_magnetometer()
        } else {
            part
        }
    }

    /// The traps that do not stop the run.
    pub fn allowed(&self) -> Vec<Trap> {
        if self.allow.iter().any(|Allowed(trap)| trap.is_none()) {
            return Trap::ALL.to_vec();
        }
        self.allow
            .iter()
            .filter_map(|Allowed(trap)| *trap)
            .collect()
    }

    /// Keys and faults as a script.
    pub fn script(&self) -> Script {
        Script {
            typed: self.typed.clone(),
            faults: self
                .fault
                .iter()
                .map(|fault| (fault.clone(), false))
                .collect(),
        }
    }
}

impl Script {
    /// What is due at `now`.
    pub fn due(&mut self, now: Ticks) -> Vec<Input> {
        let mut inputs: Vec<Input> = self
            .typed
            .extract_if(.., |typed| typed.at <= now)
            .map(|typed| Input::Typed(typed.keys.into_bytes()))
            .collect();
        for (fault, on) in &mut self.faults {
            let due = (fault.from..fault.until).contains(&now);
            if due != *on {
                *on = due;
                inputs.push(Input::Fault(fault.kind, due));
            }
        }
        inputs
    }
}
