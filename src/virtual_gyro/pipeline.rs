//! The virtual gyroscope, from readings to attitude and rate (figures 3 and 6; section 5.3 runs it
//! on a host that is sent the six raw values).

use super::angles::{GimbalLock, TaitBryan};
use super::angular_velocity::{AngularVelocity, nearer};
use super::attitude_quaternion as quaternion;
use super::fields::{Directions, Fields, NoAttitude};
use super::gravity::GravityExtraction;
use super::matrix;
use crate::units::{MagneticField, Seconds, SpecificForce};
use core::fmt;
use nalgebra::{RealField, UnitQuaternion};

/// Which of the paper's two ways from fields to attitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Section 3: angles first, then the quaternion (figure 3).
    Angles(GimbalLock),
    /// Section 4: matrix, quaternion, and the angles last (figure 6).
    Matrix,
}

/// What a person chooses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<T> {
    /// From one sample to the next, 1/F_e.
    pub sample_period: Seconds<T>,
    /// How the attitude is found.
    pub method: Method,
}

/// What is known after a sample. It is that of a moment ago, by the delay of the filters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate<T: RealField> {
    /// g_d and B_d as the filters leave them, device frame.
    pub fields: Fields<T>,
    /// Device to reference (north, east, down); its sign follows the one before.
    pub orientation: UnitQuaternion<T>,
    /// The same as angles.
    pub angles: TaitBryan<T>,
    /// Since the last attitude. None with the first one, and if the sample period is not a
    /// positive number.
    pub velocity: Option<AngularVelocity<T>>,
}

/// The virtual gyroscope, with a median over MEDIAN (odd) and an average over MEAN samples.
///
/// ```
/// use vrduino::frames::axes::Axes;
/// use vrduino::nalgebra::Vector3;
/// use vrduino::units::{MagneticField, Seconds, SpecificForce};
/// use vrduino::virtual_gyro::{Method, NoEstimate, Settings, VirtualGyro};
///
/// let sample_period = Seconds(0.01);
/// let mut gyro = VirtualGyro::<f32, 5, 5>::new(Settings { sample_period, method: Method::Matrix });
/// // What the board's sensors read while it lies level and faces north, y up.
/// let (force, field) = (Vector3::new(0.0, 9.81, 0.0), Vector3::new(0.0, -40.0, -20.0));
/// let north_east_down = |v| Axes::NorthEastDown.from_y_up(v);
/// for k in 0..20 {
///     let force = SpecificForce::from_m_per_s2(north_east_down(force));
///     let field = MagneticField::from_microtesla(north_east_down(field));
///     match gyro.update(force, Some(field)) {
///         Ok(estimate) => {
///             let board = Axes::NorthEastDown.orientation_to_y_up(estimate.orientation);
///             assert!(board.angle() < 1e-3);
///         }
///         Err(reason) => assert!(reason == NoEstimate::Filling && k < 8),
///     }
/// }
/// ```
#[derive(Clone, Debug)]
pub struct VirtualGyro<T: RealField + Copy, const MEDIAN: usize, const MEAN: usize> {
    settings: Settings<T>,
    extraction: GravityExtraction<T, MEDIAN, MEAN>,
    last: Option<Last<T>>,
}

#[derive(Clone, Copy, Debug)]
struct Last<T: RealField> {
    orientation: UnitQuaternion<T>,
    angles: TaitBryan<T>,
    /// From then to now.
    age: Seconds<T>,
}

impl<T: RealField + Copy, const MEDIAN: usize, const MEAN: usize> VirtualGyro<T, MEDIAN, MEAN> {
    /// With the adaptive cut-off of section 3.2.1.
    pub fn new(settings: Settings<T>) -> Self {
        Self::with_extraction(settings, GravityExtraction::new())
    }

    /// With another extraction of gravity.
    pub fn with_extraction(
        settings: Settings<T>,
        extraction: GravityExtraction<T, MEDIAN, MEAN>,
    ) -> Self {
        Self {
            settings,
            extraction,
            last: None,
        }
    }

    /// One sample of both sensors, axes aligned, in the device frame: x ahead, y to the right, z
    /// **down**. From this crate's own body frame, y up, leads
    /// [`Axes::from_y_up`](crate::frames::axes::Axes::from_y_up) of `Axes::NorthEastDown`, and back
    /// [`Axes::to_y_up`](crate::frames::axes::Axes::to_y_up) and
    /// [`Axes::orientation_to_y_up`](crate::frames::axes::Axes::orientation_to_y_up).
    ///
    /// It is to be called once each sample period. The filters want both readings of the same
    /// instant: with a slower magnetometer, call at its pace. Where there is no new reading, pass
    /// None.
    ///
    /// # Errors
    ///
    /// [`NoEstimate`]. Time goes on, and the next velocity is the mean since the last attitude.
    pub fn update(
        &mut self,
        force: SpecificForce<T>,
        magnetic: Option<MagneticField<T>>,
    ) -> Result<Estimate<T>, NoEstimate> {
        if let Some(last) = &mut self.last {
            last.age.0 += self.settings.sample_period.0;
        }
        let magnetic = magnetic.ok_or(NoAttitude::NoMagneticField)?;
        let sample = Fields::from_readings(force, magnetic);
        let fields = self.extraction.update(sample)?.ok_or(NoEstimate::Filling)?;
        let (orientation, angles) = self.attitude(&fields.directions()?)?;
        let last = self.last;
        let orientation = last.map_or(orientation, |last| nearer(&last.orientation, &orientation));
        self.last = Some(Last {
            orientation,
            angles,
            age: Seconds(T::zero()),
        });
        let velocity = last
            .and_then(|last| AngularVelocity::between(&last.orientation, &orientation, last.age));
        Ok(Estimate {
            fields,
            orientation,
            angles,
            velocity,
        })
    }

    /// The extraction of gravity, to look at its cut-off.
    pub fn extraction(&self) -> &GravityExtraction<T, MEDIAN, MEAN> {
        &self.extraction
    }

    fn attitude(
        &self,
        directions: &Directions<T>,
    ) -> Result<(UnitQuaternion<T>, TaitBryan<T>), NoAttitude> {
        let previous = self.last.map(|last| last.angles);
        match self.settings.method {
            Method::Angles(lock) => {
                let angles = TaitBryan::from_directions(directions, lock, previous);
                Ok((quaternion::from_angles(&angles), angles))
            }
            Method::Matrix => {
                let m = matrix::from_gravity(directions);
                let q = quaternion::from_matrix(&m).ok_or(NoAttitude::NotFinite)?;
                Ok((q, quaternion::to_angles(&q, previous)))
            }
        }
    }
}

/// Why a sample gave no estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoEstimate {
    /// The first MEDIAN + MEAN − 2 samples fill the windows.
    Filling,
    /// The fields do not tell an attitude.
    Attitude(NoAttitude),
}

impl From<NoAttitude> for NoEstimate {
    fn from(reason: NoAttitude) -> Self {
        Self::Attitude(reason)
    }
}

impl fmt::Display for NoEstimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Filling => f.write_str("the filters' windows fill: go on with more samples"),
            Self::Attitude(reason) => reason.fmt(f),
        }
    }
}

impl core::error::Error for NoEstimate {}
