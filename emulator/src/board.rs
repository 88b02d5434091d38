//! A whole board that runs: processor and chip in step, resets, and what happened on the way.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};

use crate::chip::Chip;
use crate::cpu::{Cpu, PeripheralBus};
use crate::image::Image;
use crate::motion::Motion;
use crate::mpu9250::Mpu9250;
use crate::peripherals::rcm::Cause;
use crate::time::{self, SECOND, Ticks};
use crate::witness::{Offence, Stop, Trap};

/// How the board is put together.
pub struct Setup {
    /// What the sensor experiences, from power-on.
    pub motion: Box<dyn Motion>,
    /// The sensor's identity: 0x71 is an MPU-9250.
    pub who_am_i: u8,
    /// Relative error of the sensor's oscillator (specification: within ±1 %).
    pub sensor_clock_error: f64,
    /// Traps that do not stop the run: the board goes on as silicon would.
    pub allowed: Vec<Trap>,
}

impl Setup {
    /// A board with a perfect MPU-9250 moved by `motion`; every trap stops it.
    pub fn new(motion: Box<dyn Motion>) -> Setup {
        Setup {
            motion,
            who_am_i: 0x71,
            sensor_clock_error: 0.0,
            allowed: Vec::new(),
        }
    }

    /// The same board, which goes on as silicon would after stepping into one of these traps.
    pub fn allowing(mut self, traps: &[Trap]) -> Setup {
        self.allowed.extend(traps);
        self
    }
}

/// Something worth telling, with the time it happened at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Event {
    /// When.
    pub at: Ticks,
    /// What, in a sentence.
    pub what: String,
}

impl std::fmt::Display for Event {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:9.4} s  {}", time::seconds(self.at), self.what)
    }
}

/// What the processor and the chip share: the processor holds its own lock while it reaches for a register.
#[derive(Debug)]
struct Shared {
    chip: Mutex<Chip>,
    now: AtomicU64,
    /// A register was touched, so events and interrupts have to be looked at again.
    touched: AtomicBool,
}

impl Shared {
    fn chip(&self) -> MutexGuard<'_, Chip> {
        let mut chip = self
            .chip
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        chip.now = self.now.load(Ordering::Relaxed);
        chip
    }
}

impl PeripheralBus for Shared {
    fn read(&self, address: u32, width: u8) -> Option<u32> {
        self.touched.store(true, Ordering::Relaxed);
        self.chip().read(address, width)
    }

    fn write(&self, address: u32, width: u8, value: u32) -> bool {
        self.touched.store(true, Ordering::Relaxed);
        self.chip().write(address, width, value)
    }
}

/// The board.
#[derive(Debug)]
pub struct Board {
    cpu: Cpu,
    shared: Arc<Shared>,
    image: Image,
    now: Ticks,
    /// Remainder of the conversion from cycles to ticks, in ticks × hertz.
    remainder: u64,
    core_hz: u32,
    next_event: Ticks,
    /// Interrupt requests as the processor has them, one bit each.
    asserted: u128,
    flash_hidden: bool,
    asleep: bool,
    awake_for: Ticks,
    instructions: u64,
    resets: u32,
    events: Vec<Event>,
    allowed: Vec<Trap>,
    stop: Option<Stop>,
    /// Address of the instruction that is being executed, or was last.
    pc: u32,
}

impl Board {
    /// A board at power-on with `image` in its flash.
    pub fn new(image: Image, setup: Setup) -> Board {
        let sensor = Mpu9250::new(setup.motion, setup.who_am_i, setup.sensor_clock_error);
        let chip = Chip::new(sensor, &image.flash);
        let ram = chip.ram.clone();
        let core_hz = chip.core_hz();
        let shared = Arc::new(Shared {
            chip: Mutex::new(chip),
            now: AtomicU64::new(0),
            touched: AtomicBool::new(true),
        });
        let cpu = Cpu::new(
            &image.flash,
            &ram,
            Arc::clone(&shared) as Arc<dyn PeripheralBus>,
        );
        Board {
            cpu,
            shared,
            image,
            now: 0,
            remainder: 0,
            core_hz,
            next_event: 0,
            asserted: 0,
            flash_hidden: false,
            asleep: false,
            awake_for: 0,
            instructions: 0,
            resets: 0,
            events: Vec::new(),
            allowed: setup.allowed,
            stop: None,
            pc: 0,
        }
    }

    /// Runs for `span`, or a little longer: the last instruction is finished. A board that has stopped
    /// ([`Board::stop`]) does not run any more.
    pub fn run(&mut self, span: Ticks) {
        let until = self.now.saturating_add(span);
        while self.now < until && self.stop.is_none() {
            if self.now >= self.next_event || self.shared.touched.load(Ordering::Relaxed) {
                self.service();
            }
            if self.asleep {
                self.sleep(until);
            } else {
                self.step();
            }
        }
    }

    fn step(&mut self) {
        self.pc = self.cpu.pc();
        let cycles = self.cpu.step();
        self.instructions += 1;
        let ticks = self.pass(cycles);
        self.awake_for += ticks;
        if self.cpu.is_asleep() {
            self.asleep = true;
        } else if self.cpu.is_locked_up() {
            self.reset(
                Cause::Lockup,
                "the processor locked up: a fault within a fault handler",
            );
        } else if self.cpu.wants_reset() {
            self.reset(Cause::Software, "the program asked for it (SYSRESETREQ)");
        }
    }

    /// Sleeps until something happens; one idle step lets the processor look at its interrupts.
    fn sleep(&mut self, until: Ticks) {
        let cycles = self.cpu.step();
        self.pass(cycles);
        if !self.cpu.is_asleep() {
            self.asleep = false;
            return;
        }
        let wake = self.next_event.min(until);
        let Some(span) = wake.checked_sub(self.now).filter(|&span| span > 0) else {
            return;
        };
        let cycles =
            (u128::from(span) * u128::from(self.core_hz)).div_ceil(u128::from(SECOND)) as u64;
        let cycles = cycles
            .min(self.cpu.cycles_to_systick().unwrap_or(u64::MAX))
            .max(1);
        self.cpu.sleep(cycles);
        self.pass(cycles);
    }

    /// Lets `cycles` of the core pass; returns the ticks they took.
    fn pass(&mut self, cycles: u64) -> Ticks {
        let scaled = cycles * SECOND + self.remainder;
        let hz = u64::from(self.core_hz);
        let ticks = scaled / hz;
        self.remainder = scaled % hz;
        self.now += ticks;
        self.shared.now.store(self.now, Ordering::Relaxed);
        ticks
    }

    /// Lets the chip do what is due and carries its interrupts to the processor.
    fn service(&mut self) {
        self.shared.touched.store(false, Ordering::Relaxed);
        let shared = Arc::clone(&self.shared);
        let mut chip = shared.chip();
        chip.advance();
        let offences = chip.witness.take();
        let reset = chip.reset_wanted.take();
        if !offences.is_empty() {
            drop(chip);
            self.judge(offences);
            chip = shared.chip();
        }
        if let Some((cause, why)) = reset {
            drop(chip);
            self.reset(cause, why);
            return;
        }
        let lines = chip.interrupts();
        let mut changed = lines ^ std::mem::replace(&mut self.asserted, lines);
        while changed != 0 {
            let number = changed.trailing_zeros();
            self.cpu.set_irq(number as u16, lines >> number & 1 != 0);
            changed &= changed - 1;
        }
        let hidden = chip.flash.hides_flash();
        if hidden != std::mem::replace(&mut self.flash_hidden, hidden) {
            self.cpu
                .show_flash((!hidden).then_some(&chip.flash.memory.program));
        }
        let core_hz = chip.core_hz();
        if core_hz != self.core_hz {
            self.core_hz = core_hz;
            self.remainder = 0;
        }
        self.next_event = chip.next_event();
    }

    /// Stops at the first offence that is not allowed; the others become events.
    fn judge(&mut self, offences: Vec<Offence>) {
        let place = self.place_of(self.pc);
        for Offence { trap, what } in offences {
            if self.allowed.contains(&trap) {
                let what = format!("{trap}: {what}; at {place}");
                self.events.push(Event { at: self.now, what });
            } else {
                self.stop.get_or_insert(Stop {
                    trap,
                    what,
                    at: self.now,
                    pc: self.pc,
                    place: place.clone(),
                });
            }
        }
    }

    /// Why the board runs no more, if it stepped into a trap that was not allowed.
    pub fn stop(&self) -> Option<&Stop> {
        self.stop.as_ref()
    }

    fn reset(&mut self, cause: Cause, why: &str) {
        let by = match cause {
            Cause::Watchdog => "the watchdog resets the chip: ",
            _ => "the chip is reset: ",
        };
        let what = format!("{by}{why}; the program was at {}", self.place_of(self.pc));
        self.events.push(Event { at: self.now, what });
        self.resets += 1;
        let mut chip = self.shared.chip();
        chip.reset(cause);
        self.core_hz = chip.core_hz();
        drop(chip);
        self.cpu.reset();
        self.remainder = 0;
        self.next_event = self.now;
        self.asserted = 0;
        self.asleep = false;
    }

    /// An address for people.
    fn place_of(&self, pc: u32) -> String {
        match self.image.symbol_at(pc) {
            Some((name, offset)) => format!("{pc:#010x} ({name} + {offset:#x})"),
            None => format!("{pc:#010x}"),
        }
    }

    /// The chip and what is connected to it.
    pub fn chip(&mut self) -> MutexGuard<'_, Chip> {
        // The caller may change anything, so everything is looked at again.
        self.shared.touched.store(true, Ordering::Relaxed);
        self.next_event = self.now;
        self.shared.chip()
    }

    /// The chip, by somebody who only talks to its host: nothing has to be looked at again before its
    /// next event, which is a frame away at most.
    pub fn chip_quietly(&mut self) -> MutexGuard<'_, Chip> {
        self.shared.chip()
    }

    /// Makes the program continue at `address`, awake.
    pub fn jump(&mut self, address: u32) {
        self.cpu.set_pc(address & !1);
        self.asleep = false;
    }

    /// The image in flash.
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// The present moment.
    pub fn now(&self) -> Ticks {
        self.now
    }

    /// Time during which the processor did not sleep.
    pub fn awake_for(&self) -> Ticks {
        self.awake_for
    }

    /// Instructions and exception entries executed.
    pub fn instructions(&self) -> u64 {
        self.instructions
    }

    /// Resets since power-on.
    pub fn resets(&self) -> u32 {
        self.resets
    }

    /// Takes what happened since the last call.
    pub fn take_events(&mut self) -> Vec<Event> {
        std::mem::take(&mut self.events)
    }

    /// Reads the 32-bit variable whose symbol ends in `path`, such as `vrduino_dropped_lines`.
    pub fn variable(&self, path: &str) -> Option<u32> {
        let address = self.image.address_of(path)?;
        self.shared.chip().ram.word(address)
    }
}
