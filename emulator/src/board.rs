//! A whole board that runs: processor and chip in step, resets, and what happened on the way.

pub mod debug;

pub mod figures;

mod judgement;

pub mod latency;

mod loader;

pub mod measure;

mod passing;

mod polling;

pub mod profile;

pub mod setup;

mod shared;

mod snapshot;

pub mod watch;

use std::sync::{Arc, MutexGuard};

use crate::chip::{Chip, INTERRUPTS};
use crate::cpu::op::Access;
use crate::cpu::timing::Cycles;
use crate::cpu::{Cpu, Pace, PeripheralBus, RAM_BASE};
use crate::image::Image;
use crate::journal::Happening;
use crate::mpu9250::Mpu9250;
use crate::peripherals::ftfl::Eeprom;
use crate::peripherals::rcm::Cause;
use crate::time::Ticks;
use crate::witness::{Stop, Trap};
pub use judgement::Event;
use judgement::Storm;
use latency::Latencies;
use measure::{Measure, Moment};
use polling::Polling;
use profile::Profile;
pub use setup::Setup;
use shared::Shared;
pub use snapshot::Snapshot;
use watch::Watch;

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
    /// The core clock over the flash clock.
    flash_ratio: u32,
    next_event: Ticks,
    /// Interrupt requests as the processor has them, one bit each.
    asserted: u128,
    flash_hidden: bool,
    instructions: u64,
    /// What the last instruction reached for.
    last_access: Option<Access>,
    resets: u32,
    events: Vec<Event>,
    pace: Pace,
    allowed: Vec<Trap>,
    stop: Option<Stop>,
    /// Since when the board is in its loader.
    loader: Option<Ticks>,
    /// Address of the instruction that is being executed, or was last.
    pc: u32,
    measure: Measure,
    storm: Storm,
    /// Exceptions whose handlers have begun and not ended, the running one last.
    active: Vec<u16>,
    polling: Option<Polling>,
    watch: Watch,
    /// Where the image's variables end: below this the stack must not grow.
    stack_limit: u32,
    latencies: Latencies,
    /// The same to the moment at which the host begins to take the packet.
    taken: Latencies,
    /// When the sample was ready that the packet at its endpoint holds.
    armed: Option<Ticks>,
    /// Where the USB controller looks for its buffer descriptors.
    usb_table: u32,
    profile: Option<Profile>,
    /// Where the figures begin: the moment, the time awake and the time the bus was in use until then.
    began: (Ticks, Cycles, Ticks),
}

impl Board {
    /// A board at power-on with `image` in its flash.
    pub fn new(image: Image, setup: Setup) -> Board {
        let sensor = Mpu9250::new(Arc::from(setup.motion), setup.part);
        let chip = Chip::new(sensor, &image.flash, &setup.eeprom);
        let ram = chip.ram.clone();
        let core_hz = chip.core_hz();
        let shared = Arc::new(Shared::new(chip));
        let cpu = Cpu::new(
            &image.flash,
            &ram,
            Arc::clone(&shared) as Arc<dyn PeripheralBus>,
            setup.pace,
        );
        let timed = image.address_of(&setup.timed_function);
        let stack_limit = image.data_end();
        Board {
            cpu,
            shared,
            image,
            now: 0,
            remainder: 0,
            core_hz,
            flash_ratio: 1,
            next_event: 0,
            asserted: 0,
            flash_hidden: false,
            instructions: 0,
            last_access: None,
            resets: 0,
            events: Vec::new(),
            pace: setup.pace,
            allowed: setup.allowed,
            stop: None,
            loader: None,
            pc: 0,
            measure: Measure::new(timed),
            storm: Storm::default(),
            active: Vec::new(),
            polling: setup.skip_polling.then(Polling::default),
            watch: Watch::default(),
            stack_limit,
            latencies: Latencies::default(),
            taken: Latencies::default(),
            armed: None,
            usb_table: 0,
            profile: None,
            began: (0, Cycles::default(), 0),
        }
    }

    /// Runs for `span`, or a little longer: the last instruction is finished. A board that has stopped
    /// ([`Board::stop`]) does not run any more.
    pub fn run(&mut self, span: Ticks) {
        let until = self.now.saturating_add(span);
        if self.loader.is_some() {
            self.now = until;
            self.shared.set_now(until);
            return;
        }
        while self.now < until && self.stop.is_none() && self.loader.is_none() {
            self.advance(until);
        }
    }

    /// One instruction, or a piece of sleep that does not go beyond `until`.
    fn advance(&mut self, until: Ticks) {
        let due = self.now >= self.next_event;
        if due && let Some(polling) = &mut self.polling {
            polling.forget();
        }
        if due || self.shared.is_touched() {
            self.service();
        }
        let before = self.watch.is_on().then(|| self.watched());
        if self.cpu.is_asleep() {
            self.sleep(until);
        } else {
            self.step(until);
        }
        if let Some(before) = before {
            self.tell_changes(before);
        }
    }

    fn step(&mut self, until: Ticks) {
        let (exception, stack) = (self.cpu.exception(), self.cpu.stack_pointer());
        self.pc = self.cpu.pc();
        let step = self.cpu.step(self.flash_ratio);
        self.instructions += 1;
        self.last_access = step.access;
        self.pass(self.pace.of(step.cycles));
        self.measure.awake(step.cycles, self.core_hz);
        if let Some(profile) = &mut self.profile {
            profile.note(self.pc, step.cycles);
        }
        if let Some(access) = step.access.filter(|access| access.store) {
            self.follow_sample(access.address);
        }
        let moment = Moment {
            pc: self.pc,
            exception,
            stack,
            link: self.cpu.registers_before().0[14],
            next: self.cpu.pc(),
            next_stack: self.cpu.stack_pointer(),
        };
        self.measure.follow(&moment, step.cycles);
        if exception == 0 {
            self.storm.entries = 0;
        }
        if step.moved_stack && moment.next_stack < self.stack_limit {
            // A stack among the variables, on purpose: nobody knows where it ends.
            self.stack_limit = 0;
        }
        if moment.next_stack < self.measure.stack_low && moment.next_stack >= RAM_BASE {
            self.lower_stack(moment.next_stack);
        }
        let now_in = self.cpu.exception();
        if now_in != exception {
            self.change_exception(now_in, moment.next_stack < stack);
        } else if now_in >= 16 && moment.next == self.storm.handler && self.tail_chained() {
            self.enter(now_in);
        } else {
            self.look_for_polling(&step, until);
        }
        if let Some(fault) = self.cpu.take_fault() {
            self.take_fault(fault);
        }
        if self.cpu.is_locked_up() {
            self.reset(
                Cause::Lockup,
                "the processor locked up: a fault within a fault handler",
            );
        } else if step.access.is_some_and(|access| access.address == AIRCR)
            && self.cpu.wants_reset()
        {
            self.reset(Cause::Software, "the program asked for it (SYSRESETREQ)");
        }
    }

    /// The program has stored something at `address`: a packet with the sample that it fetched last?
    fn follow_sample(&mut self, address: u32) {
        if address & !0x1FF != self.usb_table {
            return;
        }
        let mut chip = self.shared.chip();
        if chip.usb.is_armed_by(address, &chip.ram)
            && let Some(ready) = chip.sensor.take_fetched()
        {
            self.latencies.push(self.now - ready);
            self.armed = Some(ready);
        }
    }

    /// The processor has gone to another exception: into one, which pushes a frame or chains it to the end of the one
    /// before, or back. The stack does not tell a chain from a return, for a handler may end in popping registers.
    fn change_exception(&mut self, to: u16, pushed: bool) {
        if let Some(polling) = &mut self.polling {
            polling.disturb();
        }
        if !pushed {
            self.active.pop();
        }
        if to != 0 && self.active.last() != Some(&to) {
            self.active.push(to);
            self.enter(to);
        }
    }

    /// Whether the processor, back at the first instruction of its handler, has come there by returning from it.
    fn tail_chained(&self) -> bool {
        const EXC_RETURN: u32 = 0xFFFF_FFE0;
        self.cpu.registers().0[14] >= EXC_RETURN && self.pc != self.cpu.pc()
    }

    /// Lets the chip do what is due and carries its interrupts to the processor.
    fn service(&mut self) {
        self.shared.look();
        let shared = Arc::clone(&self.shared);
        let mut chip = shared.chip();
        chip.advance();
        if chip.usb.take_gone()
            && let Some(ready) = self.armed.take()
        {
            self.taken.push(self.now - ready);
        }
        if !chip.witness.is_empty() {
            let offences = chip.witness.take();
            drop(chip);
            self.judge(offences);
            chip = shared.chip();
        }
        if let Some((cause, why)) = chip.reset_wanted.take() {
            drop(chip);
            self.reset(cause, why);
            return;
        }
        let lines = chip.interrupts();
        let changed = lines ^ std::mem::replace(&mut self.asserted, lines);
        if changed != 0 {
            for (index, number) in INTERRUPTS.into_iter().enumerate() {
                if changed >> number & 1 != 0 {
                    let level = lines >> number & 1 != 0;
                    self.measure.line(index, level, self.now);
                    self.cpu.set_irq(number, level);
                }
            }
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
        self.flash_ratio = chip.flash_ratio();
        self.next_event = chip.next_event();
        self.usb_table = chip.usb.table();
    }

    fn reset(&mut self, cause: Cause, why: &str) {
        let by = match cause {
            Cause::Watchdog => "the watchdog resets the chip: ",
            _ => "the chip is reset: ",
        };
        let place = self.place_of(self.pc);
        let what = format!("{by}{why}; the program was at {place}");
        self.tell(what);
        self.resets += 1;
        let mut chip = self.shared.chip();
        chip.reset(cause);
        self.core_hz = chip.core_hz();
        self.flash_ratio = chip.flash_ratio();
        // The reset has ended the command that hid it.
        if std::mem::take(&mut self.flash_hidden) {
            self.cpu.show_flash(Some(&chip.flash.memory.program));
        }
        drop(chip);
        self.cpu.reset();
        self.tell_watchers(Some(Happening::Reset));
        self.remainder = 0;
        self.next_event = self.now;
        self.asserted = 0;
        self.measure.reset();
        self.storm = Storm::default();
        self.active.clear();
        if let Some(polling) = &mut self.polling {
            polling.disturb();
        }
    }

    /// The chip and what is connected to it.
    pub fn chip(&mut self) -> MutexGuard<'_, Chip> {
        // The caller may change anything, so everything is looked at again.
        self.shared.touch();
        self.next_event = self.now;
        self.shared.chip()
    }

    /// The chip, by somebody who only talks to its host: nothing has to be looked at again before its
    /// next event, which is a frame away at most.
    pub fn chip_quietly(&mut self) -> MutexGuard<'_, Chip> {
        self.shared.chip()
    }

    /// What the EEPROM would hold if power failed now, to be given to the next board.
    pub fn eeprom(&self) -> Eeprom {
        self.shared.chip().flash.eeprom()
    }

    /// Makes the program continue at `address`, awake.
    pub fn jump(&mut self, address: u32) {
        self.cpu.set_pc(address & !1);
    }

    /// The image in flash.
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// The present moment.
    pub fn now(&self) -> Ticks {
        self.now
    }

    /// How long samples were on their way.
    pub fn latencies(&self) -> &Latencies {
        &self.latencies
    }

    /// What the run is measured by.
    pub fn measure(&self) -> &Measure {
        &self.measure
    }

    /// Instructions and exception entries executed.
    pub fn instructions(&self) -> u64 {
        self.instructions
    }

    /// Resets since power-on.
    pub fn resets(&self) -> u32 {
        self.resets
    }

    /// Reads the 32-bit variable whose symbol ends in `path`, such as `vrduino_dropped_lines`.
    pub fn variable(&self, path: &str) -> Option<u32> {
        let address = self.image.address_of(path)?;
        self.shared.chip().ram.word(address)
    }
}

/// Application interrupt and reset control register (ARMv7-M, B3.2.6).
const AIRCR: u32 = 0xE000_ED0C;
