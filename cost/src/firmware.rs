//! Runs the whole tracker in the emulator, from the sensor to USB.

use std::error::Error;
use std::path::Path;

use vrduino_emulator::board::figures::Figures;
use vrduino_emulator::board::{Board, Setup};
use vrduino_emulator::cpu::Pace;
use vrduino_emulator::image::Image;
use vrduino_emulator::motion::head::Head;
use vrduino_emulator::time::{MILLISECOND, SECOND, Ticks};

/// What the tracker is told before it is measured, and what that makes it do.
#[derive(Debug, Clone, Copy)]
pub struct Mode {
    /// In words.
    pub label: &'static str,
    /// What is typed.
    pub typed: &'static str,
}

/// Every way of streaming that is measured.
pub const MODES: [Mode; 4] = [
    Mode {
        label: "a line every 10 ms",
        typed: "",
    },
    Mode {
        label: "a line every 10 ms, the notes' filter",
        typed: ":estimator notes\n",
    },
    Mode {
        label: "a frame with every sample",
        typed: ":stream binary\n",
    },
    Mode {
        label: "the same, read by the host's frames",
        typed: ":stream binary\n:lock usb\n",
    },
];

/// Until the bias is measured, the head moves, and the sampling has locked for two seconds.
const SETTLED: Ticks = 6 * SECOND;

/// How long is measured.
pub const MEASURED_S: u64 = 3;

/// The tracker's figures in this mode, with time passing by the pessimistic end of the band.
///
/// # Errors
///
/// In words, if the image cannot run or breaks a rule of the chip.
pub fn run(image: &Path, mode: &Mode) -> Result<Figures, Box<dyn Error>> {
    let setup = Setup {
        pace: Pace::Greatest,
        ..Setup::new(Box::new(Head::default()))
    };
    let mut board = Board::new(Image::open(image)?, setup);
    until(&mut board, SETTLED - 3 * SECOND)?;
    board.chip().host.send(mode.typed.as_bytes());
    until(&mut board, SETTLED)?;
    board.begin_figures();
    until(&mut board, SETTLED + MEASURED_S * SECOND)?;
    Ok(board.figures())
}

fn until(board: &mut Board, end: Ticks) -> Result<(), String> {
    while board.now() < end {
        board.run(MILLISECOND);
        if let Some(stop) = board.stop() {
            return Err(format!("the tracker: {stop}"));
        }
        // A host that reads.
        board.chip_quietly().host.take_received();
    }
    Ok(())
}
