//! Measurements of the AK8963: when they end, what they hold, and which of them are seen (data sheet, section 6.4).

use std::sync::Arc;

use super::super::part::Magnetic;
use crate::motion::Motion;
use crate::random::{mix, normal_pair};
use crate::time::{self, MICROSECOND, SECOND, Ticks};

const DRDY: u8 = 1 << 0;
const DOR: u8 = 1 << 1;
const HOFL: u8 = 1 << 3;
const BITM: u8 = 1 << 4;

/// Time for a measurement (section 5.3.3, TSM: 7.2 ms typical, 9 ms at most).
const DURATION: Ticks = 7_200 * MICROSECOND;
/// Weight of a count (µT) and largest count, in 16 and in 14 bits (sections 5.3.3 and 8.3.4).
const SIXTEEN: (f64, f64) = (0.15, 32_760.0);
const FOURTEEN: (f64, f64) = (0.6, 8_190.0);
/// |X| + |Y| + |Z| from which the sensor overflows (µT, section 6.4.3.6).
const OVERFLOW: f64 = 4_912.0;
/// Field of the internal magnetic source along z (µT): the middle of the criterion of section 6.4.5.
const SELF_TEST_FIELD: f64 = -300.0;

/// The measuring part of the magnetometer.
#[derive(Debug, Clone)]
pub struct Measurement {
    motion: Arc<dyn Motion>,
    /// Its errors.
    pub part: Magnetic,
    seed: u64,
    sixteen_bits: bool,
    actuated: bool,
    broken: bool,
    /// When measuring began, and how often it is repeated (Hz).
    running: Option<(Ticks, Option<u64>)>,
    /// Measurements that have ended since.
    ended: u64,
    data: [i16; 3],
    ready: bool,
    overrun: bool,
    overflow: bool,
    /// Data is being read and must not change.
    protected: bool,
}

impl Measurement {
    /// Nothing measured yet.
    pub fn new(motion: Arc<dyn Motion>, part: Magnetic, seed: u64) -> Measurement {
        Measurement {
            motion,
            part,
            seed,
            sixteen_bits: false,
            actuated: false,
            broken: false,
            running: None,
            ended: 0,
            data: [0; 3],
            ready: false,
            overrun: false,
            overflow: false,
            protected: false,
        }
    }

    /// Everything as after power-on.
    pub fn reset(&mut self) {
        *self = Measurement::new(Arc::clone(&self.motion), self.part, self.seed);
    }

    /// How the next measurements are made: width, self-test field, and whether ASTC spoils them.
    pub fn configure(&mut self, sixteen_bits: bool, actuated: bool, broken: bool) {
        self.sixteen_bits = sixteen_bits;
        self.actuated = actuated;
        self.broken = broken;
    }

    /// Begins at `now`, once or `hz` times a second.
    pub fn start(&mut self, now: Ticks, hz: Option<u64>) {
        self.running = Some((now, hz));
        self.ended = 0;
    }

    /// Ends measuring.
    pub fn stop(&mut self) {
        self.running = None;
        self.protected = false;
    }

    /// Stores what has been measured up to `now`; `true` once a single measurement has ended.
    pub fn advance(&mut self, now: Ticks) -> bool {
        let Some((since, hz)) = self.running else {
            return false;
        };
        // By its own clock.
        let passed = (now.saturating_sub(since) as f64 * (1.0 + self.part.clock_error)) as Ticks;
        let Some(passed) = passed.checked_sub(DURATION) else {
            return false;
        };
        let ended = hz.map_or(1, |hz| passed * hz / SECOND + 1);
        // The auxiliary master may already have looked a transfer's time ahead.
        let new = ended.saturating_sub(self.ended);
        if new == 0 {
            return false;
        }
        self.ended = ended;
        if self.protected {
            self.overrun = true;
            return false;
        }
        // A measurement nobody read is overwritten; in single mode that is no overrun (section 8.3.3).
        self.overrun |= hz.is_some() && (self.ready || new > 1);
        let begin = hz.map_or(0, |hz| (ended - 1) * SECOND / hz);
        self.measure(since + (begin as f64 / (1.0 + self.part.clock_error)) as Ticks);
        if hz.is_none() {
            self.running = None;
        }
        hz.is_none()
    }

    fn measure(&mut self, begin: Ticks) {
        // The field in the middle of the measurement, in the magnetometer's axes: x and y exchanged, z downwards
        // (MPU-9250 product specification, section 9.1).
        let t = time::seconds(begin + DURATION / 2);
        let [x, y, z] = self.motion.at(t).magnetic_field();
        let field = if self.actuated {
            // The internal source alone, or no working part would meet the criterion in the Earth's field.
            [0.0, 0.0, SELF_TEST_FIELD]
        } else {
            let [a, b] = normal_pair(mix(self.seed), begin, 0);
            let [c, _] = normal_pair(mix(self.seed), begin, 1);
            let (felt, noise) = ([y, x, -z], [a, b, c]);
            std::array::from_fn(|i| {
                felt[i] * (1.0 + self.part.scale[i])
                    + self.part.offset[i]
                    + noise[i] * self.part.noise
            })
        };
        self.overflow = field.iter().map(|axis| axis.abs()).sum::<f64>() >= OVERFLOW;
        let (weight, largest) = if self.sixteen_bits { SIXTEEN } else { FOURTEEN };
        self.data = std::array::from_fn(|axis| {
            let adjustment = (f64::from(self.part.adjustment[axis]) - 128.0) * 0.5 / 128.0 + 1.0;
            let counts = field[axis] / adjustment / weight;
            counts.round().clamp(-largest, largest) as i16
        });
        if self.broken {
            self.data = [0; 3];
        }
        self.ready = true;
    }

    /// ST1.
    pub fn status(&self) -> u8 {
        let bit = |on: bool, bit: u8| if on { bit } else { 0 };
        bit(self.ready, DRDY) | bit(self.overrun, DOR)
    }

    /// Whether data that was read before has been held from a later measurement.
    pub fn is_stale(&self) -> bool {
        self.protected && self.overrun
    }

    /// A byte of HXL to HZH. Where there are more measurements to come, the data is held until ST2 is read.
    pub fn read_data(&mut self, index: u8, protects: bool) -> u8 {
        // While a measurement is held back, its overrun stays to be seen.
        if !self.protected {
            self.overrun = false;
        }
        self.ready = false;
        self.protected |= protects;
        self.data[usize::from(index / 2)].to_le_bytes()[usize::from(index % 2)]
    }

    /// ST2, which ends reading.
    pub fn read_end(&mut self, sixteen_bits: bool) -> u8 {
        if !self.protected {
            self.overrun = false;
        }
        self.ready = false;
        self.protected = false;
        let overflow = if self.overflow { HOFL } else { 0 };
        overflow | if sixteen_bits { BITM } else { 0 }
    }
}
