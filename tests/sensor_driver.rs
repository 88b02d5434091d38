//! The emulated sensor is accepted by a driver that nobody here wrote: the crate `mpu9250`, with all nine axes.
//!
//! The firmware uses that crate for its set-up only; here it goes the whole way, through the bypass to the
//! magnetometer and its fuse ROM.

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

use embedded_hal_compat::eh0_2::blocking::delay::DelayMs;
use embedded_hal_compat::eh0_2::blocking::i2c;
use mpu9250::{AccelScale, Dlpf, GyroScale, GyroTempDataRate, MargMeasurements, MpuConfig};
use vrduino_emulator::motion::{Instant, Motion};
use vrduino_emulator::mpu9250::part::Magnetic;
use vrduino_emulator::mpu9250::{Mpu9250, Part};
use vrduino_emulator::peripherals::i2c::Target;
use vrduino_emulator::time::{self, MILLISECOND, Ticks};

/// A byte on a 400 kHz bus (s).
const BYTE: f64 = 22.5e-6;

/// The sensor and the time, shared by the driver's bus and its delay.
#[derive(Clone)]
struct Desk(Rc<RefCell<(Mpu9250, Ticks)>>);

#[derive(Debug)]
struct NoAnswer;

impl Desk {
    fn new(motion: impl Motion + 'static, part: Part) -> Desk {
        let sensor = Mpu9250::new(Arc::new(motion), part);
        Desk(Rc::new(RefCell::new((sensor, 100 * MILLISECOND))))
    }

    /// One byte later.
    fn with<T>(&self, act: impl FnOnce(&mut Mpu9250, Ticks) -> T) -> T {
        let (sensor, now) = &mut *self.0.borrow_mut();
        *now += time::ticks(BYTE);
        act(sensor, *now)
    }

    fn begin(&self, byte: u8) -> Result<(), NoAnswer> {
        let answers = self.with(|sensor, now| sensor.address(byte, now));
        answers.then_some(()).ok_or(NoAnswer)
    }

    fn send(&self, bytes: &[u8]) -> Result<(), NoAnswer> {
        for byte in bytes {
            let taken = self.with(|sensor, now| sensor.write(*byte, now));
            taken.then_some(()).ok_or(NoAnswer)?;
        }
        Ok(())
    }
}

impl i2c::Write for Desk {
    type Error = NoAnswer;

    fn write(&mut self, address: u8, bytes: &[u8]) -> Result<(), NoAnswer> {
        let result = self.begin(address << 1).and_then(|()| self.send(bytes));
        self.with(|sensor, _| sensor.stop());
        result
    }
}

impl i2c::Read for Desk {
    type Error = NoAnswer;

    fn read(&mut self, address: u8, buffer: &mut [u8]) -> Result<(), NoAnswer> {
        let result = self.begin(address << 1 | 1);
        if result.is_ok() {
            buffer.fill_with(|| self.with(|sensor, now| sensor.read(now)));
        }
        self.with(|sensor, _| sensor.stop());
        result
    }
}

impl i2c::WriteRead for Desk {
    type Error = NoAnswer;

    fn write_read(&mut self, address: u8, bytes: &[u8], buffer: &mut [u8]) -> Result<(), NoAnswer> {
        self.begin(address << 1)?;
        self.send(bytes)?;
        i2c::Read::read(self, address, buffer)
    }
}

impl DelayMs<u8> for Desk {
    fn delay_ms(&mut self, ms: u8) {
        self.0.borrow_mut().1 += Ticks::from(ms) * MILLISECOND;
    }
}

/// Always the same.
struct Steady(Instant);

impl Motion for Steady {
    fn at(&self, _: f64) -> Instant {
        self.0
    }

    fn duration(&self) -> Option<f64> {
        None
    }

    fn describe(&self) -> String {
        "always the same".into()
    }
}

fn close(found: [f32; 3], expected: [f64; 3], tolerance: f64) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert!(
            (f64::from(found) - expected).abs() < tolerance,
            "{found} for {expected}"
        );
    }
}

#[test]
fn all_nine_axes_are_read_in_their_units() {
    let felt = Instant {
        rate: [0.5, -1.0, 2.0],
        force: [1.0, 9.0, -3.0],
        field: Some([12.0, -30.0, 24.0]),
        truth: None,
    };
    // The driver subtracts 128 from ASA without a sign: it can only do with parts from there on.
    let part = Part {
        magnetic: Magnetic {
            adjustment: [178, 128, 150],
            ..Part::perfect().magnetic
        },
        ..Part::perfect()
    };
    let desk = Desk::new(Steady(felt), part);
    let mut config = MpuConfig::marg();
    config
        .gyro_scale(GyroScale::_500DPS)
        .accel_scale(AccelScale::_4G)
        .gyro_temp_data_rate(GyroTempDataRate::DlpfConf(Dlpf::_2));
    let mut driver = mpu9250::Mpu9250::marg(desk.clone(), &mut desk.clone(), &mut config)
        .expect("the driver finds its sensor");
    assert_eq!(driver.who_am_i().unwrap(), 0x71);
    assert_eq!(driver.ak8963_who_am_i().unwrap(), 0x48);
    desk.clone().delay_ms(100);

    let MargMeasurements {
        accel,
        gyro,
        mag,
        temp,
    } = driver.all::<[f32; 3]>().unwrap();
    close(accel, felt.force, 0.003);
    close(gyro, felt.rate, 0.001);
    // Its unit is milligauss, and it leaves the magnetometer's axes as they are: y, x, -z of the body.
    close(mag, [-300.0, 120.0, -240.0], 2.0);
    assert!((temp - 25.0).abs() < 0.1, "{temp} °C");

    let complaints = desk.0.borrow_mut().0.complaints.take();
    assert_eq!(complaints, []);
}
