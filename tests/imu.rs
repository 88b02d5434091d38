//! The set-up of the sensor is these bytes, and whatever goes wrong with it is said plainly.

use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};
use embedded_hal_mock::eh1::delay::NoopDelay;
use embedded_hal_mock::eh1::i2c::{Mock, Transaction};
use vrduino::imu::{self, ImuError, Part};
use vrduino::sensor::{AccelRange, GyroRange, Ranges};

const IMU: u8 = 0x68;
const NACK: ErrorKind = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address);

fn write(register: u8, value: u8) -> Transaction {
    Transaction::write(IMU, vec![register, value])
}

fn read(register: u8, values: &[u8]) -> Transaction {
    Transaction::write_read(IMU, vec![register], values.to_vec())
}

/// Register map RM-MPU-9250A-00; the order is that of `mpu9250` 0.25.
fn set_up(who_am_i: u8) -> Vec<Transaction> {
    vec![
        write(0x27, 0x00),   // I2C_SLV0_CTRL: the auxiliary bus stops; errors are ignored
        write(0x34, 0x00),   // I2C_SLV4_CTRL: the same
        write(0x6B, 0x80),   // PWR_MGMT_1: H_RESET
        write(0x6B, 0x01),   // PWR_MGMT_1: awake, best clock there is
        write(0x6C, 0x00),   // PWR_MGMT_2: all axes on
        read(0x1B, &[0x00]), // GYRO_CONFIG ...
        write(0x1B, 0x18),   // ... ±2000 °/s
        read(0x1B, &[0x18]), // GYRO_CONFIG ...
        write(0x1B, 0x18),   // ... with the filter
        read(0x1A, &[0x00]), // CONFIG ...
        write(0x1A, 0x01),   // ... filter 1: 184 Hz at 1 kHz
        read(0x1C, &[0x00]), // ACCEL_CONFIG ...
        write(0x1C, 0x18),   // ... ±16 g
        write(0x1D, 0x41),   // ACCEL_CONFIG_2: filter 1
        write(0x19, 0x00),   // SMPLRT_DIV: every sample
        write(0x38, 0x00),   // INT_ENABLE: none
        read(0x75, &[who_am_i]), // WHO_AM_I
        read(0x38, &[0x00]), // INT_ENABLE ...
        write(0x38, 0x01),   // ... RAW_RDY_EN
    ]
}

fn read_back() -> Vec<Transaction> {
    vec![read(0x1A, &[0x01, 0x18, 0x18, 0x41]), read(0x19, &[0x00])]
}

fn configure(script: &[Transaction]) -> Result<Ranges, ImuError<ErrorKind>> {
    let mut bus = Mock::new(script);
    let result = imu::configure(&mut bus, &mut NoopDelay::new());
    bus.done();
    result
}

#[test]
fn set_up_is_these_bytes() {
    let script = [set_up(0x71), read_back()].concat();
    let expected = Ranges {
        gyro: GyroRange::Dps2000,
        accel: AccelRange::G16,
    };
    assert_eq!(configure(&script), Ok(expected));
}

#[test]
fn the_three_parts_with_these_registers_are_welcome() {
    for (id, part) in [
        (0x71, Part::Mpu9250),
        (0x73, Part::Mpu9255),
        (0x70, Part::Mpu6500),
    ] {
        let mut bus = Mock::new(&[read(0x75, &[id])]);
        assert_eq!(imu::probe(&mut bus), Ok(part));
        bus.done();
        assert!(configure(&[set_up(id), read_back()].concat()).is_ok());
    }
}

#[test]
fn any_other_part_is_named_and_refused() {
    for id in (0..=u8::MAX).filter(|id| ![0x70, 0x71, 0x73].contains(id)) {
        let mut bus = Mock::new(&[read(0x75, &[id])]);
        assert_eq!(imu::probe(&mut bus), Err(ImuError::UnknownPart(id)));
        bus.done();
    }
    let up_to_who_am_i: Vec<_> = set_up(0xEA).into_iter().take(17).collect();
    assert_eq!(configure(&up_to_who_am_i), Err(ImuError::UnknownPart(0xEA)));
}

#[test]
fn silence_is_no_answer_at_every_step() {
    let whole = [set_up(0x71), read_back()].concat();
    // The first two are allowed to fail (see the next test).
    for step in 2..whole.len() {
        let mut script: Vec<_> = whole.iter().take(step + 1).cloned().collect();
        script[step] = script[step].clone().with_error(NACK);
        assert_eq!(
            configure(&script),
            Err(ImuError::NoAnswer(NACK)),
            "step {step}"
        );
    }
    let mut bus = Mock::new(&[read(0x75, &[0]).with_error(NACK)]);
    assert_eq!(imu::probe(&mut bus), Err(ImuError::NoAnswer(NACK)));
    bus.done();
    let mut bus = Mock::new(&[read(0x3A, &[0; 15]).with_error(NACK)]);
    assert_eq!(imu::read_sample(&mut bus), Err(ImuError::NoAnswer(NACK)));
    bus.done();
}

#[test]
fn the_auxiliary_bus_may_fail_to_stop() {
    let mut script = [set_up(0x71), read_back()].concat();
    for transaction in script.iter_mut().take(2) {
        *transaction = transaction.clone().with_error(NACK);
    }
    assert!(configure(&script).is_ok());
}

#[test]
fn a_register_that_did_not_take_its_value_is_named() {
    // (register, wrote, what is read there instead)
    for (register, wrote, found) in [
        (0x1A, 0x01, 0x00),
        (0x1A, 0x01, 0x41),
        (0x1B, 0x18, 0x00), // back at ±250 °/s after a dip of the supply
        (0x1B, 0x18, 0x1B),
        (0x1B, 0x18, 0x98), // self-test left on
        (0x1C, 0x18, 0x00),
        (0x1D, 0x01, 0x00),
        (0x1D, 0x01, 0x09),
    ] {
        let mut values = [0x01, 0x18, 0x18, 0x41];
        values[usize::from(register) - 0x1A] = found;
        let script = [set_up(0x71), vec![read(0x1A, &values)]].concat();
        let expected = ImuError::NotConfigured {
            register,
            wrote,
            read: found,
        };
        assert_eq!(configure(&script), Err(expected));
    }
    let mut bus = Mock::new(&[read(0x1A, &[0x01, 0x18, 0x18, 0x01]), read(0x19, &[0x04])]);
    let expected = ImuError::NotConfigured {
        register: 0x19,
        wrote: 0x00,
        read: 0x04,
    };
    assert_eq!(imu::verify(&mut bus), Err(expected));
    bus.done();
}

#[test]
fn bits_without_a_meaning_are_not_judged() {
    // ACCEL_CONFIG_2 bit 6 is reserved on the MPU-9250 and a FIFO setting on the MPU-6500.
    for value in [0x01, 0x41] {
        let mut bus = Mock::new(&[read(0x1A, &[0x01, 0x18, 0x18, value]), read(0x19, &[0x00])]);
        assert_eq!(imu::verify(&mut bus), Ok(()));
        bus.done();
    }
}

#[test]
fn a_sample_is_one_burst() {
    let bytes = [1, 0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0, 7];
    let mut bus = Mock::new(&[read(0x3A, &bytes)]);
    let raw = imu::read_sample(&mut bus).expect("the bus answers");
    bus.done();
    assert_eq!(raw.accel, [1, 2, 3]);
    assert_eq!(raw.gyro, [5, 6, 7]);
    assert!(raw.fresh);
}

#[test]
fn every_error_is_a_sentence_that_fits_a_line() {
    let errors = [
        ImuError::NoAnswer(NACK),
        ImuError::UnknownPart(0xEA),
        ImuError::NotConfigured {
            register: 0x1B,
            wrote: 0x18,
            read: 0x00,
        },
        ImuError::SetUp,
    ];
    for error in errors {
        let sentence = error.to_string();
        assert!(sentence.len() <= 90, "{} bytes: {sentence}", sentence.len());
    }
    assert_eq!(
        ImuError::NoAnswer(NACK).to_string(),
        "no IMU answers at I2C address 0x68: check 3V3, GND, SDA 18, SCL 19"
    );
}
