//! Three angles for an orientation (course notes, section 4; lectures of 2016 and later).
//!
//! The angles are good for saying how a board or a camera stands: [`EulerAngles`] and its matrices.
//! They are no good for tracking, which is why the notes go on to quaternions. The 2016 lecture's
//! trackers on angles are here as the counterexample they became: [`lecture`].

use super::flatland::shortest_turn;
use super::quaternion::unit;
use crate::units::{Angle, AngularRate};
use nalgebra::{Matrix4, Point3, RealField, Rotation3, UnitQuaternion, Vector3, Vector4, convert};

pub mod lecture;

/// Yaw about y, then pitch about x, then roll about z, each about the axes the turn before has left
/// the body with. Body to world it is R_y(θ_y) R_x(θ_x) R_z(θ_z), the inverse of eq. 10.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EulerAngles<T> {
    /// θ_y about y: turning to the left is positive.
    pub yaw: Angle<T>,
    /// θ_x about x: looking up is positive.
    pub pitch: Angle<T>,
    /// θ_z about z: leaning to the left is positive.
    pub roll: Angle<T>,
}

/// How fast each of the angles changes, rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EulerRates<T> {
    /// dθ_y/dt.
    pub yaw_rad_per_s: T,
    /// dθ_x/dt.
    pub pitch_rad_per_s: T,
    /// dθ_z/dt.
    pub roll_rad_per_s: T,
}

impl<T: RealField + Copy> EulerAngles<T> {
    /// All zero: level and looking along −z.
    pub fn zero() -> Self {
        let zero = Angle::from_rad(T::zero());
        Self {
            yaw: zero,
            pitch: zero,
            roll: zero,
        }
    }

    /// Eq. 10: R = R_z(−θ_z) R_x(−θ_x) R_y(−θ_y), which takes vectors from **world to body**. An angle
    /// that is not finite counts as zero.
    pub fn world_to_body(&self) -> Rotation3<T> {
        let about = |axis, angle: Angle<T>| {
            Rotation3::from_axis_angle(&axis, -angle.finite_or_zero().rad())
        };
        about(Vector3::z_axis(), self.roll)
            * about(Vector3::x_axis(), self.pitch)
            * about(Vector3::y_axis(), self.yaw)
    }

    /// The same orientation as the trackers give it, body to world. An angle that is not finite counts
    /// as zero.
    pub fn orientation(&self) -> UnitQuaternion<T> {
        let about = |axis, angle: Angle<T>| {
            UnitQuaternion::from_axis_angle(&axis, angle.finite_or_zero().rad())
        };
        about(Vector3::y_axis(), self.yaw)
            * about(Vector3::x_axis(), self.pitch)
            * about(Vector3::z_axis(), self.roll)
    }

    /// The angles of an orientation, body to world: pitch from −90° to 90°, yaw and roll from −180°
    /// to 180°.
    ///
    /// Straight up or down (gimbal lock) only the sum or difference of yaw and roll is defined.
    /// There roll is zero, and yaw has all of it. All zero if the quaternion is zero or not finite;
    /// of any other length, which `new_unchecked` lets it have, only its direction counts.
    pub fn of(orientation: UnitQuaternion<T>) -> Self {
        let Some(orientation) = unit(orientation.into_inner()) else {
            return Self::zero();
        };
        let (w, x, y, z) = (orientation.w, orientation.i, orientation.j, orientation.k);
        // With c and s for cosine and sine of half the pitch:
        // (w − x, y + z) = (c − s) (cos, sin) of half the sum of yaw and roll,
        // (w + x, y − z) = (c + s) (cos, sin) of half their difference.
        // Neither divides by cos θ_x, so near gimbal lock the angles still rebuild the orientation.
        let of_sum = (w - x).hypot(y + z);
        let of_difference = (w + x).hypot(y - z);
        let half_sum = (y + z).atan2(w - x);
        let half_difference = (y - z).atan2(w + x);
        // (c + s)(c − s) = cos θ_x. An arc sine alone would lose half its digits near ±90°.
        let sin_pitch = (w * x - y * z) * convert(2.0);
        let pitch = Angle::from_rad(sin_pitch.atan2(of_sum * of_difference));
        // Below this it is rounding.
        let vanishing = T::default_epsilon() * convert(8.0);
        let (half_sum, half_difference) = if of_sum <= vanishing {
            (half_difference, half_difference)
        } else if of_difference <= vanishing {
            (half_sum, half_sum)
        } else {
            (half_sum, half_difference)
        };
        let zero = Angle::from_rad(T::zero());
        let wrapped = |rad| shortest_turn(zero, Angle::from_rad(rad));
        Self {
            yaw: wrapped(half_sum + half_difference),
            pitch,
            roll: wrapped(half_sum - half_difference),
        }
    }

    /// How the angles change while the body turns at `rate` (body frame). None at gimbal lock, where
    /// they would have to change infinitely fast, and for a rate or angles that are not finite.
    ///
    /// No document has it. It is what [`lecture`] leaves out: a gyro's axes are those of the body,
    /// the angles' axes are not.
    pub fn rates(&self, rate: AngularRate<T>) -> Option<EulerRates<T>> {
        let (sin_x, cos_x) = self.pitch.rad().sin_cos();
        let (sin_z, cos_z) = self.roll.rad().sin_cos();
        let w = rate.rad_per_s();
        // Roll taken back: the part of the rate across the line of sight, and the part upwards.
        let yaw = (w.x * sin_z + w.y * cos_z) / cos_x;
        let rates = EulerRates {
            yaw_rad_per_s: yaw,
            pitch_rad_per_s: w.x * cos_z - w.y * sin_z,
            roll_rad_per_s: w.z + sin_x * yaw,
        };
        let locked = cos_x.abs() <= T::default_epsilon();
        let finite = rates.yaw_rad_per_s.is_finite()
            && rates.pitch_rad_per_s.is_finite()
            && rates.roll_rad_per_s.is_finite();
        (finite && !locked).then_some(rates)
    }

    /// M_view = R T(−eye) (lectures, “from lecture 2”), R as in eq. 10: from the world to a camera
    /// that stands at `eye` (world, in any unit of length) and looks along its own −z.
    ///
    /// For the position of a head; with that of one of two eyes the eyes stay behind when the head
    /// turns, see [`crate::view::eyes`]. None if the position is not finite, or so far off that the
    /// matrix would not be.
    pub fn view_matrix(&self, eye: Point3<T>) -> Option<Matrix4<T>> {
        let turn = self.world_to_body().to_homogeneous();
        let view = turn * Matrix4::new_translation(&-eye.coords);
        view.iter()
            .all(|element| element.is_finite())
            .then_some(view)
    }
}

/// v_clip = M_proj M_view M_model v (lectures, “from lecture 2”): a vertex in the model's frame, in
/// homogeneous clip coordinates. `model` takes it to the world, `view` from there to the camera,
/// `projection` to clip space, all in one unit of length.
///
/// Nothing is divided by w or cut off. What is not finite in a matrix or the vertex is not finite in
/// what comes out.
pub fn to_clip_space<T: RealField + Copy>(
    projection: &Matrix4<T>,
    view: &Matrix4<T>,
    model: &Matrix4<T>,
    vertex: Point3<T>,
) -> Vector4<T> {
    projection * (view * (model * vertex.to_homogeneous()))
}
