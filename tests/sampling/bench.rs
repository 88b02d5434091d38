//! A sensor with a clock of its own, and a board that asks it as the loop says.

use vrduino::sampling::Timing;
use vrduino::sampling::data_ready::{DataReady, Early};

use crate::random::Random;

/// From one status to the next that was asked for at once, in microseconds.
pub const ASK_US: f64 = 126.0;
/// From a status that said yes to the earliest next one: the rest of the burst, and the way to the next status.
const BURST_US: f64 = 440.0;

/// When samples are ready. Times in microseconds.
pub struct Sensor {
    next: f64,
    error: f64,
    /// Change of the error in a second.
    pub drift: f64,
    /// Standard deviation of each data-ready about its place.
    pub jitter_us: f64,
    random: Random,
    /// The next one, jitter included.
    ready: f64,
    /// The last that was ready.
    last: f64,
    /// Samples since the last read.
    unread: u32,
}

impl Sensor {
    /// With an oscillator that is off by this much, and its first sample at this part of a millisecond.
    pub fn new(error: f64, phase: f64) -> Self {
        let first = 1000.0 * phase;
        Self {
            next: first,
            error,
            drift: 0.0,
            jitter_us: 0.0,
            random: Random(7),
            ready: first,
            last: 0.0,
            unread: 0,
        }
    }

    /// All that follow come earlier or later by this.
    pub fn jump(&mut self, us: f64) {
        self.next += us;
        self.ready += us;
    }

    fn advance(&mut self, now: f64) {
        while self.ready <= now {
            self.last = self.ready;
            self.unread += 1;
            let error = self.error + self.drift * now / 1e6;
            self.next += 1000.0 / (1.0 + error);
            // Twelve uniform numbers make a normal one.
            let normal = (0..12).map(|_| self.random.unit()).sum::<f64>() - 6.0;
            self.ready = self.next + self.jitter_us * normal.clamp(-4.0, 4.0);
        }
    }

    /// Reads the status: how many samples were ready since it was read last.
    fn status(&mut self, now: f64) -> u32 {
        self.advance(now);
        std::mem::take(&mut self.unread)
    }
}

/// What has happened, and what the loop has told of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    pub read: u32,
    pub lost: u32,
    pub told_lost: u32,
    pub repeated: u32,
    pub in_vain: u32,
}

impl Counts {
    pub fn since(self, before: Self) -> Self {
        Self {
            read: self.read - before.read,
            lost: self.lost - before.lost,
            told_lost: self.told_lost - before.told_lost,
            repeated: self.repeated - before.repeated,
            in_vain: self.in_vain - before.in_vain,
        }
    }
}

/// The board.
pub struct Bench {
    pub ready: DataReady,
    pub sensor: Sensor,
    pub last: Timing,
    /// The longest that the moment of a status is noted too late.
    pub service_us: f64,
    /// Time stamp less data-ready, for every sample.
    pub errors_us: Vec<f64>,
    /// From data-ready to the status that said so.
    pub delays_us: Vec<f64>,
    ticks_per_us: f64,
    now: f64,
    random: Random,
    failing: u32,
    counts: Counts,
}

impl Bench {
    pub fn new(sensor: Sensor) -> Self {
        Self::with_clock(sensor, 36)
    }

    pub fn with_clock(sensor: Sensor, ticks_per_us: u32) -> Self {
        let mut ready = DataReady::new(ticks_per_us);
        // Not at a round time, and just before the clock wraps.
        let now = (f64::from(u32::MAX) / f64::from(ticks_per_us)).floor() - 700_003.0;
        let mut sensor = sensor;
        sensor.jump(now);
        ready.start(ticks(now, f64::from(ticks_per_us)), now as u64);
        Self {
            ready,
            sensor,
            last: Timing::default(),
            service_us: 0.0,
            errors_us: Vec::new(),
            delays_us: Vec::new(),
            ticks_per_us: f64::from(ticks_per_us),
            now,
            random: Random(11),
            failing: 0,
            counts: Counts::default(),
        }
    }

    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Lets the next reads fail.
    pub fn fail_next(&mut self, reads: u32) {
        self.failing = reads;
    }

    /// Stops the sensor, which goes on later, at another phase.
    pub fn pause(&mut self, seconds: f64, phase: f64) {
        self.sensor.jump(seconds * 1e6 + 1000.0 * phase);
    }

    pub fn run(&mut self, seconds: f64) {
        let until = self.now + seconds * 1e6;
        while self.now < until {
            self.turn();
        }
    }

    /// Reads once a millisecond by a clock of its own.
    pub fn run_by_the_host(&mut self, seconds: f64) {
        for _ in 0..(seconds * 1e3) as u32 {
            self.now += 1000.0;
            let found = self.sensor.status(self.now);
            let at = self.noted();
            let timing = self.ready.read_at(at, found > 0);
            if found == 0 {
                self.counts.repeated += 1;
                continue;
            }
            self.counts.read += 1;
            self.counts.lost += found - 1;
            self.counts.told_lost += timing.lost;
            self.errors_us
                .push(timing.micros as f64 + 0.5 - self.sensor.last);
        }
    }

    /// The moment, as the board notes it.
    fn noted(&mut self) -> u32 {
        let late = self.service_us * self.random.unit();
        ticks(self.now + late, self.ticks_per_us)
    }

    fn turn(&mut self) {
        let wait = self
            .ready
            .ticks_until_ask(ticks(self.now, self.ticks_per_us));
        assert!(
            f64::from(wait) < 2100.0 * self.ticks_per_us,
            "waits for ever"
        );
        self.now += f64::from(wait) / self.ticks_per_us;
        if self.failing > 0 {
            self.failing -= 1;
            self.counts.told_lost += self.ready.miss().lost;
            self.now += 100.0;
            return;
        }
        let found = self.sensor.status(self.now);
        let at = self.noted();
        if found == 0 {
            self.counts.in_vain += 1;
            match self.ready.not_yet(at) {
                Early::Again => {}
                Early::Repeat(timing) => {
                    self.counts.repeated += 1;
                    self.last = timing;
                }
            }
            self.now += ASK_US;
            return;
        }
        let timing = self.ready.new_sample(at);
        self.counts.read += 1;
        self.counts.lost += found - 1;
        self.counts.told_lost += timing.lost;
        self.errors_us
            .push(timing.micros as f64 + 0.5 - self.sensor.last);
        self.delays_us.push(self.now - self.sensor.last);
        self.last = timing;
        self.now += BURST_US;
    }
}

/// What a clock of 32 bits shows.
fn ticks(us: f64, per_us: f64) -> u32 {
    (us * per_us) as u64 as u32
}
