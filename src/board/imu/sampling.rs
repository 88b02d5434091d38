//! PIT0 starts a burst every millisecond; I2C0 interrupts after every byte and carries it on. Both
//! run at the same priority, so neither interrupts the other. A burst takes 0.45 ms of the
//! millisecond.
//!
//! The magnetometer is asked behind the burst, on the same hold of the bus, so that it delays no
//! sample: 0.11 ms for its status, 0.29 ms for a measurement. What it says goes out with the next
//! sample.

use core::cell::RefCell;

use critical_section::Mutex;
use heapless::spsc::{Consumer, Producer, Queue};
use mk20dx_hal::interrupt;
use mk20dx_hal::pac::Interrupt;
use mk20dx_hal::timer::PitChannel;
use vrduino::imu::magnetometer::polling::{self, ANSWER_LEN, Loss, Polling, Request};
use vrduino::imu::{ADDRESS, magnetometer};
use vrduino::sensor::magnetometer::RawField;
use vrduino::sensor::{BURST_LEN, BURST_START, Burst};

use super::super::breadcrumb::{self, Stage};
use super::super::clock;
use super::super::i2c::{Error, I2c};

/// Bursts that may wait for the main program: it may be this many milliseconds late.
const WAITING_BURSTS: usize = 16;
/// PIT counts down from here: 36 MHz / 36 000 = 1 kHz, exact to the crystal.
const TICKS_PER_SAMPLE: u32 = 36_000 - 1;
/// Timer ticks after which a burst that does not end is given up.
const STUCK_TICKS: u8 = 3;
/// More urgent than USB (0x80); only the upper four bits exist.
const PRIORITY: u8 = 0x40;

static SAMPLING: Mutex<RefCell<Option<Sampling>>> = Mutex::new(RefCell::new(None));

/// What a millisecond has brought.
pub struct Sampled {
    /// From the IMU.
    pub burst: Result<Burst, Error>,
    /// From the magnetometer, mostly nothing; that it is lost is said once.
    pub field: Option<Result<RawField, Loss>>,
}

/// Where what has been sampled comes out.
pub type Samples = Consumer<'static, Sampled>;

/// What the interrupts have counted since the start.
#[derive(Clone, Copy, Default)]
pub struct Counts {
    /// Milliseconds in which the burst before had not ended, or found no room in the queue.
    pub overruns: u32,
    /// Times that the magnetometer's measurements were overwritten unread.
    pub skipped_fields: u32,
}

/// Starts the timer: from here on milliseconds are counted.
pub fn start(mut timer: PitChannel<0>) -> Samples {
    let queue = cortex_m::singleton!(: Queue<Sampled, WAITING_BURSTS> = Queue::new())
        .expect("the board is taken once");
    let (results, samples) = queue.split();
    timer.start_ticks(TICKS_PER_SAMPLE);
    timer.enable_interrupt();
    let sampling = Sampling {
        timer,
        bus: None,
        job: Job::Sample,
        step: Step::Idle,
        bytes: [0; BURST_LEN],
        magnetometer: None,
        field: None,
        results,
        stuck_ticks: 0,
        overruns: 0,
        skipped_fields: 0,
    };
    critical_section::with(|cs| SAMPLING.replace(cs, Some(sampling)));
    for interrupt in [Interrupt::PIT0, Interrupt::I2C0] {
        super::super::enable_interrupt(interrupt, PRIORITY);
    }
    samples
}

/// Hands the bus to the interrupts, which from now on sample; the magnetometer too if there is one.
pub fn give(bus: I2c, magnetometer: Option<Polling>) {
    look(|sampling| {
        sampling.bus = Some(bus);
        sampling.magnetometer = magnetometer;
        sampling.field = None;
    });
}

/// Takes the bus back, if the interrupts have it.
pub fn take() -> Option<I2c> {
    look(|sampling| {
        sampling.step = Step::Idle;
        sampling.bus.take()
    })
    .flatten()
}

/// What has been counted so far.
pub fn counts() -> Counts {
    look(|sampling| Counts {
        overruns: sampling.overruns,
        skipped_fields: sampling.skipped_fields,
    })
    .unwrap_or_default()
}

fn look<T>(work: impl FnOnce(&mut Sampling) -> T) -> Option<T> {
    critical_section::with(|cs| SAMPLING.borrow_ref_mut(cs).as_mut().map(work))
}

/// What the bus is used for.
#[derive(Clone, Copy)]
enum Job {
    Sample,
    Field(Request),
}

impl Job {
    fn address(self) -> u8 {
        match self {
            Job::Sample => ADDRESS,
            Job::Field(_) => magnetometer::ADDRESS,
        }
    }

    fn register(self) -> u8 {
        match self {
            Job::Sample => BURST_START,
            Job::Field(_) => polling::START,
        }
    }

    fn length(self) -> usize {
        match self {
            Job::Sample => BURST_LEN,
            Job::Field(request) => request.length(),
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Step {
    Idle,
    /// The chip's address for writing is on the bus.
    AddressToWrite,
    /// The number of the first register is.
    Register,
    /// The chip's address for reading is.
    AddressToRead,
    /// The byte with this index is coming in.
    Receive(usize),
}

/// What the two interrupts work on.
struct Sampling {
    timer: PitChannel<0>,
    /// Present while sampling is on.
    bus: Option<I2c>,
    job: Job,
    step: Step,
    /// What comes in; an answer of the magnetometer is shorter than a burst.
    bytes: Burst,
    /// Present if there is one.
    magnetometer: Option<Polling>,
    /// For the next sample.
    field: Option<Result<RawField, Loss>>,
    results: Producer<'static, Sampled>,
    stuck_ticks: u8,
    overruns: u32,
    skipped_fields: u32,
}

impl Sampling {
    /// A millisecond begins.
    fn tick(&mut self) {
        self.timer.clear_interrupt();
        clock::tick();
        let Some(bus) = &mut self.bus else { return };
        if self.step == Step::Idle {
            self.stuck_ticks = 0;
            self.job = Job::Sample;
            self.step = Step::AddressToWrite;
            bus.begin(self.job.address() << 1, true);
            return;
        }
        self.overruns = self.overruns.wrapping_add(1);
        self.stuck_ticks += 1;
        if self.stuck_ticks >= STUCK_TICKS {
            self.fail(Error::Timeout);
        }
    }

    /// A byte has ended.
    fn byte(&mut self) {
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
            (Step::AddressToRead, Ok(())) => {
                bus.receive_first(self.job.length(), true);
                self.step = Step::Receive(0);
            }
            // The last byte is refused by ourselves, which shows as "not acknowledged".
            (Step::Receive(index), Ok(()) | Err(Error::NoData)) => self.receive(index),
            (Step::AddressToWrite | Step::AddressToRead, Err(Error::NoData)) => {
                self.fail(Error::NoAddress);
            }
            (Step::Idle, _) => {}
            (_, Err(error)) => self.fail(error),
        }
    }

    fn receive(&mut self, index: usize) {
        let Some(bus) = &mut self.bus else { return };
        let remaining = self.job.length() - 1 - index;
        let next = match (self.job, &mut self.magnetometer) {
            (Job::Sample, Some(magnetometer)) if remaining == 0 => magnetometer.sample(),
            _ => None,
        };
        let byte = match next {
            Some(_) => bus.receive_last_and_hold(),
            None => bus.receive_next(remaining, true),
        };
        if let Some(place) = self.bytes.get_mut(index) {
            *place = byte;
        }
        if remaining > 0 {
            self.step = Step::Receive(index + 1);
            return;
        }
        if let Some(request) = next {
            bus.begin_again(magnetometer::ADDRESS << 1, true);
            self.step = Step::AddressToWrite;
            self.deliver(Ok(self.bytes));
            self.job = Job::Field(request);
            return;
        }
        self.step = Step::Idle;
        match self.job {
            Job::Sample => self.deliver(Ok(self.bytes)),
            Job::Field(_) => self.take_answer(),
        }
    }

    fn take_answer(&mut self) {
        let answer = self.bytes.first_chunk::<ANSWER_LEN>();
        let measured = match (&mut self.magnetometer, answer) {
            (Some(magnetometer), Some(answer)) => magnetometer.answer(answer),
            _ => None,
        };
        if let Some(measured) = measured {
            self.field = Some(Ok(measured.field));
            let skipped = u32::from(measured.overrun);
            self.skipped_fields = self.skipped_fields.wrapping_add(skipped);
        }
    }

    fn fail(&mut self, error: Error) {
        if let Some(bus) = &mut self.bus {
            bus.stop();
        }
        self.step = Step::Idle;
        match (self.job, &mut self.magnetometer) {
            (Job::Sample, _) => self.deliver(Err(error)),
            (Job::Field(_), Some(magnetometer)) => magnetometer.refuse(),
            (Job::Field(_), None) => {}
        }
    }

    fn deliver(&mut self, burst: Result<Burst, Error>) {
        let sampled = Sampled {
            burst,
            field: self.field.take(),
        };
        if self.results.enqueue(sampled).is_err() {
            self.overruns = self.overruns.wrapping_add(1);
        }
        if let Some(loss) = self.magnetometer.as_ref().and_then(Polling::loss) {
            self.magnetometer = None;
            self.field = Some(Err(loss));
        }
    }
}

fn during_interrupt(work: impl FnOnce(&mut Sampling)) {
    breadcrumb::during(Stage::SamplingInterrupt, || {
        look(work);
    });
}

#[cortex_m_rt::interrupt]
fn PIT0() {
    during_interrupt(Sampling::tick);
}

#[cortex_m_rt::interrupt]
fn I2C0() {
    during_interrupt(Sampling::byte);
}
