//! A driver without a bus in between, and motions to feed its sensor.

use std::sync::Arc;

use vrduino_emulator::motion::{Instant, Motion};
use vrduino_emulator::mpu9250::complaint::Complaint;
use vrduino_emulator::mpu9250::{Mpu9250, Part};
use vrduino_emulator::peripherals::i2c::Target;
use vrduino_emulator::time::{self, MILLISECOND, SECOND, Ticks};

pub const MPU: u8 = 0x68;
pub const AK: u8 = 0x0C;

/// Standard gravity (m/s²).
pub const G: f64 = 9.806_65;

/// Anything a test wants to feel: a function of time (s).
pub struct Feeling<F>(pub F);

impl<F: Fn(f64) -> Instant + Send + Sync> Motion for Feeling<F> {
    fn at(&self, t: f64) -> Instant {
        (self.0)(t)
    }

    fn duration(&self) -> Option<f64> {
        None
    }

    fn describe(&self) -> String {
        "a feeling".into()
    }
}

/// Nothing: no rate, no force, no field.
pub const NOTHING: Instant = Instant {
    rate: [0.0; 3],
    force: [0.0; 3],
    field: Some([0.0; 3]),
    truth: None,
};

/// About x: `f(t)` in °/s, and `f(t)` in g along x.
pub fn about_x(f: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Arc<dyn Motion> {
    Arc::new(Feeling(move |t| Instant {
        rate: [f(t).to_radians(), 0.0, 0.0],
        force: [f(t) * G, 0.0, 0.0],
        ..NOTHING
    }))
}

/// The same for ever.
pub fn constant(instant: Instant) -> Arc<dyn Motion> {
    Arc::new(Feeling(move |_| instant))
}

/// A constant field (µT) along the body axes.
pub fn in_field(field: [f64; 3]) -> Arc<dyn Motion> {
    constant(Instant {
        field: Some(field),
        ..NOTHING
    })
}

pub fn at_rest() -> Arc<dyn Motion> {
    constant(NOTHING)
}

pub struct Driver {
    pub sensor: Mpu9250,
    pub now: Ticks,
}

impl Driver {
    /// A sensor that was powered 100 ms ago.
    pub fn new(motion: Arc<dyn Motion>, part: Part) -> Driver {
        Driver {
            sensor: Mpu9250::new(motion, part),
            now: 100 * MILLISECOND,
        }
    }

    pub fn perfect(motion: Arc<dyn Motion>) -> Driver {
        Driver::new(motion, Part::perfect())
    }

    pub fn wait(&mut self, seconds: f64) {
        self.now += time::ticks(seconds);
    }

    /// Waits for `n` periods of `hz`, exactly.
    pub fn wait_periods(&mut self, n: u64, hz: u64) {
        self.now += n * SECOND / hz;
    }

    /// Writes registers of the device at an address; `false` if any byte was refused.
    pub fn write_to(&mut self, address: u8, bytes: &[u8]) -> bool {
        let mut taken = self.sensor.address(address << 1, self.now);
        for byte in bytes {
            taken = taken && self.sensor.write(*byte, self.now);
        }
        self.sensor.stop();
        taken
    }

    /// Reads registers of the device at an address, or nothing if it does not answer.
    pub fn read_from(&mut self, address: u8, register: u8, count: usize) -> Option<Vec<u8>> {
        let answers = self.sensor.address(address << 1, self.now)
            && self.sensor.write(register, self.now)
            && self.sensor.address(address << 1 | 1, self.now);
        let bytes = answers.then(|| (0..count).map(|_| self.sensor.read(self.now)).collect());
        self.sensor.stop();
        bytes
    }

    pub fn write(&mut self, register: u8, value: u8) {
        assert!(self.write_to(MPU, &[register, value]));
    }

    pub fn read(&mut self, register: u8) -> u8 {
        self.read_many(register, 1)[0]
    }

    pub fn read_many(&mut self, register: u8, count: usize) -> Vec<u8> {
        self.read_from(MPU, register, count)
            .expect("the sensor answers")
    }

    pub fn words(&mut self, register: u8, count: usize) -> Vec<i16> {
        big_endian(&self.read_many(register, 2 * count))
    }

    pub fn accel(&mut self) -> Vec<i16> {
        self.words(0x3B, 3)
    }

    pub fn gyro(&mut self) -> Vec<i16> {
        self.words(0x43, 3)
    }

    pub fn fifo_count(&mut self) -> usize {
        let count = self.read_many(0x72, 2);
        usize::from(count[0]) << 8 | usize::from(count[1])
    }

    /// Widest ranges, filters 1 and 1, 1 kHz.
    pub fn set_up(&mut self) {
        self.write(0x6B, 0x01);
        self.write(0x1B, 0x18);
        self.write(0x1C, 0x18);
        self.write(0x1A, 0x01);
        self.write(0x1D, 0x01);
        self.wait(0.1);
    }

    /// Magnetometer on the main bus.
    pub fn bypass(&mut self) {
        self.write(0x37, 0x02);
    }

    pub fn complaints(&self) -> Vec<Complaint> {
        let list = self.sensor.complaints.list();
        list.iter().map(|(_, complaint)| *complaint).collect()
    }
}

pub fn big_endian(bytes: &[u8]) -> Vec<i16> {
    bytes
        .as_chunks::<2>()
        .0
        .iter()
        .map(|word| i16::from_be_bytes(*word))
        .collect()
}

pub fn little_endian(bytes: &[u8]) -> Vec<i16> {
    bytes
        .as_chunks::<2>()
        .0
        .iter()
        .map(|word| i16::from_le_bytes(*word))
        .collect()
}

/// Mean and standard deviation.
pub fn statistics(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square = values
        .iter()
        .map(|value| (value - mean).powi(2))
        .sum::<f64>();
    (mean, (square / n).sqrt())
}
