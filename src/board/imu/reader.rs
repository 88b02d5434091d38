//! One read of the sensor after the other, in steps that the interrupts take.
//!
//! ```text
//!  alarm │ address │ register │ address │ status │ 13 bytes by DMA │ last │ STOP
//!  27 µs for an address, 24 µs for a byte:       ▲ was there a new sample?
//! ```
//!
//! The alarm is set so that the status is read just behind data-ready ([`DataReady`]). If it was read too early, the
//! burst is broken off and the question put again, which takes 0.13 ms: neither is a sample read twice nor does one
//! get lost.
//!
//! The magnetometer is asked behind the burst, on the same hold of the bus, so that it delays no sample: 0.11 ms for
//! its status, 0.29 ms for a measurement. What it says goes out with the next sample.

use core::sync::atomic::{AtomicU32, Ordering};

use heapless::spsc::Producer;
use vrduino::imu::magnetometer::polling::{ANSWER_LEN, Loss, Polling};
use vrduino::imu::{ADDRESS, magnetometer};
use vrduino::sampling::data_ready::{DataReady, Early};
use vrduino::sampling::{Lock, Timing};
use vrduino::sensor::magnetometer::RawField;
use vrduino::sensor::{BURST_LEN, RAW_DATA_READY};

use super::super::clock;
use super::super::dma::Dma;
use super::super::i2c::{Error, I2c};
use super::super::timer::{self, Alarm, TICKS_PER_US};
use super::frames;
use super::job::Job;
use super::sampled::{Counts, Outcome, Sampled};

/// Between the alarms while nothing is sampled.
const TICK: u32 = 1000 * TICKS_PER_US;
/// From a STOP to the next START at least: the STOP itself takes 3 µs.
const PAUSE: u32 = 10 * TICKS_PER_US;
/// What a measurement of the magnetometer takes at most. Behind a burst that comes late, while the loop locks, it waits
/// for the next.
const FIELD: u32 = 320 * TICKS_PER_US;
/// From a START to the moment at which the status is read, until it was measured: three addresses and registers.
const LEAD: u32 = 80 * TICKS_PER_US;
/// Alarms after which a read that does not end is given up.
const STUCK_ALARMS: u8 = 3;

/// When the last sample was ready, in microseconds; wraps. Under a name that survives optimisation, so that the
/// emulator can compare it with the truth.
// SAFETY: no other item has this name.
#[unsafe(export_name = "vrduino_data_ready_us")]
static DATA_READY: AtomicU32 = AtomicU32::new(0);

#[derive(Clone, Copy, PartialEq, Eq)]
enum Step {
    Idle,
    /// The chip's address for writing is on the bus.
    AddressToWrite,
    /// The number of the first register is.
    Register,
    /// The chip's address for reading is.
    AddressToRead,
    /// The first byte of a sample is coming in: whether it is new.
    Status,
    /// It is not; the byte behind is coming in, unasked.
    Unwanted,
    /// DMA takes the bytes.
    Bytes,
    /// The last is coming in.
    Last,
    /// It has come and was acknowledged; one more is coming in, for which nobody has asked.
    Excess,
}

/// What the interrupts work on.
pub struct Reader {
    alarm: Alarm,
    dma: Dma,
    /// Present while sampling is on.
    bus: Option<I2c>,
    job: Job,
    step: Step,
    lock: Lock,
    ready: DataReady,
    /// When the read was begun, and how long it then took to come to the status.
    begun: u32,
    lead: u32,
    /// Of the sample that is being read.
    timing: Timing,
    /// Present if there is one.
    magnetometer: Option<Polling>,
    results: Producer<'static, Sampled>,
    /// For the next sample.
    field: Option<Result<RawField, Loss>>,
    stuck_alarms: u8,
    /// What was counted.
    pub counts: Counts,
}

impl Reader {
    /// One without a bus, which counts milliseconds and nothing else.
    pub fn new(mut alarm: Alarm, dma: Dma, results: Producer<'static, Sampled>) -> Reader {
        alarm.set(TICK);
        Reader {
            alarm,
            dma,
            bus: None,
            job: Job::Sample,
            step: Step::Idle,
            lock: Lock::default(),
            ready: DataReady::new(TICKS_PER_US),
            begun: 0,
            lead: LEAD,
            timing: Timing::default(),
            magnetometer: None,
            results,
            field: None,
            stuck_alarms: 0,
            counts: Counts::default(),
        }
    }

    /// Takes the bus of a sensor that was just set up. Not to be interrupted.
    pub fn give(&mut self, bus: I2c, magnetometer: Option<Polling>) {
        let now = timer::now();
        self.ready.start(now, clock::microseconds(now));
        self.lead = LEAD;
        self.bus = Some(bus);
        self.magnetometer = magnetometer;
        self.field = None;
        self.stuck_alarms = 0;
    }

    /// Chooses what the sensor is read by. Not to be interrupted.
    pub fn lock_on(&mut self, lock: Lock) {
        self.lock = lock;
        if lock == Lock::Sensor {
            self.ready.resume();
        }
    }

    /// Once the sensor's period is known: what is left out is reckoned by it.
    #[inline(always)]
    fn follows_host(&self) -> bool {
        self.lock == Lock::Usb && self.ready.is_locked()
    }

    /// Gives the bus back. Not to be interrupted.
    pub fn take(&mut self) -> Option<I2c> {
        self.step = Step::Idle;
        self.dma.stop();
        self.bus.take()
    }

    /// It is time for a read.
    #[inline(always)]
    pub fn alarm(&mut self) {
        self.alarm.set(TICK);
        clock::advance();
        let Some(bus) = &mut self.bus else { return };
        // A line may be held low between two reads as well.
        if self.step == Step::Idle && !bus.is_busy() {
            self.stuck_alarms = 0;
            self.job = Job::Sample;
            self.step = Step::AddressToWrite;
            self.begun = timer::now();
            bus.begin(ADDRESS << 1, true);
            return;
        }
        self.overrun();
    }

    /// The read before has not ended, or the bus is not free.
    #[cold]
    fn overrun(&mut self) {
        self.stuck_alarms += 1;
        let mut error = Error::Busy;
        if self.stuck_alarms >= STUCK_ALARMS {
            error = Error::Timeout;
            self.break_off();
        }
        self.timing = self.ready.miss();
        self.deliver(Outcome::Failed(error));
    }

    /// A byte has ended, other than those that DMA takes.
    #[inline(always)]
    pub fn byte(&mut self) {
        let Some(bus) = &mut self.bus else { return };
        let Some(result) = bus.byte_done() else {
            return;
        };
        match (self.step, result) {
            (Step::AddressToWrite, Ok(())) => {
                bus.put(self.job.register());
                self.step = Step::Register;
            }
            (Step::Register, Ok(())) => {
                bus.begin_again(self.job.address() << 1 | 1, true);
                self.step = Step::AddressToRead;
            }
            (Step::AddressToRead, Ok(())) => self.receive(),
            (Step::Status, Ok(())) => self.status(),
            (Step::Unwanted, _) => self.ask_again(),
            (Step::Excess, _) => {
                bus.stop();
                let _ = bus.get();
                self.end();
            }
            // The last byte is refused by ourselves, which shows as "not acknowledged".
            (Step::Last, Ok(()) | Err(Error::NoData)) => self.last(),
            (Step::Idle, _) => {}
            (Step::AddressToWrite | Step::AddressToRead, Err(Error::NoData)) => {
                self.fail(Error::NoAddress);
            }
            (_, Ok(())) => self.fail(Error::Timeout),
            (_, Err(error)) => self.fail(error),
        }
    }

    /// The chip has been addressed for reading.
    #[inline(always)]
    fn receive(&mut self) {
        let Some(bus) = &mut self.bus else { return };
        let length = self.job.length();
        bus.receive_first(length, true);
        self.step = match self.job {
            Job::Sample => {
                // The sensor holds its registers still from here on.
                self.lead = timer::now().wrapping_sub(self.begun);
                Step::Status
            }
            Job::Field(_) if length == 1 => Step::Last,
            Job::Field(_) => {
                self.dma.receive(0, length - 1);
                bus.hand_to_dma();
                Step::Bytes
            }
        };
    }

    /// Is there a new sample?
    #[inline(never)]
    fn status(&mut self) {
        let follows_host = self.follows_host();
        let Some(bus) = &mut self.bus else { return };
        let status = bus.get();
        let asked = self.begun.wrapping_add(self.lead);
        let new = status & RAW_DATA_READY != 0;
        if new {
            self.dma.receive(1, BURST_LEN - 2);
            bus.hand_to_dma();
            self.dma.put(0, status);
            self.step = Step::Bytes;
        } else {
            bus.refuse_last();
            self.step = Step::Unwanted;
        }
        if follows_host {
            self.timing = self.ready.read_at(asked, new);
        } else if new {
            self.timing = self.ready.new_sample(asked);
        }
    }

    /// There was none.
    #[cold]
    fn ask_again(&mut self) {
        let follows_host = self.follows_host();
        let Some(bus) = &mut self.bus else { return };
        let next = if follows_host {
            Early::Repeat(self.timing)
        } else {
            self.ready.not_yet(self.begun.wrapping_add(self.lead))
        };
        match next {
            Early::Again => {
                self.alarm.set(TICK);
                let _ = bus.receive_last_and_hold();
                self.begun = timer::now();
                bus.begin_again(ADDRESS << 1, true);
                self.step = Step::AddressToWrite;
            }
            Early::Repeat(timing) => {
                bus.stop();
                let _ = bus.get();
                self.step = Step::Idle;
                self.timing = timing;
                self.deliver(Outcome::Nothing);
            }
        }
    }

    /// DMA has taken all bytes but the last.
    #[inline(always)]
    pub fn all_but_last(&mut self) {
        self.dma.clear_interrupt();
        let Some(bus) = &mut self.bus else { return };
        if self.step != Step::Bytes {
            return;
        }
        self.step = Step::Last;
        if bus.refuse_last() {
            let at = self.job.length() - 1;
            self.dma.put(at, bus.get());
            self.step = Step::Excess;
        }
    }

    /// The last byte has come in.
    #[inline(never)]
    fn last(&mut self) {
        let room = self.until_next();
        let Some(bus) = &mut self.bus else { return };
        let next = match (self.job, &mut self.magnetometer) {
            (Job::Sample, Some(magnetometer)) if room > FIELD => magnetometer.sample(),
            _ => None,
        };
        let at = self.job.length() - 1;
        let Some(request) = next else {
            let byte = bus.receive_next(0, true);
            self.dma.put(at, byte);
            self.end();
            return;
        };
        self.dma.put(at, bus.receive_last_and_hold());
        bus.begin_again(magnetometer::ADDRESS << 1, true);
        self.step = Step::AddressToWrite;
        self.deliver(Outcome::New);
        self.job = Job::Field(request);
    }

    /// All bytes are there, and the bus is free.
    fn end(&mut self) {
        self.step = Step::Idle;
        match self.job {
            Job::Sample => self.deliver(Outcome::New),
            Job::Field(_) => self.take_answer(),
        }
    }

    #[inline(never)]
    fn take_answer(&mut self) {
        let bytes = self.dma.bytes().array();
        let answer = bytes.first_chunk::<ANSWER_LEN>();
        let measured = match (&mut self.magnetometer, answer) {
            (Some(magnetometer), Some(answer)) => magnetometer.answer(answer),
            _ => None,
        };
        if let Some(measured) = measured {
            self.field = Some(Ok(measured.field));
            let skipped = u32::from(measured.overrun);
            self.counts.skipped_fields = self.counts.skipped_fields.wrapping_add(skipped);
        }
    }

    /// Leaves bus and DMA as if nothing had been begun.
    fn break_off(&mut self) {
        self.dma.stop();
        if let Some(bus) = &mut self.bus {
            bus.stop();
        }
        self.step = Step::Idle;
    }

    #[cold]
    fn fail(&mut self, error: Error) {
        self.break_off();
        match (self.job, &mut self.magnetometer) {
            (Job::Sample, _) => {
                self.timing = self.ready.miss();
                self.deliver(Outcome::Failed(error));
            }
            (Job::Field(_), Some(magnetometer)) => magnetometer.refuse(),
            (Job::Field(_), None) => {}
        }
    }

    /// Ticks until the next read is to begin.
    #[inline(always)]
    fn until_next(&self) -> u32 {
        let now = timer::now();
        if self.follows_host()
            && let Some(wait) = frames::until_ahead(now, PAUSE)
        {
            return wait;
        }
        let wait = self.ready.ticks_until_ask(now);
        wait.saturating_sub(self.lead).max(PAUSE)
    }

    /// Hands over what has come in, and sets the alarm for the next.
    #[inline(never)]
    fn deliver(&mut self, outcome: Outcome) {
        let wait = self.until_next();
        self.alarm.set(wait);
        self.counts.lost = self.counts.lost.wrapping_add(self.timing.lost);
        DATA_READY.store(self.timing.micros as u32, Ordering::Relaxed);
        if self.results.ready() {
            let sampled = Sampled {
                outcome,
                bytes: self.dma.bytes(),
                timing: self.timing,
                field: self.field.take(),
            };
            // SAFETY: there is room, and nobody else puts anything in.
            unsafe { self.results.enqueue_unchecked(sampled) }
        } else {
            self.counts.lost = self.counts.lost.wrapping_add(1);
        }
        if let Some(magnetometer) = &self.magnetometer
            && let Some(loss) = magnetometer.loss()
        {
            self.magnetometer = None;
            self.field = Some(Err(loss));
        }
    }
}
