//! Boards that boot the tracker's image, and one with a few instructions.

use std::path::PathBuf;
use std::sync::OnceLock;

use vrduino_emulator::board::setup::Eeprom;
use vrduino_emulator::board::{Board, Setup};
use vrduino_emulator::firmware::{self, BuildOptions};
use vrduino_emulator::image::Image;
use vrduino_emulator::motion;
use vrduino_emulator::time::{self, MILLISECOND};

pub fn path() -> PathBuf {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    let build = || firmware::build(BuildOptions { quiet: true }).expect("the firmware builds");
    PATH.get_or_init(build).clone()
}

/// A board that was in use before: at its first start the tracker takes 70 ms to make an EEPROM.
pub fn setup() -> Setup {
    let eeprom = Eeprom::new(vec![0xFF; 2048]).expect("2 KiB");
    Setup::new(motion::built_in()).with_eeprom(eeprom)
}

pub fn board(setup: Setup) -> Board {
    Board::new(Image::open(&path()).expect("it is accepted"), setup)
}

/// An image of a few instructions, which begin at 0x410; `vectors` are the handlers of exceptions by number.
pub fn small_image(code: &[u16], vectors: &[(usize, u32)]) -> Image {
    let mut flash = vec![0xFF; 0x410];
    let mut word = |index: usize, value: u32| {
        flash[4 * index..][..4].copy_from_slice(&value.to_le_bytes());
    };
    word(0, 0x2000_8000);
    word(1, 0x411);
    for &(exception, handler) in vectors {
        word(exception, handler | 1);
    }
    flash[0x40C] = 0xFE;
    flash.extend(code.iter().flat_map(|halfword| halfword.to_le_bytes()));
    let records: Vec<ihex::Record> = (0..)
        .step_by(16)
        .zip(flash.chunks(16))
        .map(|(offset, bytes)| ihex::Record::Data {
            offset,
            value: bytes.to_vec(),
        })
        .chain([ihex::Record::EndOfFile])
        .collect();
    let text = ihex::create_object_file_representation(&records).expect("good records");
    Image::parse(text.as_bytes()).expect("it is accepted")
}

/// Runs, and returns what the host has read.
pub fn run(board: &mut Board, seconds: f64) -> Vec<u8> {
    let until = board.now() + time::ticks(seconds);
    let mut received = Vec::new();
    while board.now() < until && board.stop().is_none() {
        board.run(MILLISECOND.min(until - board.now()));
        received.extend(board.chip_quietly().host.take_received());
    }
    received
}
