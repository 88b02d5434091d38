//! What goes wrong is said on the stream, and never stops the board.

use vrduino_emulator::board::Setup;
use vrduino_emulator::motion::turns::Turns;
use vrduino_emulator::witness::Trap;

use crate::run::{Run, degrees_between};

#[test]
fn a_missing_sensor_is_reported_and_found_once_it_is_there() {
    let mut run = Run::still();
    run.board.chip().sensor.faults.absent = true;
    run.wait_for("error: no IMU answers at I2C address 0x68", 3.0);
    assert!(run.orientations.is_empty());
    run.board.chip().sensor.faults.absent = false;
    run.wait_for("QC ", 4.0);
    assert_eq!(run.board.resets(), 0);
}

#[test]
fn an_unknown_part_is_named() {
    let mut setup = Setup::new(Box::new(Turns::new(1e6, 0.0)));
    setup.part = setup.part.who_am_i(0x68);
    let mut run = Run::with(setup);
    run.wait_for("error: unknown part 0x68", 2.0);
    run.seconds(2.0);
    assert!(run.orientations.is_empty());
    assert_eq!(run.board.resets(), 0);
}

#[test]
fn parts_of_the_same_family_are_accepted() {
    for who_am_i in [0x70, 0x73] {
        let mut setup = Setup::new(Box::new(Turns::new(1e6, 0.0)));
        setup.part = setup.part.who_am_i(who_am_i);
        Run::with(setup).wait_for("QC ", 2.0);
    }
}

#[test]
fn a_sensor_that_stops_answering_is_reported_and_taken_up_again() {
    let mut run = Run::still();
    run.seconds(1.5);
    run.board.chip().sensor.faults.absent = true;
    run.wait_for("error: the IMU stopped answering", 1.0);
    run.board.chip().sensor.faults.absent = false;
    run.forget();
    run.wait_for("QC ", 2.5);
    assert_eq!(run.board.resets(), 0);
}

#[test]
fn a_sensor_without_new_samples_is_reported() {
    let mut run = Run::still();
    run.seconds(1.5);
    run.board.chip().sensor.faults.frozen = true;
    run.wait_for("error: the IMU takes no new samples", 1.0);
    run.board.chip().sensor.faults.frozen = false;
    run.forget();
    run.wait_for("QC ", 2.5);
}

#[test]
fn a_sensor_that_lost_its_settings_is_set_up_again() {
    let mut run = Run::still();
    run.seconds(1.5);
    let now = run.board.now();
    run.board.chip().sensor.brown_out(now);
    run.wait_for("error: the IMU", 1.0);
    run.forget();
    run.wait_for("QC ", 2.5);
    assert!(degrees_between(run.last(), [1.0, 0.0, 0.0, 0.0]) < 1.0);
}

#[test]
fn a_bus_held_by_the_sensor_at_power_on_is_clocked_free() {
    let mut run = Run::still();
    run.board.chip().pins.sda_held_for = 7;
    run.wait_for("QC ", 3.0);
    assert!(!run.text.contains("error"), "{}", run.text);
}

#[test]
fn a_clock_line_held_low_is_reported_and_never_hangs_the_board() {
    let mut run = Run::still();
    run.seconds(1.5);
    run.board.chip().pins.scl_held = true;
    run.wait_for("error: ", 1.0);
    run.seconds(1.0);
    run.board.chip().pins.scl_held = false;
    run.forget();
    run.wait_for("QC ", 3.0);
    assert_eq!(run.board.resets(), 0);
}

#[test]
fn a_hang_becomes_a_watchdog_reset_and_the_next_life_says_where() {
    let still = Box::new(Turns::new(1e6, 0.0));
    let mut run = Run::with(Setup::new(still).allowing(&[Trap::WatchdogTimeout]));
    run.seconds(1.5);
    // An endless loop: the branch-to-self behind a hard fault will do.
    let address = run
        .board
        .image()
        .address_of("rust_begin_unwind")
        .expect("the panic handler is there");
    run.board.jump(address);
    run.wait_for("warning: reset by watchdog", 2.0);
    assert_eq!(run.board.resets(), 1);
    run.forget();
    run.wait_for("QC ", 3.0);
}
