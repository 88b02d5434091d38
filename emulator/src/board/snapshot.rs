//! Copies of a running board, and its fingerprint.

use std::fmt::Write;
use std::sync::Arc;

use super::watch::Watch;
use super::{Board, Shared};
use crate::cpu::PeripheralBus;
use crate::hash::Fnv1a;

/// A board at one moment, to go on from as often as one likes: a fault campaign boots once.
///
/// ```no_run
/// # use vrduino_emulator::{board::{Board, Setup}, image::Image, motion, time::MILLISECOND};
/// # fn example(mut board: Board) {
/// board.run(1500 * MILLISECOND);
/// let booted = board.snapshot();
/// for moment in 0..100 {
///     let mut board = booted.board();
///     board.run(moment * MILLISECOND);
///     board.chip().pins.sda_held_for = 5;
///     board.run(1000 * MILLISECOND);
/// }
/// # }
/// ```
#[derive(Debug)]
pub struct Snapshot(Board);

impl Snapshot {
    /// A board that goes on from the moment of the snapshot.
    pub fn board(&self) -> Board {
        self.0.fork()
    }
}

impl Board {
    /// The board as it is now. The motion is shared with it, everything else is copied.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot(self.fork())
    }

    /// Goes back, or forward, to the moment of the snapshot.
    pub fn resume(&mut self, snapshot: &Snapshot) {
        *self = snapshot.board();
    }

    fn fork(&self) -> Board {
        let chip = self.shared.chip().fork();
        let (ram, flash) = (chip.ram.clone(), chip.flash.memory.program.clone());
        let hidden = self.flash_hidden;
        let shared = Arc::new(Shared::new(chip));
        shared.set_now(self.now);
        if !self.shared.is_touched() {
            shared.look();
        }
        let mut cpu = self
            .cpu
            .fork(&flash, &ram, Arc::clone(&shared) as Arc<dyn PeripheralBus>);
        if hidden {
            cpu.show_flash(None);
        }
        Board {
            cpu,
            shared,
            image: self.image.clone(),
            now: self.now,
            remainder: self.remainder,
            core_hz: self.core_hz,
            flash_ratio: self.flash_ratio,
            next_event: self.next_event,
            asserted: self.asserted,
            flash_hidden: self.flash_hidden,
            loader: self.loader,
            instructions: self.instructions,
            last_access: self.last_access,
            resets: self.resets,
            events: self.events.clone(),
            pace: self.pace,
            allowed: self.allowed.clone(),
            stop: self.stop.clone(),
            pc: self.pc,
            measure: self.measure.clone(),
            storm: self.storm,
            active: self.active.clone(),
            polling: self.polling.clone(),
            watch: Watch::default(),
            stack_limit: self.stack_limit,
            latencies: self.latencies.clone(),
            taken: self.taken.clone(),
            armed: self.armed,
            usb_table: self.usb_table,
            profile: self.profile.clone(),
            began: self.began,
        }
    }

    /// A fingerprint of everything that can influence what happens from now on: registers and system registers,
    /// memories, the state of every peripheral, of the sensor and of the host, and the time. Two runs with the same
    /// image, motion and settings have the same one at every moment.
    ///
    /// The models are taken in as their `Debug` text, which derives from all of their fields: none can be forgotten,
    /// and it is the same on every machine.
    pub fn state_hash(&self) -> u64 {
        let mut hash = Fnv1a::new();
        self.cpu.hash_into(&mut hash);
        let stopped = self.stop.as_ref().map(|stop| stop.trap);
        // Writing to a hash cannot fail.
        let _ = write!(
            hash,
            "{} {} {} {} {:?} {} {:?} {} {stopped:?} {:?}",
            self.now,
            self.remainder,
            self.core_hz,
            self.flash_ratio,
            self.asserted,
            self.resets,
            self.storm,
            self.measure.stack_low,
            self.shared.chip()
        );
        hash.value()
    }
}
