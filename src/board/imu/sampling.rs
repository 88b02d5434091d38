//! The interrupts that sample: the alarm (PIT0) begins a burst, I2C0 carries its addresses, DMA0 ends its bytes but
//! the last ([`Reader`]). All run at the same priority, so none interrupts another, and all their code is in SRAM:
//! what they take from the main program is six times some tens of cycles for each sample.
//!
//! What comes in goes to the main program through a queue.

use core::cell::UnsafeCell;

use heapless::spsc::{Consumer, Queue};
use mk20dx_hal::pac::Interrupt;
use vrduino::imu::magnetometer::polling::Polling;
use vrduino::sampling::Lock;

use super::super::breadcrumb::{self, Stage};
use super::super::dma::Dma;
use super::super::i2c::I2c;
use super::super::timer::Alarm;
use super::reader::Reader;
use super::sampled::{Counts, Sampled};

/// Samples that may wait for the main program: it may be this many milliseconds late.
const WAITING: usize = 16;
/// More urgent than USB (0x80); only the upper four bits exist.
const PRIORITY: u8 = 0x40;

/// Where what has been sampled comes out.
pub type Samples = Consumer<'static, Sampled>;

/// What the interrupts work on.
struct Shared(UnsafeCell<Option<Reader>>);

// SAFETY: it is accessed in the interrupts, of which none interrupts another, and in `look`, which they do not
// interrupt.
unsafe impl Sync for Shared {}

static READER: Shared = Shared(UnsafeCell::new(None));

/// Sets the first alarm: from here on milliseconds are counted.
pub fn start(alarm: Alarm, dma: Dma) -> Samples {
    let queue = cortex_m::singleton!(: Queue<Sampled, WAITING> = Queue::new())
        .expect("the board is taken once");
    let (results, samples) = queue.split();
    let reader = Reader::new(alarm, dma, results);
    critical_section::with(|_| {
        // SAFETY: no interrupt comes in between, and nobody else holds a reference.
        unsafe { *READER.0.get() = Some(reader) }
    });
    for interrupt in [Interrupt::PIT0, Interrupt::I2C0, Interrupt::DMA0] {
        super::super::enable_interrupt(interrupt, PRIORITY);
    }
    samples
}

/// Hands the bus to the interrupts, which from now on sample; the magnetometer too if there is one.
pub fn give(bus: I2c, magnetometer: Option<Polling>) {
    look(|reader| reader.give(bus, magnetometer));
}

/// Takes the bus back, if the interrupts have it.
pub fn take() -> Option<I2c> {
    look(Reader::take).flatten()
}

/// Chooses what the sensor is read by, from the next sample on.
pub fn lock_on(lock: Lock) {
    look(|reader| reader.lock_on(lock));
}

/// What has been counted so far.
pub fn counts() -> Counts {
    look(|reader| reader.counts).unwrap_or_default()
}

fn look<T>(work: impl FnOnce(&mut Reader) -> T) -> Option<T> {
    critical_section::with(|_| {
        // SAFETY: no interrupt comes in between, and nobody else holds a reference.
        let reader = unsafe { &mut *READER.0.get() };
        reader.as_mut().map(work)
    })
}

#[inline(always)]
fn during_interrupt(work: impl FnOnce(&mut Reader)) {
    breadcrumb::during(Stage::SamplingInterrupt, || {
        // SAFETY: the interrupts do not interrupt one another, and `look` is not interrupted by them.
        let reader = unsafe { &mut *READER.0.get() };
        if let Some(reader) = reader {
            work(reader);
        }
    });
}

// Handlers by the names of the vector table. Not by the attribute for it, which leaves no say in where they are.

// SAFETY: the vector table has this name for the handler of PIT0; `memory.x` puts `.fast` into SRAM.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".fast")]
extern "C" fn PIT0() {
    during_interrupt(Reader::alarm);
}

// SAFETY: as above, for I2C0.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".fast")]
extern "C" fn I2C0() {
    during_interrupt(Reader::byte);
}

// SAFETY: as above, for channel 0 of the DMA controller.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".fast")]
extern "C" fn DMA0() {
    during_interrupt(Reader::all_but_last);
}
