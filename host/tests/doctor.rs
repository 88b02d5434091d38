//! Promise: whatever is wrong between plug and stream, the doctor finds it and says what to do.

mod program;

#[cfg(unix)]
mod pty;

use program::vrduino;

#[test]
fn a_healthy_board_is_found_healthy() {
    vrduino(&["doctor", "--emulate", "--unpaced"])
        .expect(0)
        .said("✓ its program is vrduino 0.1.0")
        .said("✓ the magnetometer delivers")
        .said("✓ 1000 samples a second")
        .said("✓ quaternions are of unit length")
        .said("✓ at rest the accelerometer reads 9.81 m/s²")
        .said("✓ at rest it turned by 0.0")
        .said("Next: `vrduino view`");
}

#[test]
fn a_board_that_is_moved_is_not_judged_by_its_drift() {
    vrduino(&["doctor", "--emulate", "--unpaced", "--motion", "head"])
        .expect(0)
        .said("! it was moved while it was looked at");
}

#[test]
fn what_is_not_there_is_said() {
    vrduino(&["doctor", "--port", "tcp:127.0.0.1:1"])
        .expect(1)
        .said("✗ it cannot be opened")
        .said("nothing answers at tcp:127.0.0.1:1");
    let image = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
    vrduino(&["doctor", "--emulate", "--image", image])
        .expect(1)
        .said("neither ELF nor Intel HEX");
    vrduino(&["doctor", "--replay", "x.csv"])
        .expect(2)
        .said("unexpected argument '--replay'");
}

#[cfg(unix)]
mod on_a_port {
    use std::io::{Read, Write};
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread;
    use std::time::Duration;

    use vrduino_emulator::board::{Board, Setup};
    use vrduino_emulator::motion::Turns;
    use vrduino_emulator::mpu9250::Part;

    use super::program::{Ended, vrduino};
    use super::pty::{PluggedIn, Pty};

    fn still() -> Setup {
        Setup::new(Box::new(Turns::new(3600.0, 0.0)))
    }

    fn look_at(
        board: impl FnOnce(vrduino_emulator::image::Image) -> Board + Send + 'static,
    ) -> Ended {
        let board = PluggedIn::with(board, Vec::new);
        vrduino(&["doctor", "--port", &board.path])
    }

    #[test]
    fn a_sensor_that_does_not_answer_is_found_by_its_lines() {
        look_at(|image| {
            let mut board = Board::new(image, still());
            board.chip().sensor.faults.absent = true;
            board
        })
        .expect(1)
        .said("✗ the board says `error: no IMU answers at I2C address 0x68")
        .said("→ unplug the board and look at the wires")
        .said("Next: unplug the board and look at the wires");
    }

    #[test]
    fn a_clone_without_magnetometer_works_and_is_known() {
        look_at(|image| {
            let mut setup = still();
            setup.part = Part::perfect().who_am_i(0x70);
            Board::new(image, setup)
        })
        .expect(0)
        .said("! no magnetometer");
    }

    #[test]
    fn a_part_within_its_data_sheet_is_to_be_calibrated() {
        look_at(|image| {
            let mut setup = still();
            setup.part = Part::worst(3);
            Board::new(image, setup)
        })
        .expect(0)
        .said("! at rest the accelerometer reads")
        .said("`vrduino calibrate` makes up for it");
    }

    #[test]
    fn a_broken_part_is_told_from_one_within_its_data_sheet() {
        look_at(|image| {
            let mut setup = still();
            setup.part.accel.bias[1] = 0.2;
            Board::new(image, setup)
        })
        .expect(1)
        .said("✗ at rest the accelerometer reads 11.77 m/s²");
    }

    #[test]
    fn a_port_that_another_program_has_is_told_with_its_name() {
        let Pty { device, path } = Pty::open();
        let held = std::fs::File::open(&path).expect("opens");
        let ended = vrduino(&["doctor", "--port", &path]);
        drop((held, device));
        ended.expect(1);
        if cfg!(target_os = "linux") {
            let us = format!("(process {})", std::process::id());
            ended.said("is in use by").said(&us);
        }
    }

    /// Says this again and again, and reads nothing.
    fn stranger(line: &'static [u8]) -> Ended {
        let Pty { mut device, path } = Pty::open();
        let wanted = Arc::new(AtomicBool::new(true));
        let flag = Arc::clone(&wanted);
        let talker = thread::spawn(move || {
            while flag.load(Ordering::Relaxed) {
                let _ = device.write(line);
                let _ = device.read(&mut [0; 64]);
                thread::sleep(Duration::from_millis(10));
            }
        });
        let ended = vrduino(&["doctor", "--port", &path]);
        wanted.store(false, Ordering::Relaxed);
        talker.join().expect("talked");
        ended
    }

    #[test]
    fn the_courses_own_program_is_known_by_its_lines() {
        stranger(b"QC 0.707 0.000 0.707 0.000\n")
            .expect(0)
            .said("! its program sends the course's lines");
    }

    #[test]
    fn another_program_is_quoted() {
        stranger(b"T=21.5 degC\r\n")
            .expect(1)
            .said("✗ nothing of the tracker's runs there; it says `T=21.5 degC`")
            .said("vrduino flash");
    }

    #[test]
    fn silence_is_told_from_another_program() {
        stranger(b"").expect(1).said("✗ it says nothing");
    }
}
