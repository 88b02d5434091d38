//! The trackers of the 2016 lecture (“Remember: Dead Reckoning with Gyro” and “Tilt Correction with
//! Complementary Filtering”), which integrate each axis of the gyro into an angle of its own: wrong
//! whenever axes turn together.
//!
//! They are here to be looked at beside [`complementary`], not to be used. The rate about the body's
//! x is the rate of pitch only while roll is zero: rolled by 90°, it is that of yaw. A head that is
//! rolled by 10° and nods by 20° ends 3.5° off; at a roll of 90° a quarter turn ends 120° off. Near
//! straight up and straight down (gimbal lock) the accelerometer's roll jumps besides, and the
//! filter follows it.
//!
//! That is the lecture's method, and it is left as it is. What is put right is the rest: the
//! difference of two angles is wrapped before it is blended, as in flatland, and pitch and roll are
//! a pair that belongs together ([`angles`]). The slides reckon in degrees; the angles here have a
//! type, and it does not matter.
//!
//! [`angles`]: crate::orientation::angles
//! [`complementary`]: crate::orientation::complementary

use super::EulerAngles;
use crate::calibration::Reading;
use crate::orientation::TimeConstant;
use crate::orientation::angles::pitch_and_roll;
use crate::orientation::flatland::shortest_turn;
use crate::units::{Angle, AngularRate, Seconds};
use nalgebra::RealField;

/// θ_x += ω_x Δt, θ_y += ω_y Δt, θ_z += ω_z Δt, “for each axis separately”: the lecture's dead
/// reckoning. It has no equation numbers. Each angle stays from −180° to 180°.
#[derive(Clone, Copy, Debug)]
pub struct LectureDeadReckoning<T> {
    sample_period: Seconds<T>,
    angles: EulerAngles<T>,
}

impl<T: RealField + Copy> LectureDeadReckoning<T> {
    /// Starts from zero.
    pub fn new(sample_period: Seconds<T>) -> Self {
        Self {
            sample_period,
            angles: EulerAngles::zero(),
        }
    }

    /// Starts again from these angles; see [`LectureComplementary::set`].
    pub fn set(&mut self, angles: EulerAngles<T>) {
        self.angles = within_a_turn(angles);
    }

    /// One sample, body frame. What is not finite in it changes nothing.
    pub fn update(&mut self, reading: &Reading<T>) -> EulerAngles<T> {
        self.angles = turned(self.angles, reading.rate(), self.sample_period);
        self.angles
    }

    /// As of the last sample.
    pub fn angles(&self) -> EulerAngles<T> {
        self.angles
    }
}

/// θ_x = α(θ_x + ω_x Δt) + (1 − α) pitch, θ_z the same with roll, and θ_y from the gyro alone. Each
/// angle stays from −180° to 180°.
#[derive(Clone, Copy, Debug)]
pub struct LectureComplementary<T> {
    sample_period: Seconds<T>,
    /// 1 − α.
    accelerometer_weight: T,
    angles: EulerAngles<T>,
}

impl<T: RealField + Copy> LectureComplementary<T> {
    /// Starts from zero. For the lecture's α see [`TimeConstant::from_gyro_weight`].
    pub fn new(time_constant: TimeConstant<T>, sample_period: Seconds<T>) -> Self {
        Self {
            sample_period,
            accelerometer_weight: time_constant.accelerometer_weight(sample_period),
            angles: EulerAngles::zero(),
        }
    }

    /// Starts again from these angles, brought within −180° to 180°; zero for one that is not finite.
    pub fn set(&mut self, angles: EulerAngles<T>) {
        self.angles = within_a_turn(angles);
    }

    /// One sample, body frame. What is not finite in it changes nothing, and a force without direction
    /// leaves pitch and roll to the gyro.
    pub fn update(&mut self, reading: &Reading<T>) -> EulerAngles<T> {
        let by_gyro = turned(self.angles, reading.rate(), self.sample_period);
        let force = reading.force().m_per_s2();
        let directed = force.iter().all(|f| f.is_finite()) && !force.amax().is_zero();
        self.angles = if directed {
            let tilt = pitch_and_roll(reading.force());
            EulerAngles {
                yaw: by_gyro.yaw,
                pitch: self.blended(by_gyro.pitch, tilt.pitch),
                roll: self.blended(by_gyro.roll, tilt.roll),
            }
        } else {
            by_gyro
        };
        self.angles
    }

    /// As of the last sample.
    pub fn angles(&self) -> EulerAngles<T> {
        self.angles
    }

    fn blended(&self, by_gyro: Angle<T>, by_accelerometer: Angle<T>) -> Angle<T> {
        let missing = shortest_turn(by_gyro, by_accelerometer).rad();
        within_half_a_turn(by_gyro.rad() + self.accelerometer_weight * missing)
    }
}

fn turned<T: RealField + Copy>(
    angles: EulerAngles<T>,
    rate: AngularRate<T>,
    period: Seconds<T>,
) -> EulerAngles<T> {
    let turn = rate.rad_per_s() * period.0;
    let by = |angle: Angle<T>, turn: T| {
        let sum = angle.rad() + turn;
        if sum.is_finite() {
            within_half_a_turn(sum)
        } else {
            angle
        }
    };
    EulerAngles {
        yaw: by(angles.yaw, turn.y),
        pitch: by(angles.pitch, turn.x),
        roll: by(angles.roll, turn.z),
    }
}

fn within_a_turn<T: RealField + Copy>(angles: EulerAngles<T>) -> EulerAngles<T> {
    EulerAngles {
        yaw: within_half_a_turn(angles.yaw.rad()),
        pitch: within_half_a_turn(angles.pitch.rad()),
        roll: within_half_a_turn(angles.roll.rad()),
    }
}

/// The same angle from −180° to 180°; zero if it is not finite.
fn within_half_a_turn<T: RealField + Copy>(rad: T) -> Angle<T> {
    let wrapped = shortest_turn(Angle::from_rad(T::zero()), Angle::from_rad(rad));
    if wrapped.rad().is_finite() {
        wrapped
    } else {
        Angle::from_rad(T::zero())
    }
}
