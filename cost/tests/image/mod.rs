//! An image that is counted: built once, run in the emulator, and taken apart.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::OnceLock;

use object::{Object, ObjectSection, ObjectSymbol};
use vrduino_cost::subject::OURS;
use vrduino_emulator::board::{Board, Setup};
use vrduino_emulator::image::Image;
use vrduino_emulator::motion::turns::Turns;
use vrduino_emulator::time::MILLISECOND;

/// One of the images of this package.
#[derive(Clone, Copy)]
pub struct Counted(pub &'static str);

impl Counted {
    fn path(self) -> PathBuf {
        static BUILT: OnceLock<PathBuf> = OnceLock::new();
        let filters = BUILT.get_or_init(|| OURS.build().expect("the images build"));
        filters.with_file_name(self.0)
    }

    fn open(self) -> Image {
        Image::open(&self.path()).expect("the emulator accepts the image")
    }

    /// A board that is about to start, and will count the calls of `function`.
    pub fn board(self, function: &str) -> Board {
        let mut setup = Setup::new(Box::new(Turns::new(1e6, 0.0)));
        setup.timed_function = function.to_owned();
        Board::new(self.open(), setup)
    }

    /// The board when it has gone through so many motions.
    pub fn after(self, function: &str, motions: usize) -> Board {
        let mut board = self.board(function);
        run_until(&mut board, motions);
        board
    }

    /// Every function that can be called from these, with them. No instruction of a floating-point unit is in any.
    pub fn called_from(self, names: &[&str]) -> BTreeSet<String> {
        let bytes = std::fs::read(self.path()).unwrap();
        let elf = object::File::parse(&*bytes).unwrap();
        let text = elf.section_by_name(".text").unwrap();
        let (base, code) = (text.address(), text.data().unwrap());
        let function = |address: u64| {
            elf.symbols()
                .find(|symbol| {
                    let start = symbol.address() & !1;
                    symbol.size() > 0 && (start..start + symbol.size()).contains(&address)
                })
                .unwrap_or_else(|| panic!("{address:#x} is in no function"))
        };
        let image = self.open();
        let address = |name: &&str| u64::from(image.address_of(name).unwrap() & !1);
        let mut open: Vec<u64> = names.iter().map(address).collect();
        let mut seen = BTreeSet::new();
        while let Some(address) = open.pop() {
            let symbol = function(address);
            let start = symbol.address() & !1;
            if seen.insert(symbol.name().unwrap().to_owned()) {
                let offset = (start - base) as usize;
                let body = &code[offset..offset + symbol.size() as usize];
                open.extend(branches_out(start, body));
            }
        }
        seen
    }
}

/// Until so many motions are over.
pub fn run_until(board: &mut Board, motions: usize) {
    for _ in 0..2_000 {
        // The first millisecond is more than enough to clear the memory.
        board.run(MILLISECOND);
        assert!(board.stop().is_none(), "{}", board.stop().unwrap());
        if board.variable("DONE") >= Some(motions as u32) {
            return;
        }
    }
    panic!("the image did not come to its end");
}

/// Where the function that starts here calls or jumps to.
fn branches_out(start: u64, body: &[u8]) -> Vec<u64> {
    let end = start + body.len() as u64;
    let halfword = |at: u64| {
        let offset = (at - start) as usize;
        u16::from_le_bytes([body[offset], body[offset + 1]])
    };
    let mut targets = Vec::new();
    let mut at = start;
    while at < end {
        let first = halfword(at);
        if first >> 11 < 0b11101 {
            at += 2;
            continue;
        }
        let second = halfword(at + 2);
        let coprocessor = first >> 10 & 0b111011 == 0b111011;
        assert!(
            !(coprocessor && matches!(second >> 8 & 0xF, 10 | 11)),
            "{at:#x}"
        );
        // BL, and B.W out of the function (ARMv7-M manual, encodings T1 and T4).
        if first >> 11 == 0b11110 && second >> 15 == 1 && second >> 12 & 1 == 1 {
            let target = branch_target(at, first, second);
            if !(start..end).contains(&target) {
                targets.push(target);
            }
        }
        at += 4;
    }
    targets
}

/// Where BL T1 and B T4 go.
fn branch_target(at: u64, first: u16, second: u16) -> u64 {
    let (first, second) = (u32::from(first), u32::from(second));
    let sign = first >> 10 & 1;
    let j = |bit: u32| 1 ^ (second >> bit & 1) ^ sign;
    let offset =
        sign << 24 | j(13) << 23 | j(11) << 22 | (first & 0x3FF) << 12 | (second & 0x7FF) << 1;
    let offset = ((offset << 7) as i32) >> 7;
    (at as i64 + 4 + i64::from(offset)) as u64
}

/// What the image has left in a table of words.
pub fn table(board: &Board, name: &str, words: usize) -> Vec<i32> {
    let address = board.image().address_of(name).unwrap();
    board
        .peek(address, 4 * words)
        .chunks_exact(4)
        .map(|word| i32::from_le_bytes(word.try_into().unwrap()))
        .collect()
}
