//! Every trap is sprung: for each there is a small image that steps into it, in `wrong-images`.

use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

use vrduino_emulator::board::{Board, Setup};
use vrduino_emulator::firmware::{self, BuildOptions, Package};
use vrduino_emulator::image::Image;
use vrduino_emulator::motion::turns::Turns;
use vrduino_emulator::time::MILLISECOND;
use vrduino_emulator::witness::Trap;

fn images() -> &'static PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let package = Package {
            manifest: "emulator/wrong-images/Cargo.toml",
            feature: "image",
            profile: firmware::PROFILE,
        };
        firmware::build_package(package, BuildOptions { quiet: true })
            .expect("the wrong images build")
    })
}

fn board(trap: Trap, allowed: &[Trap]) -> Board {
    let image = Image::open(&images().join(trap.name())).expect("every trap has its image");
    Board::new(
        image,
        Setup::new(Box::new(Turns::new(1e6, 0.0))).allowing(allowed),
    )
}

#[test]
fn every_trap_stops_the_image_that_steps_into_it() {
    for &trap in Trap::ALL {
        // Error flags are left by another mistake, which has to be passed first.
        let first: &[Trap] = match trap {
            Trap::FlashErrorFlags => &[Trap::FlashCommand],
            _ => &[],
        };
        let mut board = board(trap, first);
        board.run(6_000 * MILLISECOND);
        let stop = board
            .stop()
            .unwrap_or_else(|| panic!("nothing stopped {trap}"));
        assert_eq!(stop.trap, trap, "{stop}");
        let (text, address) = (stop.to_string(), format!("{:#010x}", stop.pc));
        assert!(
            text.contains(trap.rule()) && text.contains(&address),
            "{text}"
        );
        let at = board.now();
        board.run(MILLISECOND);
        assert_eq!(board.now(), at, "{trap}: it went on");
    }
}

#[test]
fn a_trap_that_is_allowed_is_told_and_passed() {
    for &trap in Trap::ALL {
        let mut board = board(trap, Trap::ALL);
        let mut told = Vec::new();
        // A request may be put off for five seconds; every other trap is sprung at once.
        for _ in 0..240 {
            board.run(25 * MILLISECOND);
            told.extend(board.take_events());
            if told.iter().any(|event| event.what.starts_with(trap.name())) {
                break;
            }
        }
        assert_eq!(board.stop(), None);
        assert!(
            told.iter().any(|event| event.what.starts_with(trap.name())),
            "{trap}: {:?}",
            told.first()
        );
        assert!(board.now() >= 25 * MILLISECOND, "{trap}: time stood still");
    }
}

#[test]
fn the_usb_device_without_its_mistake_is_not_stopped() {
    let image = Image::open(&images().join("usb-right")).expect("it is an image");
    let mut board = Board::new(image, Setup::new(Box::new(Turns::new(1e6, 0.0))));
    board.run(400 * MILLISECOND);
    assert_eq!(board.stop(), None);
    assert!(board.chip().host.take_received().starts_with(b".\n.\n"));
}

#[test]
fn there_are_many_and_their_names_are_their_own() {
    assert!(Trap::ALL.len() >= 30);
    for (index, trap) in Trap::ALL.iter().enumerate() {
        assert_eq!(trap.name().parse(), Ok(*trap));
        assert!(
            Trap::ALL[..index]
                .iter()
                .all(|other| other.name() != trap.name())
        );
    }
    let error = "watchdog".parse::<Trap>().unwrap_err();
    assert!(error.contains("--traps"), "{error}");
}

#[test]
fn a_stack_among_the_variables_on_purpose_is_not_stopped() {
    let image = Image::open(&images().join("stack-moved")).expect("it is an image");
    let mut board = Board::new(image, Setup::new(Box::new(Turns::new(1e6, 0.0))));
    board.run(10 * MILLISECOND);
    assert_eq!(board.stop(), None);
}

#[test]
fn the_command_ends_with_code_3_and_explains() {
    let run = |more: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_emulate"))
            .args(["--seconds", "0.1", "--image"])
            .arg(images().join("clock-gated"))
            .args(more)
            .output()
            .expect("the command runs")
    };
    let stopped = run(&[]);
    let said = String::from_utf8(stopped.stderr).expect("text");
    assert_eq!(stopped.status.code(), Some(3), "{said}");
    for part in ["stopped clock-gated", "ADC0", "main", "rule    an access"] {
        assert!(said.contains(part), "no {part:?} in\n{said}");
    }
    let allowed = run(&["--allow", "clock-gated", "--allow", "lockup"]);
    let said = String::from_utf8(allowed.stderr).expect("text");
    assert_eq!(allowed.status.code(), Some(0), "{said}");
    assert!(said.contains("clock-gated: read of 0x4003b000"), "{said}");
    assert_eq!(run(&["--allow", "gravity"]).status.code(), Some(2));
}
