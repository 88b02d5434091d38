//! Where the stream is to come from, as the user says it.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::Args;

use crate::source::emulated::{MOTIONS, PartKind};
use crate::source::{Choice, Emulation, Replay};

// What requires one source says that it conflicts with the others as well: where those are given, clap lets go of the
// requirement and would take it silently.

/// Which board. Without any of them it is the one that is plugged in.
#[derive(Clone, Debug, Default, Args)]
pub struct BoardArguments {
    /// The board's serial port, as `vrduino list` names it; tcp:HOST:PORT reads one over the network
    #[arg(long, value_name = "PORT", group = "source", value_parser = port)]
    pub port: Option<String>,
    /// The emulated board, in this program
    #[arg(long, group = "source")]
    pub emulate: bool,
    /// What the emulated board is carried through: head, turns, hand, still, tumble, or the file of a motion; head unless the
    /// command wants another
    #[arg(
        long,
        value_name = "MOTION",
        requires = "emulate",
        conflicts_with = "port"
    )]
    pub motion: Option<String>,
    /// What is flashed on the emulated board, ELF or Intel HEX, in the place of this repository's firmware
    #[arg(
        long,
        value_name = "FILE",
        requires = "emulate",
        conflicts_with = "port"
    )]
    pub image: Option<PathBuf>,
    /// The emulated sensor
    #[arg(
        long,
        value_name = "KIND",
        requires = "emulate",
        conflicts_with = "port"
    )]
    pub part: Option<PartKind>,
    /// Which of the typical or worst parts, and which noise [default: 1]
    #[arg(long, value_name = "N", requires = "part", conflicts_with = "port")]
    pub seed: Option<u64>,
    /// Lets the emulated board run as fast as this computer allows
    #[arg(long, requires = "emulate", hide = true)]
    pub unpaced: bool,
}

/// Which board, or a recording in its place, for commands to which it makes no difference.
#[derive(Clone, Debug, Default, Args)]
pub struct SourceArguments {
    /// Which board.
    #[command(flatten)]
    pub board: BoardArguments,
    /// A recording of `vrduino record`
    #[arg(long, value_name = "FILE", group = "source", conflicts_with_all = ["motion", "image", "part", "seed"])]
    pub replay: Option<PathBuf>,
    /// The recording is played so many times as fast as it came
    #[arg(
        long,
        value_name = "TIMES",
        default_value_t = 1.0,
        value_parser = within(SPEEDS, "times"),
        allow_negative_numbers = true,
        requires = "replay",
        conflicts_with_all = ["port", "emulate"],
    )]
    pub speed: f64,
    /// When the recording is over it begins again
    #[arg(long, requires = "replay", conflicts_with_all = ["port", "emulate"])]
    pub repeat: bool,
}

impl BoardArguments {
    /// The board they choose; an emulated one is carried through this unless another motion was named.
    pub fn choice_moved_by(&self, motion: &str) -> Choice {
        if self.emulate {
            return Choice::Emulated(Emulation {
                image: self.image.clone(),
                motion: self.motion.clone().unwrap_or_else(|| motion.to_owned()),
                part: self.part.unwrap_or_default(),
                seed: self.seed.unwrap_or(1),
                paced: !self.unpaced,
            });
        }
        Choice::Port(self.port.clone())
    }
}

impl SourceArguments {
    /// The source they choose.
    pub fn choice(&self) -> Choice {
        self.choice_moved_by(MOTIONS[0])
    }

    /// The same; an emulated board is carried through this unless another motion was named.
    pub fn choice_moved_by(&self, motion: &str) -> Choice {
        match &self.replay {
            Some(path) => Choice::Replay(Replay {
                path: path.clone(),
                speed: self.speed,
                repeats: self.repeat,
            }),
            None => self.board.choice_moved_by(motion),
        }
    }
}

/// How many times as fast as it came a recording can be played.
pub const SPEEDS: RangeInclusive<f64> = 0.01..=1000.0;

/// Reads a number of these within bounds.
///
/// Whoever takes one says `allow_negative_numbers`, or clap calls a minus an unknown option.
pub fn within(
    bounds: RangeInclusive<f64>,
    unit: &'static str,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |text| match text.parse() {
        Ok(value) if bounds.contains(&value) => Ok(value),
        _ => {
            let (least, most) = (bounds.start(), bounds.end());
            Err(format!("give a number of {unit} from {least} to {most}"))
        }
    }
}

/// A port's name; an address of the network has to be one.
fn port(text: &str) -> Result<String, String> {
    let is_address = |address: &str| {
        let (host, port) = address.rsplit_once(':').unwrap_or_default();
        !host.is_empty() && port.parse::<u16>().is_ok()
    };
    match text.strip_prefix("tcp:") {
        Some(address) if !is_address(address) => Err("as tcp:127.0.0.1:4000, host and port".into()),
        _ => Ok(text.to_owned()),
    }
}
