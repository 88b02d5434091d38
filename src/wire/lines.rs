//! The lines of the course's programs other than the quaternion's, and those for people.
//!
//! Numbers are rounded to the nearest decimal, halves away from zero, exactly (the value of the
//! float is what is rounded, not a product of it). Zero has no sign. A value of a million or more
//! is written as ±999999.999, infinities too, and what is not a number as 0.000: a receiver's
//! parser meets digits in every case, and nothing upstream should produce these.

use super::{Line, end, push, push_decimal, push_digits, text};
use crate::calibration::Rest;
use crate::orientation::angles::PitchRoll;
use crate::orientation::flatland::Roll;
use crate::units::{Angle, AngularRate, MagneticField, SpecificForce};
use core::fmt;
use nalgebra::Vector3;

/// `EA pitch yaw roll` in degrees, 3 decimals. Yaw is 0: these are the accelerometer's angles.
pub fn angles(tilt: &PitchRoll<f32>) -> Line {
    numbers("EA", &[tilt.pitch.degrees(), 0.0, tilt.roll.degrees()], 3)
}

/// `FLAT gyro accelerometer fused`: roll in degrees, 3 decimals.
pub fn flat(roll: &Roll<f32>) -> Line {
    let degrees = [roll.gyro, roll.accelerometer, roll.fused].map(Angle::degrees);
    numbers("FLAT", &degrees, 3)
}

/// `GYR: x y z` in °/s, 3 decimals, body frame.
pub fn gyro(rate: AngularRate<f32>) -> Line {
    vector("GYR:", rate.dps(), 3)
}

/// `ACC: x y z` in m/s², 3 decimals, body frame.
pub fn force(force: SpecificForce<f32>) -> Line {
    vector("ACC:", force.m_per_s2(), 3)
}

/// `GYR_BIAS: x y z` in °/s, 5 decimals: what is subtracted from every reading of the gyro.
pub fn gyro_bias(bias: AngularRate<f32>) -> Line {
    vector("GYR_BIAS:", bias.dps(), 5)
}

/// `GYR_VAR: x y z` in (°/s)², 5 decimals, over the window the bias is from.
pub fn gyro_variance(rest: &Rest) -> Line {
    vector("GYR_VAR:", rest.gyro_variance_dps2, 5)
}

/// `ACC_BIAS: x y z` in m/s², 5 decimals. The course's name for the mean over that window; most of
/// it is gravity, and it is not subtracted from anything.
pub fn force_mean(rest: &Rest) -> Line {
    vector("ACC_BIAS:", rest.force.m_per_s2(), 5)
}

/// `ACC_VAR: x y z` in (m/s²)², 5 decimals, over the same window.
pub fn force_variance(rest: &Rest) -> Line {
    vector("ACC_VAR:", rest.force_variance_m2_per_s4, 5)
}

/// `nReads/sec: n`: new samples the sensor delivered in the last second.
pub fn reads_per_second(n: u32) -> Line {
    count("nReads/sec", n)
}

/// `DROPPED: n`: lines thrown away since the start because the host did not read.
pub fn dropped(n: u32) -> Line {
    count("DROPPED", n)
}

/// `REPEATED: n`: samples used twice since the start because the sensor had no new one in time.
pub fn repeated(n: u32) -> Line {
    count("REPEATED", n)
}

/// `OVERRUNS: n`: samples lost since the start, the bus being in error or in use.
pub fn overruns(n: u32) -> Line {
    count("OVERRUNS", n)
}

/// `CLIPPED: n`: samples since the start in which an axis stood at the end of its range.
pub fn clipped(n: u32) -> Line {
    count("CLIPPED", n)
}

/// `Bias: x y z deg/s (still)`: for people, when the bias has been measured.
pub fn bias_measured(bias: AngularRate<f32>) -> Line {
    let mut line = Line::new();
    push(&mut line, "Bias:");
    for value in bias.dps().iter() {
        push(&mut line, " ");
        push_decimal(&mut line, *value, 3);
    }
    push(&mut line, " deg/s (still)");
    end(line)
}

/// `Field: x y z uT (n Hz)`, 3 decimals, body frame, adjusted by the factory's factors and nothing
/// else: the last measurement of the magnetometer, and how many came in the last second.
pub fn field(field: MagneticField<f32>, per_second: u32) -> Line {
    let mut line = Line::new();
    push(&mut line, "Field:");
    for value in field.microtesla().iter() {
        push(&mut line, " ");
        push_decimal(&mut line, *value, 3);
    }
    push(&mut line, " uT (");
    push_digits(&mut line, u64::from(per_second), 1);
    push(&mut line, " Hz)");
    end(line)
}

/// `Field: none`: no magnetometer, or nothing from it for a second.
pub fn no_field() -> Line {
    text("Field: none")
}

/// `FIELDS_SKIPPED: n`: measurements of the magnetometer that were overwritten before they were
/// read, since the start; several in a row count once.
pub fn fields_skipped(n: u32) -> Line {
    count("FIELDS_SKIPPED", n)
}

/// `Magnetometer: none, running on six axes`, or what is wrong with it.
pub fn magnetometer_failed(error: &impl fmt::Display) -> Line {
    text(format_args!("Magnetometer: {error}, running on six axes"))
}

/// `OK NAME value unit`: a setting, with so many decimals.
pub fn answer(name: &str, value: f32, decimals: u32, unit: &str) -> Line {
    let mut line = Line::new();
    push(&mut line, "OK ");
    push(&mut line, name);
    push(&mut line, " ");
    push_decimal(&mut line, value, decimals);
    if !unit.is_empty() {
        push(&mut line, " ");
        push(&mut line, unit);
    }
    end(line)
}

/// `OK bias x y z deg/s, verdict`, 3 decimals.
pub fn bias(bias: AngularRate<f32>, verdict: fmt::Arguments<'_>) -> Line {
    let mut numbers = Line::new();
    for value in bias.dps().iter() {
        push(&mut numbers, " ");
        push_decimal(&mut numbers, *value, 3);
    }
    text(format_args!("OK bias{numbers} deg/s, {verdict}"))
}

fn count(name: &str, n: u32) -> Line {
    let mut line = Line::new();
    push(&mut line, name);
    push(&mut line, ": ");
    push_digits(&mut line, u64::from(n), 1);
    end(line)
}

fn vector(tag: &str, v: Vector3<f32>, decimals: u32) -> Line {
    numbers(tag, &[v.x, v.y, v.z], decimals)
}

fn numbers(tag: &str, values: &[f32], decimals: u32) -> Line {
    let mut line = Line::new();
    push(&mut line, tag);
    for &value in values {
        push(&mut line, " ");
        push_decimal(&mut line, value, decimals);
    }
    end(line)
}
