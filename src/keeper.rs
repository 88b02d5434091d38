//! Keeps calibrations and shows them: for `tests/boot/store.rs`, which cuts its power. Not for a tracker.
//!
//! A digit keeps a record of that number, `b` shows the bytes of the record that was found at start, and
//! `r` what sampling has counted.

#![no_std]
#![no_main]
#![deny(unsafe_code)]

mod board;

use core::convert::Infallible;
use core::fmt;

use board::{Board, Fault};
use panic_halt as _; // as on the tracker
use vrduino::calibration::ellipsoid::Magnetometer;
use vrduino::calibration::record::{Gyro, Record};
use vrduino::calibration::six_positions::Accelerometer;
use vrduino::command::{Command, Mode};
use vrduino::units::{Angle, AngularRate, MagneticField, SpecificForce};
use vrduino::wire;

#[cortex_m_rt::entry]
fn main() -> ! {
    let mut board = Board::take();
    let found = board.load_calibration();
    loop {
        let Err(fault) = sample(&mut board, found);
        board.report(fault);
        board.wait(1000);
    }
}

/// Samples, and does what is typed.
fn sample(board: &mut Board, found: Option<Record>) -> Result<Infallible, Fault> {
    board.start_imu()?;
    let (mut samples, mut repeated) = (0u32, 0u32);
    loop {
        let (sample, _) = board.next_sample()?;
        samples += 1;
        repeated += u32::from(!sample.fresh);
        while let Some(command) = board.usb.command() {
            match command {
                Command::Mode(mode) => keep(board, mode),
                Command::MeasureBias => show(board, found),
                Command::Reset => {
                    let overruns = board.health().overruns;
                    board.usb.send(&wire::text(format_args!(
                        "{samples} samples, {repeated} repeated, {overruns} overruns"
                    )));
                }
                Command::Line(_) => {}
            }
        }
        board.end_of_turn();
    }
}

fn keep(board: &mut Board, mode: Mode) {
    if let Err(error) = board.keep_calibration(&record(mode)) {
        board
            .usb
            .send(&wire::text(format_args!("not begun: {error}")));
    }
}

fn show(board: &mut Board, found: Option<Record>) {
    let Some(record) = found else {
        board.usb.send(&wire::text("found nothing"));
        return;
    };
    for bytes in record.to_bytes().chunks(35) {
        board
            .usb
            .send(&wire::text(format_args!("found {}", Hex(bytes))));
    }
}

struct Hex<'a>(&'a [u8]);

impl fmt::Display for Hex<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// A record in which every value is another for each mode.
fn record(mode: Mode) -> Record {
    let n = mode as u8 as f32;
    let three = |first: f32| [first + n, first + n + 0.25, first + n + 0.5].into();
    Record {
        gyro: Some(Gyro {
            bias: AngularRate::from_rad_per_s(three(1.0)),
            temperature_celsius: 20.0 + n,
        }),
        accelerometer: Some(Accelerometer {
            bias: SpecificForce::from_m_per_s2(three(2.0)),
            matrix: nalgebra::Matrix3::from_fn(|row, column| (3 * row + column) as f32 + n),
            residual: 3.0 + n,
            placing: Angle::from_rad(4.0 + n),
            temperature_celsius: 21.0 + n,
        }),
        magnetometer: Some(Magnetometer {
            hard_iron: MagneticField::from_microtesla(three(5.0)),
            soft_iron: nalgebra::Matrix3::from_fn(|row, column| (row + column) as f32 + n),
            strength_microtesla: 50.0 + n,
            error_percent: 1.0 + n,
            coverage: 0.5 + n,
            largest_hole: Angle::from_rad(0.25 + n),
            temperature_celsius: 22.0 + n,
        }),
    }
}
