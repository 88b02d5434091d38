//! The chip around the processor: which peripheral answers at which address, its clock gate, its interrupt, and what
//! the board connects to it.

mod analog;

mod bridge;

mod communication;

mod interrupts;

mod judgement;

mod registers;

mod slots;

mod timers;

mod transfers;

pub use analog::Analog;
pub use communication::Communication;
pub use interrupts::{INTERRUPTS, interrupt_name};
pub use slots::peripheral_at;
pub use timers::Timers;

use crate::cpu::Ram;
use crate::host::Host;
use crate::journal::Journal;
use crate::mpu9250::Mpu9250;
use crate::peripherals::crc::CrcGenerator;
use crate::peripherals::dma::Dma;
use crate::peripherals::dmamux::DmaMux;
use crate::peripherals::ftfl::{Eeprom, FlashController, Memory};
use crate::peripherals::i2c::I2c;
use crate::peripherals::mcg::ClockGenerator;
use crate::peripherals::mcm::MiscellaneousControl;
use crate::peripherals::pins::{self, Pins};
use crate::peripherals::pit::IntervalTimer;
use crate::peripherals::rcm::{Cause, ResetControl};
use crate::peripherals::register_file::RegisterFile;
use crate::peripherals::sim::SystemIntegration;
use crate::peripherals::smc::ModeController;
use crate::peripherals::tsi::TouchSensing;
use crate::peripherals::usbotg::UsbController;
use crate::peripherals::wdog::Watchdog;
use crate::time::{self, NEVER, Ticks};
use crate::witness::Witness;

/// Every peripheral, the sensor, and the host.
#[derive(Debug, Clone)]
pub struct Chip {
    /// The moment the processor is at.
    pub now: Ticks,
    /// SRAM, shared with the processor.
    pub ram: Ram,
    /// Pins and the sensor bus's wires.
    pub pins: Pins,
    /// The sensor bus.
    pub i2c: I2c,
    /// The USB device controller.
    pub usb: UsbController,
    /// The sensor.
    pub sensor: Mpu9250,
    /// The PC.
    pub host: Host,
    watchdog: Watchdog,
    watchdog_resets: u16,
    clocks: ClockGenerator,
    sim: SystemIntegration,
    arbitration: MiscellaneousControl,
    timer: IntervalTimer,
    /// When the clock generator's output may next change by itself.
    clock_change: Ticks,
    reset_control: ResetControl,
    /// The flash module with its memories.
    pub flash: FlashController,
    /// Converters and what is connected to them.
    pub analog: Analog,
    /// Timers beside the interval timer.
    pub timers: Timers,
    /// Serial interfaces beside USB and the sensor bus.
    pub communication: Communication,
    /// Touch sensing.
    pub touch: TouchSensing,
    modes: ModeController,
    crc: CrcGenerator,
    dma: Dma,
    dma_mux: DmaMux,
    dma_free_at: Ticks,
    /// The RTC's seconds interrupt is a pulse.
    second: bool,
    /// Register files that a system reset leaves alone.
    kept: RegisterFile,
    rest: RegisterFile,
    /// Why the chip has to be reset now.
    pub reset_wanted: Option<(Cause, &'static str)>,
    complaints_heard: usize,
    /// What the program did that silicon does not forgive.
    pub witness: Witness,
    /// What happens, for those who watch.
    pub journal: Journal,
}

impl Chip {
    /// The chip at power-on with `program` in its flash and `eeprom` in its EEPROM.
    pub fn new(sensor: Mpu9250, program: &[u8], eeprom: &Eeprom) -> Chip {
        let memory = Memory::new(program).with_eeprom(eeprom);
        let mut sim = SystemIntegration::new();
        sim.set_partition(memory.configuration());
        let clocks = ClockGenerator::new();
        let bus_hz = clocks.output_hz(0);
        Chip {
            now: 0,
            ram: Ram::new(),
            pins: Pins::default(),
            i2c: I2c::new(),
            usb: UsbController::new(),
            sensor,
            host: Host::new(),
            watchdog: Watchdog::new(0, bus_hz, 0),
            watchdog_resets: 0,
            clocks,
            sim,
            arbitration: MiscellaneousControl::default(),
            timer: IntervalTimer::new(),
            clock_change: 0,
            reset_control: ResetControl::new(Cause::PowerOn),
            flash: FlashController::new(memory, 0),
            analog: Analog::new(),
            timers: Timers::new(),
            communication: Communication::new(),
            touch: TouchSensing::new(),
            modes: ModeController::new(),
            crc: CrcGenerator::new(),
            dma: Dma::new(),
            dma_mux: DmaMux::default(),
            dma_free_at: 0,
            second: false,
            kept: RegisterFile::default(),
            rest: RegisterFile::default(),
            reset_wanted: None,
            complaints_heard: 0,
            witness: Witness::default(),
            journal: Journal::default(),
        }
    }

    /// A copy with a SRAM of its own.
    pub fn fork(&self) -> Chip {
        Chip {
            ram: self.ram.copy(),
            ..self.clone()
        }
    }

    /// A system reset: peripherals return to their reset state; SRAM, sensor and host live on.
    pub fn reset(&mut self, cause: Cause) {
        if cause == Cause::Watchdog {
            self.watchdog_resets = self.watchdog_resets.saturating_add(1);
        }
        self.clocks = ClockGenerator::new();
        self.clock_change = self.now;
        self.sim = SystemIntegration::new();
        self.watchdog = Watchdog::new(self.now, self.bus_hz(), self.watchdog_resets);
        self.pins.reset();
        self.i2c = I2c::new();
        self.usb.reset();
        self.arbitration = MiscellaneousControl::default();
        self.timer = IntervalTimer::new();
        self.reset_control = ResetControl::new(cause);
        self.flash.reset(self.now);
        self.sim.set_partition(self.flash.memory.configuration());
        self.analog.reset();
        self.timers.reset();
        self.communication.reset();
        self.touch.reset();
        self.modes = ModeController::new();
        self.crc = CrcGenerator::new();
        self.dma = Dma::new();
        self.dma_mux = DmaMux::default();
        self.rest = RegisterFile::default();
        self.reset_wanted = None;
    }

    /// The processor's clock.
    pub fn core_hz(&self) -> u32 {
        self.sim.divide(self.clocks.output_hz(self.now)).0
    }

    /// The core clock over the flash clock.
    pub fn flash_ratio(&self) -> u32 {
        let (core, _, flash) = self.sim.divide(self.clocks.output_hz(self.now));
        core.checked_div(flash).unwrap_or(1).max(1)
    }

    fn bus_hz(&self) -> u32 {
        self.sim.divide(self.clocks.output_hz(self.now)).1
    }

    fn usb_clocked(&self) -> bool {
        self.sim.gate(4, 18) && self.sim.usb_hz(self.clocks.pll_hz(self.now)) == Some(48_000_000)
    }

    /// When something happens next without the processor's doing.
    pub fn next_event(&self) -> Ticks {
        [
            self.watchdog.next_event(self.bus_hz()),
            self.clocks.next_event(self.now),
            self.timer.next_event(),
            self.i2c.next_event(),
            self.host.next_event(),
            self.flash.next_event(),
            self.analog.next_event(),
            self.timers.next_event(),
            self.communication.next_event(),
            self.touch.next_event(),
            self.next_transfer(),
            if self.second { self.now } else { NEVER },
        ]
        .into_iter()
        .min()
        .unwrap_or(NEVER)
    }

    /// Lets everything happen that is due at `self.now`.
    pub fn advance(&mut self) {
        let (now, bus_hz) = (self.now, self.bus_hz());
        if let Some(trap) = self.watchdog.expired(now, bus_hz) {
            self.watchdog_bites(trap);
        }
        if now >= self.clock_change {
            self.clock_change = self.clocks.next_event(now);
            self.judge_clocks();
        }
        self.timer.advance(now, bus_hz);
        self.advance_modules();
        let journal = &mut self.journal;
        let witness = &mut self.witness;
        self.i2c.advance(
            (now, bus_hz),
            &self.pins,
            &mut self.sensor,
            journal,
            witness,
        );
        self.hear_the_sensor();
        if now >= self.host.next_event() {
            let clocked = self.usb_clocked();
            self.host
                .advance(now, clocked, &mut self.usb, &self.ram, &mut self.witness);
            for (_, happening) in self.usb.journal.take() {
                self.journal.note(now, || happening);
            }
        }
    }

    fn advance_modules(&mut self) {
        let clocks = self.clocks();
        self.flash.advance(self.now);
        self.timers.advance(&clocks);
        self.second = self.timers.rtc.take_second();
        for (converter, trigger) in self.timers.delay.advance(self.now) {
            self.analog.converters[converter].trigger(trigger, &clocks);
        }
        self.analog.advance(&clocks);
        self.communication
            .advance(&self.pins, &clocks, &mut self.witness);
        self.touch.advance(self.now);
        for channel in self.timer.take_expired() {
            self.dma_mux.trigger(channel);
        }
        self.transfer();
    }

    /// Drives pin `number` of the board (0 to 33) from outside, or lets go of it.
    pub fn drive(&mut self, number: u8, level: Option<bool>) {
        let Some((port, bit)) = pins::board_pin(number) else {
            return;
        };
        let before = self.pins.level(port, bit);
        self.pins.drive(port, bit, level);
        let after = self.pins.level(port, bit);
        if before != after {
            self.timers.edge(&self.pins, (port, bit), after, self.now);
        }
    }

    /// Level of pin `number` of the board (0 to 33).
    pub fn level(&mut self, number: u8) -> bool {
        self.timers.show(&mut self.pins, self.now);
        pins::board_pin(number).is_some_and(|(port, bit)| self.pins.level(port, bit))
    }

    /// Puts bytes on the receive line of UART `n` (Serial1 is 0); `false` if no pin is connected to it.
    pub fn send_serial(&mut self, n: usize, bytes: &[u8]) -> bool {
        let clocks = self.clocks();
        self.communication.receive(n, bytes, &self.pins, &clocks)
    }

    /// The moment, in seconds since power-on.
    pub fn seconds(&self) -> f64 {
        time::seconds(self.now)
    }
}
