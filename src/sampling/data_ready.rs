//! A loop that follows the sensor's data-ready, from nothing but "new" and "not yet".
//!
//! Each sample is asked for a little earlier, measured against the sensor's own period, than the one before. Sooner or
//! later it is asked for too early, and the answer is "not yet". This is the only moment that tells something: the
//! sample was not ready then, and the one before was ready when it was asked for, a period less that little earlier.
//! So data-ready is known to within that little: an *edge*. Two edges give the period, which is all of a second-order
//! loop: phase and frequency. Then the asking begins again a little behind data-ready.
//!
//! ```text
//!  asked for behind     ┤·
//!  data-ready by        │  ·  ·
//!                       │        ·  ·              ·  ·
//!  0 ───────────────────┼──────────────·  ·──────────────·  ·─────
//!                       │                    ·► edge         ·► edge
//! ```
//!
//! How much earlier follows from how well the period is known: 1 % at first, and with every edge
//! better, down to [`FINEST`]. At that rate four edges a second keep the loop in step with an oscillator that warms up.
//! If no edge comes for long, the period is less than was thought; then the steps double until one does.

use super::Timing;

/// Times within the loop are in 1/256 of a tick of the clock: 0.1 ns at 36 MHz.
const FRACTION: u32 = 8;

/// Samples between edges, once the period is known.
const LONGEST_RUN: u32 = 256;
/// Samples between the first edges.
const SHORTEST_RUN: u32 = 16;

/// The sensor's nominal period, in microseconds.
const NOMINAL_US: u32 = 1000;
/// What is known of the period before it was measured: the data sheet's 1 %, in microseconds.
const UNCERTAIN_US: u32 = 10;
/// The least that a sample is asked for earlier than the one before, in nanoseconds.
pub const FINEST: u32 = 6;
/// What an edge is uncertain by however small the steps are, in nanoseconds: the sensor's jitter, and the time until
/// the interrupt that takes the time is served.
const JITTER_NS: u32 = 200;
/// An edge is a break in the phase, such as after a restart of the sensor, if it is this far from where it was
/// expected, in microseconds. The period is then measured anew.
const BREAK_US: u32 = 50;

/// What to do about "not yet".
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Early {
    /// Ask again at once.
    Again,
    /// A whole period too late: there is no sample. Go on as if it had come, with the one before.
    Repeat(Timing),
}

/// Where the loop is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// No "not yet" has been heard so far: ask without pause.
    Seeking,
    /// There was an edge, and the period is what the data sheet says.
    Measuring,
    /// The period was measured between edges.
    Following,
}

/// The loop. Moments are counts of a clock that wraps at 32 bits; nothing may take longer than a tenth of a second at
/// 36 MHz without [`DataReady::start`] being called again.
#[derive(Clone, Debug)]
pub struct DataReady {
    /// Ticks of the clock in a microsecond.
    ticks_per_us: u32,
    phase: Phase,
    /// When the next sample should be ready (1/256 tick, wraps).
    expected: u32,
    /// How much later it is asked for (1/256 tick).
    behind: i32,
    period: u32,
    /// How much less `behind` is with every sample.
    slide: u32,
    /// Samples between edges that are aimed at.
    run: u32,
    /// Samples since the last edge.
    since: u32,
    /// How well the last edge is known.
    width: u32,
    /// The last "not yet" for the sample that is being asked for.
    not_yet: Option<u32>,
    /// The sample that was delivered last: when it was ready.
    stamped: u32,
    micros: u64,
    /// What `micros` leaves over.
    rest: u32,
    lost: u32,
}

impl DataReady {
    /// For a clock of so many ticks in a microsecond, 16 to 200.
    pub fn new(ticks_per_us: u32) -> Self {
        let mut new = Self {
            ticks_per_us: ticks_per_us.clamp(16, 200),
            phase: Phase::Seeking,
            expected: 0,
            behind: 0,
            period: 0,
            slide: 0,
            run: SHORTEST_RUN,
            since: 0,
            width: 0,
            not_yet: None,
            stamped: 0,
            micros: 0,
            rest: 0,
            lost: 0,
        };
        new.start(0, 0);
        new
    }

    /// Begins anew at the moment `now`, which is `micros` microseconds after the board's start: the sensor was set up.
    pub fn start(&mut self, now: u32, micros: u64) {
        (self.stamped, self.micros, self.rest) = (now << FRACTION, micros, 0);
        self.expected = self.stamped;
        self.seek();
    }

    #[cold]
    fn seek(&mut self) {
        self.phase = Phase::Seeking;
        self.period = self.us(NOMINAL_US);
        self.forget();
        self.behind = 0;
        self.not_yet = None;
        self.lost = 0;
    }

    /// Nothing is known of the period but what the data sheet says.
    fn forget(&mut self) {
        let uncertain = self.us(UNCERTAIN_US);
        self.slide = uncertain + uncertain / 2;
        self.run = SHORTEST_RUN;
        self.since = 0;
    }

    fn us(&self, us: u32) -> u32 {
        (us * self.ticks_per_us) << FRACTION
    }

    fn ns(&self, ns: u32) -> u32 {
        ns * (self.ticks_per_us << FRACTION) / 1000
    }

    /// Ticks from the moment `now` until the next sample is to be asked for; none if that has passed.
    pub fn ticks_until_ask(&self, now: u32) -> u32 {
        let at = self.expected.wrapping_add_signed(self.behind);
        let left = at.wrapping_sub(now << FRACTION) as i32;
        left.max(0) as u32 >> FRACTION
    }

    /// It was asked for at the moment `at`, and was not there yet.
    #[cold]
    pub fn not_yet(&mut self, at: u32) -> Early {
        let at = at << FRACTION;
        self.not_yet = Some(at);
        let late = at.wrapping_sub(self.expected) as i32;
        if late < self.period as i32 {
            return Early::Again;
        }
        self.pass();
        self.expected = at;
        self.seek();
        Early::Repeat(self.stamp())
    }

    /// The sample could not be read, the bus being in error or in use: it is lost. When will it have been ready?
    #[cold]
    pub fn miss(&mut self) -> Timing {
        self.lost += 1;
        self.not_yet = None;
        let timing = self.stamp();
        self.pass();
        timing
    }

    /// It was asked for at the moment `at`, and was there. When was it ready?
    pub fn new_sample(&mut self, at: u32) -> Timing {
        let at = at << FRACTION;
        let not_yet = self.not_yet.take();
        if self.phase == Phase::Seeking {
            // From when it is, is known once there was a "not yet" before it.
            self.expected = at;
            if let Some(before) = not_yet {
                self.width = at.wrapping_sub(before);
                self.expected = before.wrapping_add(self.width / 2);
                self.phase = Phase::Measuring;
                self.begin_run();
            }
        } else {
            self.skip_lost(at, self.period / 16);
            match not_yet {
                Some(before) => self.edge(before, at),
                None => self.slide_on(),
            }
        }
        let timing = self.stamp();
        if self.phase != Phase::Seeking {
            self.pass();
        }
        timing
    }

    /// The status was read at the moment `at`, which was chosen by somebody else, and told whether there was a new
    /// sample. When was the one ready that was read, or repeated? Samples that were left out are among those lost.
    ///
    /// A sensor that is slower is followed all the same, by the samples that come twice. With one that is faster nothing
    /// is heard of those that are left out: they are reckoned from the period that was measured before.
    #[cold]
    pub fn read_at(&mut self, at: u32, new: bool) -> Timing {
        let at = at << FRACTION;
        self.not_yet = None;
        if self.phase == Phase::Seeking {
            self.expected = at;
        } else if new {
            self.skip_lost(at, 0);
        }
        let late = at.wrapping_sub(self.expected) as i32;
        // New before it was expected, or not there although it was.
        if (late < 0) == new {
            self.correct(late);
        }
        if !new {
            return Timing {
                micros: self.micros,
                period_ns: self.period_ns(),
                lost: 0,
                locked: false,
            };
        }
        let timing = self.stamp();
        self.pass();
        Timing {
            locked: false,
            ..timing
        }
    }

    /// A bound of data-ready was passed by so much.
    fn correct(&mut self, residual: i32) {
        let samples = self.since.max(LONGEST_RUN) as i32;
        self.expected = self.expected.wrapping_add_signed(residual);
        self.period = self.period.saturating_add_signed(residual / samples);
        self.since = 0;
    }

    /// Seeks data-ready anew, after reads at moments of somebody else's choice. The period is known from before.
    pub fn resume(&mut self) {
        let period = self.period;
        self.expected = self.stamped;
        self.seek();
        self.period = period;
    }

    /// Whether the sensor's clock is known.
    pub fn is_locked(&self) -> bool {
        self.phase == Phase::Following && self.run == LONGEST_RUN
    }

    /// The next sample.
    fn pass(&mut self) {
        self.expected = self.expected.wrapping_add(self.period);
        self.since += 1;
    }

    /// Samples that were ready a period and `more` before the read that found one.
    fn skip_lost(&mut self, at: u32, more: u32) {
        let mut late = at.wrapping_sub(self.expected) as i32;
        while late > (self.period + more) as i32 {
            late -= self.period as i32;
            self.lost += 1;
            self.pass();
        }
    }

    /// No edge: the next sample is asked for a little earlier.
    fn slide_on(&mut self) {
        self.behind -= self.slide as i32;
        // It should have come after `run` samples.
        if self.since >= 2 * self.run && self.since.is_multiple_of(self.run / 4) {
            self.slide = (2 * self.slide).min(self.us(2 * UNCERTAIN_US));
        }
    }

    /// The sample became ready between the moments `before` and `after`.
    #[cold]
    fn edge(&mut self, before: u32, after: u32) {
        // The sample before was ready when it was asked for, so this one is ready within the
        // slide, and what the period is uncertain by, which is less.
        // Not so right behind an edge: the one before was found late.
        let bound = if self.since > 1 {
            2 * self.slide
        } else {
            u32::MAX
        };
        let width = after.wrapping_sub(before).min(bound);
        let found = before.wrapping_add(width / 2);
        let residual = found.wrapping_sub(self.expected) as i32;
        let width = width + self.ns(JITTER_NS);
        if residual.unsigned_abs() > self.us(BREAK_US) && self.phase == Phase::Following {
            self.forget();
            self.phase = Phase::Measuring;
        } else {
            self.measure_period(residual, width);
        }
        self.expected = found;
        self.width = width;
        self.begin_run();
    }

    /// The last edge was `since` samples ago.
    fn measure_period(&mut self, residual: i32, width: u32) {
        let samples = self.since.max(1);
        let correction = residual / samples as i32;
        let (nominal, bound) = (self.us(NOMINAL_US), self.us(2 * UNCERTAIN_US));
        self.period = self
            .period
            .saturating_add_signed(correction)
            .clamp(nominal - bound, nominal + bound);
        // Known to within the widths of both edges over the samples between them. What it had to be corrected by
        // may come again: the oscillator drifts or jitters.
        let uncertain = (self.width + width) / samples;
        let slide =
            (uncertain + uncertain / 2).clamp(self.ns(FINEST), self.us(UNCERTAIN_US) * 3 / 2);
        if self.run == LONGEST_RUN {
            self.slide = slide.max(2 * correction.unsigned_abs());
        } else if slide < self.slide {
            self.slide = slide;
            self.run = (2 * self.run).min(LONGEST_RUN);
        }
        self.phase = Phase::Following;
    }

    /// Behind data-ready by as much as the slide takes back in a run.
    fn begin_run(&mut self) {
        self.since = 0;
        self.behind = (self.slide * self.run).max(self.width) as i32;
    }

    fn stamp(&mut self) -> Timing {
        let unit = self.us(1);
        // A correction may put a sample a little before the one that was delivered last.
        let passed = (self.expected.wrapping_sub(self.stamped) as i32).max(0) as u32;
        self.stamped = self.stamped.wrapping_add(passed);
        self.rest += passed;
        self.micros += u64::from(self.rest / unit);
        self.rest %= unit;
        let lost = core::mem::take(&mut self.lost);
        Timing {
            micros: self.micros,
            period_ns: self.period_ns(),
            lost,
            locked: self.is_locked(),
        }
    }

    fn period_ns(&self) -> u32 {
        // Nanoseconds in 1/256 tick, with 24 bits behind the point.
        let unit = u64::from((1000 << 16) / self.ticks_per_us);
        ((u64::from(self.period) * unit) >> 24) as u32
    }
}
