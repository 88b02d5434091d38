//! The filter in fixed point on the chip: the same bits as on the host, and what it costs.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::OnceLock;

use object::{Object, ObjectSection, ObjectSymbol};
use vrduino::fixed::multiply::Portable;
use vrduino_cost::subject::OURS;
use vrduino_cost_images::motion::{Motion, Random, SAMPLES};
use vrduino_emulator::board::{Board, Setup};
use vrduino_emulator::image::Image;
use vrduino_emulator::motion::turns::Turns;
use vrduino_emulator::time::MILLISECOND;

/// Instructions of a whole update, bias and parameters included, up to 45° from level: always the same number.
const NEAR_LEVEL: u64 = 200;
/// Most that any input may cost.
const WORST: u64 = 600;

fn path() -> &'static PathBuf {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(|| {
        let filters = OURS.build().expect("the images build");
        filters.with_file_name("fixed-complementary")
    })
}

/// The board when it has gone through every motion; it has counted the calls of `function`.
fn at_the_end(function: &str) -> Board {
    let image = Image::open(path()).expect("the emulator accepts the image");
    let mut setup = Setup::new(Box::new(Turns::new(1e6, 0.0)));
    setup.timed_function = function.to_owned();
    let mut board = Board::new(image, setup);
    for _ in 0..2_000 {
        // The first millisecond is more than enough to clear the memory.
        board.run(MILLISECOND);
        assert!(board.stop().is_none(), "{}", board.stop().unwrap());
        if board.variable("DONE") == Some(Motion::ALL.len() as u32) {
            return board;
        }
    }
    panic!("the image did not come to its end");
}

#[test]
fn near_level_every_update_costs_the_same() {
    // Well before anything comes: level first, then tilted.
    let image = Image::open(path()).expect("the emulator accepts the image");
    let mut setup = Setup::new(Box::new(Turns::new(1e6, 0.0)));
    setup.timed_function = "by_instructions".to_owned();
    let mut board = Board::new(image, setup);
    while board.measure().calls.count < u64::from(SAMPLES) * 3 / 2 {
        board.run(MILLISECOND);
        assert!(board.stop().is_none(), "{}", board.stop().unwrap());
        assert!(board.variable("DONE").is_some_and(|done| done < 2));
    }
    let calls = board.measure().calls;
    println!("{} instructions near level", calls.most_instructions);
    assert_eq!(calls.instructions, calls.count * calls.most_instructions);
    assert!(calls.most_instructions <= NEAR_LEVEL, "{calls:?}");
}

#[test]
fn no_input_costs_more_than_the_budget() {
    for function in ["by_instructions", "portable"] {
        let calls = at_the_end(function).measure().calls;
        println!(
            "{function}: {} instructions at most",
            calls.most_instructions
        );
        assert_eq!(calls.count, u64::from(SAMPLES) * Motion::ALL.len() as u64);
        assert!(calls.most_instructions <= WORST, "{function}: {calls:?}");
    }
}

#[test]
fn board_and_host_compute_the_same_bits() {
    let board = at_the_end("portable");
    assert_eq!(board.variable("DIFFERENT"), Some(0));
    let address = board.image().address_of("ORIENTATIONS").unwrap();
    let words: Vec<i32> = board
        .peek(address, 16 * Motion::ALL.len())
        .chunks_exact(4)
        .map(|word| i32::from_le_bytes(word.try_into().unwrap()))
        .collect();
    for (motion, on_board) in Motion::ALL.into_iter().zip(words.chunks_exact(4)) {
        let mut filter = motion.filter::<Portable>();
        let mut random = Random::default();
        for number in 0..SAMPLES {
            filter.update(&motion.sample(number, &mut random));
        }
        assert_eq!(filter.bits(), on_board, "{motion:?}");
    }
}

/// No library routine, so no floating point in software and no panic; and no instruction of a floating-point unit.
#[test]
fn an_update_calls_nothing_but_its_own_slow_path() {
    let bytes = std::fs::read(path()).unwrap();
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
    let mut open: Vec<u64> = ["by_instructions", "portable"]
        .map(|name| u64::from(board_address(name)))
        .to_vec();
    let mut seen = BTreeSet::new();
    while let Some(address) = open.pop() {
        let symbol = function(address);
        let (start, end) = (
            symbol.address() & !1,
            (symbol.address() & !1) + symbol.size(),
        );
        if !seen.insert(symbol.name().unwrap().to_owned()) {
            continue;
        }
        let halfword = |at: u64| {
            let offset = (at - base) as usize;
            u16::from_le_bytes([code[offset], code[offset + 1]])
        };
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
                    open.push(target);
                }
            }
            at += 4;
        }
    }
    println!("{seen:?}");
    assert!(seen.len() >= 4, "the slow paths were not found: {seen:?}");
    for name in &seen {
        let ours = ["by_instructions", "portable", "fixed"];
        assert!(
            ours.iter().any(|ours| name.contains(ours)),
            "{name} is called"
        );
        assert!(!name.contains("panic"), "{name} is called");
    }
}

fn board_address(name: &str) -> u32 {
    let image = Image::open(path()).unwrap();
    image.address_of(name).unwrap() & !1
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
