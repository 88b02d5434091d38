//! The magnetometer's set-up is these bytes, whatever goes wrong with it is said plainly, and it is
//! asked so that no measurement is lost and none is taken twice.

use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};
use embedded_hal_mock::eh1::delay::{CheckedDelay, NoopDelay, Transaction as Wait};
use embedded_hal_mock::eh1::i2c::{Mock, Transaction};
use vrduino::imu::magnetometer::polling::{
    ANSWER_LEN, GIVEN_UP_AFTER, Loss, Measured, Polling, Request,
};
use vrduino::imu::magnetometer::{self, MagnetometerError};
use vrduino::sensor::magnetometer::SensitivityAdjustment;
use vrduino::wire;

const IMU: u8 = 0x68;
const AK: u8 = 0x0C;
const NACK: ErrorKind = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address);

type Adjusted = Result<SensitivityAdjustment, MagnetometerError<ErrorKind>>;

fn write(address: u8, register: u8, value: u8) -> Transaction {
    Transaction::write(address, vec![register, value])
}

fn read(register: u8, values: &[u8]) -> Transaction {
    Transaction::write_read(AK, vec![register], values.to_vec())
}

/// Register map RM-MPU-9250A-00, 4.20 and 4.33; AK8963 data sheet MS1356-E-02, section 8.
fn script() -> Vec<Transaction> {
    vec![
        write(IMU, 0x6A, 0x00),       // USER_CTRL: auxiliary master off
        write(IMU, 0x37, 0x02),       // INT_PIN_CFG: BYPASS_EN
        read(0x00, &[0x48]),          // WIA
        write(AK, 0x0B, 0x01),        // CNTL2: soft reset
        write(AK, 0x0A, 0x0F),        // CNTL1: fuse ROM access
        read(0x10, &[176, 128, 100]), // ASAX to ASAZ
        write(AK, 0x0A, 0x00),        // CNTL1: power-down
        write(AK, 0x0A, 0x16),        // CNTL1: 100 Hz, 16 bits
        read(0x0A, &[0x16]),          // CNTL1
    ]
}

/// What is done once something failed.
fn closed() -> Transaction {
    write(IMU, 0x37, 0x00)
}

fn set_up(script: &[Transaction]) -> Adjusted {
    let mut bus = Mock::new(script);
    let result = magnetometer::set_up(&mut bus, &mut NoopDelay::new());
    bus.done();
    result
}

#[test]
fn set_up_is_these_bytes_and_keeps_the_pauses_of_the_data_sheet() {
    let mut bus = Mock::new(&script());
    // Twice out of power-down, by which 100 µs must have passed.
    let mut delay = CheckedDelay::new(&[Wait::delay_us(200), Wait::delay_us(200)]);
    let result = magnetometer::set_up(&mut bus, &mut delay);
    bus.done();
    delay.done();
    let asa = SensitivityAdjustment::from_fuse_rom([176, 128, 100]);
    assert_eq!(result, Ok(asa));
    let factors = asa.factors::<f64>();
    assert_eq!(factors.as_slice(), [1.1875, 1.0, 0.890_625]);
}

#[test]
fn silence_at_any_step_is_no_answer_and_closes_the_bypass() {
    for step in 0..script().len() {
        let mut script: Vec<_> = script().into_iter().take(step + 1).collect();
        script[step] = script[step].clone().with_error(NACK);
        script.push(closed());
        let expected = Err(MagnetometerError::NoAnswer(NACK));
        assert_eq!(set_up(&script), expected, "step {step}");
    }
}

#[test]
fn a_bypass_that_does_not_close_does_not_hide_the_first_error() {
    let script = [
        write(IMU, 0x6A, 0x00),
        write(IMU, 0x37, 0x02),
        read(0x00, &[0xFF]),
        closed().with_error(NACK),
    ];
    assert_eq!(set_up(&script), Err(MagnetometerError::UnknownPart(0xFF)));
}

#[test]
fn every_other_identity_is_refused() {
    for id in (0..=u8::MAX).filter(|&id| id != 0x48) {
        let mut script: Vec<_> = script().into_iter().take(2).collect();
        script.extend([read(0x00, &[id]), closed()]);
        assert_eq!(set_up(&script), Err(MagnetometerError::UnknownPart(id)));
    }
}

#[test]
fn a_blank_fuse_rom_is_no_sensitivity() {
    for asa in [[0; 3], [255; 3], [0, 176, 170], [176, 170, 255]] {
        let mut script: Vec<_> = script().into_iter().take(5).collect();
        script.extend([read(0x10, &asa), write(AK, 0x0A, 0x00), closed()]);
        assert_eq!(set_up(&script), Err(MagnetometerError::BlankFuseRom));
    }
    for asa in [[1; 3], [254; 3], [128; 3]] {
        let mut script = script();
        script[5] = read(0x10, &asa);
        let expected = Ok(SensitivityAdjustment::from_fuse_rom(asa));
        assert_eq!(set_up(&script), expected);
    }
}

#[test]
fn a_mode_that_was_not_taken_is_told() {
    for found in [0x00, 0x06, 0x12, 0xFF] {
        let mut script = script();
        script[8] = read(0x0A, &[found]);
        script.push(closed());
        let expected = Err(MagnetometerError::NotMeasuring { read: found });
        assert_eq!(set_up(&script), expected);
    }
}

#[test]
fn every_error_is_one_line() {
    for (error, line) in [
        (MagnetometerError::NoAnswer(NACK), "none"),
        (
            MagnetometerError::UnknownPart(0),
            "unknown part 0x00 at I2C address 0x0C, want 0x48",
        ),
        (MagnetometerError::BlankFuseRom, "its fuse ROM is blank"),
        (
            MagnetometerError::NotMeasuring { read: 6 },
            "register 0x0A holds 0x06, wrote 0x16",
        ),
        (MagnetometerError::Lost(Loss::Silent), "stopped answering"),
        (MagnetometerError::Lost(Loss::Frozen), "no new measurements"),
    ] {
        let expected = format!("Magnetometer: {line}, running on six axes\n");
        assert_eq!(wire::magnetometer_failed(&error).as_str(), expected);
    }
}

/// A magnetometer as its data sheet has it, with a clock of its own.
struct Part {
    /// Of measurements (samples of the board).
    period: f64,
    first: f64,
    /// Measurements that have ended.
    ended: u32,
    ready: bool,
    overrun: bool,
    /// Of every measurement that was read, its number.
    read: Vec<u32>,
}

impl Part {
    fn new(period: f64, first: f64) -> Self {
        Self {
            period,
            first,
            ended: 0,
            ready: false,
            overrun: false,
            read: Vec::new(),
        }
    }

    /// One that measures until `now`, and then answers.
    fn answer(&mut self, request: Request, now: f64) -> [u8; ANSWER_LEN] {
        while self.first + self.period * f64::from(self.ended) <= now {
            self.ended += 1;
            self.overrun = self.ready;
            self.ready = true;
        }
        let status = u8::from(self.ready) | u8::from(self.overrun) << 1;
        let [low, high] = (self.ended as u16).to_le_bytes();
        let bytes = [status, low, high & 0x7F, 0, 0, 0, 0, 0x10];
        match request {
            // What lies beyond was not asked for.
            Request::Status => [status, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA],
            Request::Measurement => {
                (self.ready, self.overrun) = (false, false);
                bytes
            }
        }
    }
}

/// Measurements, and how often the bus was used for what.
fn poll(part: &mut Part, samples: u32) -> (Vec<Measured>, u32, u32) {
    let mut polling = Polling::new();
    let (mut measured, mut questions, mut readings) = (Vec::new(), 0, 0);
    for sample in 0..samples {
        let Some(request) = polling.sample() else {
            continue;
        };
        match request {
            Request::Status => questions += 1,
            Request::Measurement => readings += 1,
        }
        let answer = part.answer(request, f64::from(sample) + 0.5);
        if let Some(one) = polling.answer(&answer) {
            part.read.push(part.ended);
            measured.push(one);
        }
    }
    (measured, questions, readings)
}

/// Whichever clock is fast, and at every phase between them: each measurement once and in order.
#[test]
fn every_measurement_is_taken_once() {
    for period in [9.01, 9.5, 9.9, 9.999, 10.0, 10.001, 10.1, 11.0, 12.5] {
        for phase in 0..20 {
            let mut part = Part::new(period, 7.2 + f64::from(phase) * 0.5);
            let (measured, questions, readings) = poll(&mut part, 10_000);
            let numbers: Vec<u32> = (1..=part.read.len() as u32).collect();
            assert_eq!(part.read, numbers, "{period} ms, phase {phase}");
            assert!(part.ended - part.read.len() as u32 <= 1);
            assert!(measured.iter().all(|one| !one.overrun));
            assert_eq!(readings as usize, measured.len(), "no reading in vain");
            assert!(f64::from(questions) <= f64::from(readings) * (period - 6.9) + 20.0);
            for (one, number) in measured.iter().zip(numbers) {
                assert_eq!(one.field.counts, [number as i16, 0, 0]);
            }
        }
    }
}

/// A magnetometer that is faster than anything it promises: what is lost shows as overrun.
#[test]
fn what_was_overwritten_is_told() {
    let mut part = Part::new(4.0, 1.0);
    let (measured, ..) = poll(&mut part, 1000);
    assert!(measured.len() > 90);
    assert!(measured.iter().skip(1).all(|one| one.overrun));
}

#[test]
fn overflow_comes_through() {
    let mut polling = Polling::new();
    assert_eq!(polling.sample(), Some(Request::Status));
    assert_eq!(polling.answer(&[1, 0, 0, 0, 0, 0, 0, 0]), None);
    assert_eq!(polling.sample(), Some(Request::Measurement));
    let measured = polling.answer(&[1, 0xF8, 0x7F, 0, 0, 0, 0, 0x18]).unwrap();
    assert_eq!(measured.field.counts, [32760, 0, 0]);
    assert!(measured.field.overflow && !measured.overrun);
}

/// Data of which only a part was read is held until ST2 is read: that has to come, and DRDY with it
/// says that there is nothing new in it.
#[test]
fn a_broken_reading_is_read_to_its_end_and_not_taken() {
    let mut polling = Polling::new();
    polling.sample();
    polling.answer(&[1, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(polling.sample(), Some(Request::Measurement));
    polling.refuse();
    assert_eq!(polling.sample(), Some(Request::Measurement));
    assert_eq!(polling.answer(&[2, 5, 0, 0, 0, 0, 0, 0x10]), None);
    assert_eq!(polling.sample(), Some(Request::Status));
    assert_eq!(polling.loss(), None);
}

#[test]
fn one_that_is_silent_or_frozen_is_given_up_after_half_a_second() {
    for (silent, loss) in [(true, Loss::Silent), (false, Loss::Frozen)] {
        let mut polling = Polling::new();
        for _ in 0..GIVEN_UP_AFTER {
            assert_eq!(polling.loss(), None);
            assert_eq!(polling.sample(), Some(Request::Status));
            if silent {
                polling.refuse();
            } else {
                assert_eq!(polling.answer(&[0; ANSWER_LEN]), None);
            }
        }
        assert_eq!(polling.loss(), Some(loss));
        assert_eq!(polling.sample(), None, "it is left alone");
    }
}

#[test]
fn single_failures_are_bridged() {
    let mut part = Part::new(10.0, 7.2);
    let mut polling = Polling::new();
    let mut measured = 0;
    for sample in 0..10_000 {
        let Some(request) = polling.sample() else {
            continue;
        };
        if sample % 7 == 0 {
            polling.refuse();
            continue;
        }
        let answer = part.answer(request, f64::from(sample) + 0.5);
        measured += u32::from(polling.answer(&answer).is_some());
    }
    assert_eq!(polling.loss(), None);
    assert!((995..=1000).contains(&measured), "{measured}");
}
