//! The VRduino board: everything that knows the chip.
//!
//! Priorities, most urgent first: sampling (PIT0, I2C0 and DMA0, which never interrupt one another), USB,
//! and the main program.

#![allow(
    unsafe_code,
    reason = "registers; each block states the one fact it relies on"
)]

pub mod breadcrumb;

pub mod calibration;

pub mod clock;

pub mod dma;

pub mod i2c;

pub mod imu;

pub mod led;

pub mod loader;

pub mod multiply;

pub mod store;

pub mod timer;

pub mod usb;

pub mod watchdog;

use cortex_m::peripheral::NVIC;
use mk20dx_hal::pac;
use vrduino::calibration::record::Record;
use vrduino::command::request::CoreClock;
use vrduino::imu::magnetometer::MagnetometerError;
use vrduino::sampling::Lock;
use vrduino::sensor::magnetometer::{RawField, SensitivityAdjustment};
use vrduino::tracker::Health;
use vrduino::wire;

use breadcrumb::Stage;
use calibration::Calibration;
use clock::{Core, Time};
use dma::Dma;
use i2c::I2c;
use imu::Imu;
use led::Led;
use loader::Loader;
use store::Store;
use usb::Usb;
use watchdog::Watchdog;

pub use imu::Fault;

/// The parts of the board, ready for use.
pub struct Board {
    /// The serial port.
    pub usb: Usb,
    /// The sensor.
    pub imu: Imu,
    calibration: Calibration,
    led: Led,
    loader: Loader,
    time: Time,
    watchdog: Watchdog,
    last_life: Option<breadcrumb::LastLife>,
    fault: Option<Fault>,
    /// Why the board runs on six axes, if it does.
    no_compass: Option<MagnetometerError<i2c::Error>>,
    introduced: bool,
    lock: Lock,
    core: Core,
    wanted_clock: CoreClock,
}

impl Board {
    /// Brings the board up. To be called once, first thing.
    pub fn take() -> Board {
        let core = cortex_m::Peripherals::take().expect("the board is taken once");
        let chip = pac::Peripherals::take().expect("the board is taken once");
        let last_life = breadcrumb::LastLife::read(&chip.rcm);
        breadcrumb::mark(Stage::Clocks);
        clock::start(core.DCB, core.DWT, chip.mcg, chip.osc, &chip.sim);
        let alarm = timer::start(chip.pit, &chip.sim);
        let mut watchdog = Watchdog::new(chip.wdog);
        // Before USB and sampling: on a new chip it takes a while. What hung once is not tried again.
        let hung = last_life.is_some_and(|life| life.was_at(Stage::Partitioning));
        watchdog.feed();
        let store = Store::new(chip.ftfl, &chip.sim, !hung);
        watchdog.feed();
        let led = Led::new(chip.portc, chip.ptc, &chip.sim);
        breadcrumb::mark(Stage::UsbStart);
        let usb = Usb::new(chip.usb0, &chip.sim);
        let bus = I2c::new(chip.i2c0, chip.portb, chip.ptb, &chip.sim);
        let imu = Imu::new(bus, Dma::new(chip.dma, chip.dmamux, &chip.sim), alarm);
        Board {
            usb,
            imu,
            calibration: Calibration::new(store),
            led,
            loader: Loader::default(),
            time: Time,
            watchdog,
            last_life,
            fault: None,
            no_compass: None,
            introduced: false,
            lock: Lock::default(),
            core: Core::new(chip.sim),
            wanted_clock: CoreClock::default(),
        }
    }

    /// The calibration that was kept last, if there is one that is whole. To be called at start; what
    /// is wrong with it is told when the port is opened.
    pub fn load_calibration(&mut self) -> Option<Record> {
        self.calibration.load()
    }

    /// Keeps a calibration over power cycles, a word in each turn: 40 ms or so. The host is told how
    /// it went.
    pub fn keep_calibration(&mut self, record: &Record) {
        self.calibration.keep(record);
    }

    /// Finds the sensor, sets it up and starts sampling. Returns what the factory found out about its
    /// magnetometer, if there is one that works.
    pub fn start_imu(&mut self) -> Result<Option<SensitivityAdjustment>, Fault> {
        breadcrumb::mark(Stage::ImuStart);
        let compass = self.imu.start(&mut self.time, &mut self.watchdog)?;
        if self.fault.take().is_some() {
            self.usb.send(&wire::text("the IMU answers again"));
        }
        let before = self.no_compass;
        self.no_compass = compass.err();
        // Who has not opened the port yet is told when that is done.
        if self.introduced && self.no_compass != before {
            self.tell_of_compass();
        }
        Ok(compass.ok())
    }

    /// Sleeps until the sensor's next sample is there, in [`Imu::sample`] and [`Imu::timing`]. Returns what the
    /// magnetometer has measured since the one before, every tenth time or so.
    ///
    /// A burst that failed is bridged by the sample before it, marked as not fresh; a sensor that
    /// fails for longer is a fault. A magnetometer that fails is none: tracking goes on without.
    #[inline(never)] // in SRAM, see memory.x
    pub fn next_sample(&mut self) -> Result<Option<RawField>, Fault> {
        breadcrumb::mark(Stage::Sampling);
        match self.imu.next_sample()? {
            None => Ok(None),
            Some(Ok(field)) => Ok(Some(field)),
            Some(Err(loss)) => {
                self.no_compass = Some(MagnetometerError::Lost(loss));
                self.tell_of_compass();
                Ok(None)
            }
        }
    }

    /// Chooses what the sensor is read by, from the next sample on.
    pub fn lock_on(&mut self, lock: Lock) {
        if lock != self.lock {
            self.lock = lock;
            self.usb.follow_frames(lock == Lock::Usb);
            imu::lock_on(lock);
        }
    }

    /// Runs the processor at this clock, once nothing is being written to flash.
    pub fn run_at(&mut self, clock: CoreClock) {
        self.wanted_clock = clock;
    }

    /// Counters for the INFO lines.
    pub fn health(&self) -> Health {
        let counts = imu::counts();
        Health {
            dropped_lines: usb::dropped_lines(),
            overruns: counts.lost,
            skipped_fields: counts.skipped_fields,
        }
    }

    /// Ends a turn of the main loop that went well.
    #[inline(never)] // in SRAM, see memory.x
    pub fn end_of_turn(&mut self) {
        self.watchdog.feed();
        // What is being kept goes on with each; the rest is for eyes and hands, for which one in four is enough.
        if self.calibration.is_busy() {
            self.go_on_keeping();
        }
        let now = clock::milliseconds();
        if now.is_multiple_of(4) {
            self.look_around(now);
        }
    }

    fn look_around(&mut self, now: u32) {
        if !self.calibration.is_busy() {
            self.core.run_at(self.wanted_clock);
        }
        self.led.heartbeat(now);
        self.loader.serve(self.usb.loader_asked(), now);
        if self.usb.was_opened() {
            self.introduce();
        }
    }

    /// Tells the host what is wrong.
    pub fn report(&mut self, fault: Fault) {
        self.usb.send(&wire::text(format_args!("error: {fault}")));
        self.fault = Some(fault);
    }

    /// Lets `ms` milliseconds pass without a sensor, showing so on the LED.
    pub fn wait(&mut self, ms: u32) {
        breadcrumb::mark(Stage::Waiting);
        let until = clock::milliseconds().wrapping_add(ms);
        while until.wrapping_sub(clock::milliseconds()) as i32 > 0 {
            self.time.sleep_for_a_tick();
            self.watchdog.feed();
            self.go_on_keeping();
            self.led.distress(clock::milliseconds());
            self.loader
                .serve(self.usb.loader_asked(), clock::milliseconds());
            // Keys mean nothing without a sensor; they must not pile up either.
            while self.usb.command().is_some() {}
            if self.usb.was_opened() {
                self.introduce();
                if let Some(fault) = self.fault {
                    self.report(fault);
                }
            }
        }
    }

    #[cold]
    fn go_on_keeping(&mut self) {
        if let Some(end) = self.calibration.serve(clock::milliseconds()) {
            self.usb.send(&end);
        }
    }

    /// Says who is speaking, and how the program before this one ended if that was not by power.
    fn introduce(&mut self) {
        self.usb
            .send(&wire::text(concat!("vrduino ", env!("CARGO_PKG_VERSION"))));
        if let Some(last_life) = self.last_life {
            self.usb
                .send(&wire::text(format_args!("warning: {last_life}")));
        }
        if let Some(trouble) = self.calibration.trouble() {
            self.usb.send(&trouble);
        }
        self.introduced = true;
        self.tell_of_compass();
    }

    /// Says why there is no compass, if there is none.
    #[cold]
    fn tell_of_compass(&mut self) {
        if let Some(error) = self.no_compass {
            self.usb.send(&wire::magnetometer_failed(&error));
        }
    }
}

/// Lets `interrupt` through with `priority`, of which the upper four bits count.
fn enable_interrupt(interrupt: pac::Interrupt, priority: u8) {
    // SAFETY: Board::take holds the core's peripherals, and nobody else touches the NVIC.
    let mut nvic = unsafe { cortex_m::Peripherals::steal() }.NVIC;
    // SAFETY: called before the interrupt is enabled, so no critical section depends on its priority.
    unsafe { nvic.set_priority(interrupt, priority) };
    // SAFETY: the caller has put the handler's state in place.
    unsafe { NVIC::unmask(interrupt) };
}
