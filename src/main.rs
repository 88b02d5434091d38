//! The program on the board: a thousand samples a second, an orientation to the host a hundred times
//! a second.
//!
//! An alarm starts each burst just behind the sensor's data-ready, and DMA carries it in; the filter runs
//! here, and here the core sleeps when there is nothing to do. A line goes to the USB controller in the turn
//! that makes it. USB has an interrupt of its own, below the sensor's and above the filter, so neither a
//! slow host nor a busy filter delays a sample. The watchdog is fed only after a sample has come in and
//! gone through the filter.

#![no_std]
#![no_main]
#![deny(unsafe_code)]

mod board;

use core::convert::Infallible;

use board::breadcrumb::{self, Stage};
use board::multiply::Instructions;
use board::{Board, Fault};
use panic_halt as _; // a panic stops the core; the watchdog restarts it and the breadcrumb tells
use vrduino::command::Command;
use vrduino::imu::RANGES;
use vrduino::tracker::Tracker;

/// How long to wait before looking for a lost sensor again.
const RETRY_MS: u32 = 1000;

#[cortex_m_rt::entry]
fn main() -> ! {
    let mut board = Board::take();
    let mut tracker = Tracker::<Instructions>::with(RANGES);
    if let Some(record) = board.load_calibration() {
        tracker.set_calibration(&record);
    }
    loop {
        let Err(fault) = track(&mut board, &mut tracker);
        board.report(fault);
        board.wait(RETRY_MS);
    }
}

/// Tracks until the sensor is lost.
fn track(board: &mut Board, tracker: &mut Tracker<Instructions>) -> Result<Infallible, Fault> {
    let adjustment = board.start_imu()?;
    tracker.set_magnetometer(adjustment);
    tracker.resume();
    loop {
        turn(board, tracker)?;
    }
}

/// One for each sample of the sensor, a thousand a second; one that comes late finds its sample in a queue and catches
/// up.
#[inline(never)] // in SRAM, see memory.x
fn turn(board: &mut Board, tracker: &mut Tracker<Instructions>) -> Result<(), Fault> {
    let field = board.next_sample()?;
    if let Some(command) = board.usb.command() {
        obey(board, tracker, command);
    }
    breadcrumb::mark(Stage::Filter);
    let health = board.health();
    tracker.timed(&board.imu.timing);
    let sample = &board.imu.sample;
    let frame = tracker.update(sample, field, &health, &mut |line| board.usb.send(line));
    if let Some(frame) = frame {
        board.usb.send(&frame);
    }
    board.end_of_turn();
    Ok(())
}

/// One in a turn: so its answer has gone before the next is made.
#[cold]
#[inline(never)]
fn obey(board: &mut Board, tracker: &mut Tracker<Instructions>, command: Command) {
    tracker.command(command, &mut |line| board.usb.send(line));
    board.lock_on(tracker.lock());
    board.run_at(tracker.core());
    if let Some(record) = tracker.take_calibration_to_keep() {
        board.keep_calibration(&record);
    }
}
