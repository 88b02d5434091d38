//! What was running when the watchdog bit.
//!
//! A panic keeps no message (panic-halt) and a hang has none. So the program leaves a breadcrumb in
//! RAM that start-up does not clear, and the next life reads it.

use core::fmt;
use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m_rt::{ExceptionFrame, exception};
use mk20dx_hal::pac;

/// What the program is at.
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Stage {
    /// Switching the clocks.
    Clocks = 1,
    /// Starting USB.
    UsbStart,
    /// Finding and setting up the sensor.
    ImuStart,
    /// Waiting for a sample.
    Sampling,
    /// Calibrating, filtering, writing lines.
    Filter,
    /// Waiting for a lost sensor.
    Waiting,
    /// In the USB interrupt.
    UsbInterrupt,
    /// In one of the sampling interrupts.
    SamplingInterrupt,
    /// Making the EEPROM.
    Partitioning,
}

impl Stage {
    const ALL: [(Stage, &str); 9] = [
        (Stage::Clocks, "switching clocks"),
        (Stage::UsbStart, "starting USB"),
        (Stage::ImuStart, "setting up the IMU"),
        (Stage::Sampling, "waiting for a sample"),
        (Stage::Filter, "in the filter"),
        (Stage::Waiting, "waiting for the IMU"),
        (Stage::UsbInterrupt, "in the USB interrupt"),
        (Stage::SamplingInterrupt, "in the sampling interrupt"),
        (Stage::Partitioning, "making the EEPROM"),
    ];
}

/// Memory after power-on is random; these two words, once written, say that it is not.
const MAGIC: [u32; 2] = [0x4352_554D, 0xBCAD_DAB2];
/// Set where a hard fault was taken.
const HARD_FAULT: u32 = 0x8000;

/// What is at hand, and whether to believe it. One word each, since it changes with every interrupt.
// SAFETY: `.uninit` is RAM that start-up leaves alone; any content is a valid AtomicU32.
#[unsafe(link_section = ".uninit.breadcrumb")]
static CRUMB: AtomicU32 = AtomicU32::new(0);
// SAFETY: as above.
#[unsafe(link_section = ".uninit.breadcrumb")]
static WRITTEN: [AtomicU32; 2] = [AtomicU32::new(0), AtomicU32::new(0)];

fn load() -> Option<u32> {
    let written = [0, 1].map(|at: usize| WRITTEN[at].load(Ordering::Relaxed));
    (written == MAGIC).then(|| CRUMB.load(Ordering::Relaxed))
}

/// Says what begins now.
#[inline(always)]
pub fn mark(stage: Stage) {
    CRUMB.store(stage as u32, Ordering::Relaxed);
}

/// Does `work` as `stage`, then goes back to what was at hand before: for interrupts.
#[inline(always)]
pub fn during<T>(stage: Stage, work: impl FnOnce() -> T) -> T {
    let before = CRUMB.load(Ordering::Relaxed);
    mark(stage);
    let result = work();
    CRUMB.store(before, Ordering::Relaxed);
    result
}

/// A fault of the core stops the program where it is; the watchdog does the rest.
#[exception]
unsafe fn HardFault(_frame: &ExceptionFrame) -> ! {
    let at = CRUMB.load(Ordering::Relaxed);
    CRUMB.store(HARD_FAULT | at & 0xFF, Ordering::Relaxed);
    loop {
        cortex_m::asm::nop();
    }
}

/// How the program before this one ended, if not by switching off.
#[derive(Clone, Copy)]
pub struct LastLife {
    reset: &'static str,
    hard_fault: bool,
    stage: Option<(Stage, &'static str)>,
}

impl LastLife {
    /// Reads the reset's cause and the breadcrumb. To be called before the first [`mark`]; from here on the breadcrumb
    /// is this life's.
    pub fn read(reset_control: &pac::Rcm) -> Option<LastLife> {
        let crumb = load();
        for (word, magic) in WRITTEN.iter().zip(MAGIC) {
            word.store(magic, Ordering::Relaxed);
        }
        // RCM_SRS0 and SRS1 (K20 manual, 15.2.1): pin and power-on resets are nothing to report.
        let (srs0, srs1) = (
            reset_control.srs0().read().bits(),
            reset_control.srs1().read().bits(),
        );
        let reset = match (srs0, srs1) {
            (srs0, _) if srs0 & 0x80 != 0 => return None,
            (srs0, _) if srs0 & 0x20 != 0 => "watchdog",
            (_, srs1) if srs1 & 0x02 != 0 => "lockup",
            (_, srs1) if srs1 & 0x04 != 0 => "software",
            _ => return None,
        };
        let stage = crumb.and_then(|crumb| {
            let number = crumb & 0xFF;
            Stage::ALL
                .into_iter()
                .find(|(stage, _)| *stage as u32 == number)
        });
        Some(LastLife {
            reset,
            hard_fault: crumb.is_some_and(|crumb| crumb & HARD_FAULT != 0),
            stage,
        })
    }

    /// Whether it ended at `stage`.
    pub fn was_at(&self, stage: Stage) -> bool {
        self.stage.is_some_and(|(at, _)| at == stage)
    }
}

impl fmt::Display for LastLife {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fault = if self.hard_fault {
            "after a hard fault "
        } else {
            ""
        };
        write!(
            f,
            "reset by {} {}while {}",
            self.reset,
            fault,
            self.stage.map_or("starting up", |(_, name)| name)
        )
    }
}
