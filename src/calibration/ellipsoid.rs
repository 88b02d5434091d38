//! Hard and soft iron around the magnetometer, from a board that is turned every way.
//!
//! The field of the earth has one length, so a perfect magnetometer that is turned every way draws a
//! sphere about zero. Magnetised iron on the board (*hard* iron) turns with it and shifts the sphere;
//! iron that the earth's field magnetises (*soft* iron), and axes of unlike sensitivity, make it an
//! ellipsoid. The fit finds that ellipsoid, and the correction makes the sphere of it again: A (m − b).
//!
//! The fit is the algebraic one with the quadric's trace fixed, the ellipsoid of Q. Li and J. G.
//! Griffiths, “Least squares ellipsoid specific fitting” (2004) in the simpler form that suffices
//! when the axes are alike; what it means for a compass is in D. Gebre-Egziabher et al., “Calibration
//! of strapdown magnetometers in magnetic field domain” (Journal of Aerospace Engineering 19, 2006),
//! and in Freescale's AN4246. Three choices are our own:
//!
//! * **Whole numbers.** Sums go up to the fourth power, and the centre they should be taken about is
//!   what is looked for. They are kept in whole quarters of a microtesla, where they are exact and can
//!   be moved to the centre afterwards. No double precision, which costs this chip a routine each.
//! * **Places, not time.** A place in the field counts forty times at most, so a pause weighs nothing.
//! * **One rotation is unknowable.** A sphere stays one however it is turned, so A is taken symmetric.
//!   If the magnetometer's axes were turned against the gyro's, no such fit would see it.
//!
//! A sphere has no scale either: A has the determinant 1, so the field's strength is the mean of what
//! the axes report.

use super::coverage::{Places, Visit};
use super::moments::{self, Moments};
use super::quadric;
use crate::sensor::magnetometer::FieldError;
use crate::sensor::measurement::Calibration;
use crate::units::{Angle, MagneticField};
use nalgebra::{Matrix3, RealField, Vector3, convert, convert_unchecked};

mod refusal;

pub use refusal::Refusal;

/// Whole units per microtesla. A count of the AK8963 is 0.15 µT, and its noise some 0.6.
const UNITS_PER_MICROTESLA: f64 = 4.0;

/// Samples that count before a fit is tried: nine unknowns, and noise that should average.
const FEWEST: u32 = 200;

/// Least share of the sphere, and largest hole. With 0.6 µT of noise the centre would be right to
/// 0.5 µT beside a hole of 55° (tests); in a room, where the field varies, a hole costs more. A person
/// who turns a board for two minutes leaves 20° to 50° (recorded motions).
const LEAST_SHARE: f64 = 0.6;
const LARGEST_HOLE_DEGREES: f64 = 50.0;

/// An axis that varies less than this (µT, one standard deviation) reads nothing.
const DEAD_AXIS: f64 = 2.0;

/// Least variance across a flat cloud as a share of that along it. A board turned about one axis
/// shows its noise, 0.0003; a band of ±10° about a great circle 0.02; a half sphere 0.25.
const FLAT: f64 = 0.03;

/// The earth's field, µT. At the surface it is 22 to 67 (World Magnetic Model).
const WEAKEST: f64 = 20.0;
const STRONGEST: f64 = 70.0;

/// Longest axis over shortest. Iron beside a sensor makes 1.1 of it; more, and a part is broken.
const LARGEST_AXIS_RATIO: f64 = 1.5;

/// Largest rms of the corrected field's length less its mean, per cent. Noise of 0.6 µT makes 1.2
/// of it in a field of 50 µT; a heading is off by about half a degree for each per cent.
const LARGEST_ERROR_PERCENT: f64 = 4.0;

/// What becomes of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sighting {
    /// From where nothing was seen before.
    New,
    /// From a place known already; it counts if there were few.
    Known,
    /// It could not be used, and the result will be refused.
    Unusable,
}

/// What stands around the magnetometer, body frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Magnetometer<T: RealField + Copy> {
    /// The field of the board itself: what is subtracted first.
    pub hard_iron: MagneticField<T>,
    /// What the rest is multiplied by: symmetric, determinant 1.
    pub soft_iron: Matrix3<T>,
    /// Length of the corrected field, µT.
    pub strength_microtesla: T,
    /// Root mean square of its departures from that length, per cent.
    pub error_percent: T,
    /// The share of the sphere that was seen, 0 to 1.
    pub coverage: T,
    /// The largest hole in it.
    pub largest_hole: Angle<T>,
    /// Temperature of the die, °C.
    pub temperature_celsius: f32,
}

impl<T: RealField + Copy> Magnetometer<T> {
    /// 001's form: A = soft iron, b = −A · hard iron.
    pub fn calibration(&self) -> Calibration<MagneticField<T>> {
        let offset = -(self.soft_iron * self.hard_iron.microtesla());
        Calibration::new(self.soft_iron, MagneticField::from_microtesla(offset))
    }
}

/// The procedure: fields in, an ellipsoid out. 2.6 kB, and no floating point in its state.
#[derive(Clone, Debug)]
pub struct EllipsoidFit {
    /// The first field, in whole units: all others are taken from there.
    anchor: Option<[i32; 3]>,
    moments: Moments,
    places: Places,
    counted: u32,
    magnet: u32,
    unreadable: u32,
}

impl Default for EllipsoidFit {
    fn default() -> Self {
        Self::new()
    }
}

impl EllipsoidFit {
    /// Nothing seen yet.
    pub const fn new() -> Self {
        Self {
            anchor: None,
            moments: Moments::new(),
            places: Places::new(),
            counted: 0,
            magnet: 0,
            unreadable: 0,
        }
    }

    /// Takes what [`RawField::field`](crate::sensor::magnetometer::RawField::field) made of a fresh
    /// measurement: a field in the body frame with its iron still in it, or why there is none.
    pub fn push<T: RealField + Copy>(
        &mut self,
        field: Result<MagneticField<T>, FieldError>,
    ) -> Sighting {
        let microtesla = match field {
            Ok(field) => field.microtesla(),
            Err(FieldError::Overflow) => return self.beside_a_magnet(),
            Err(FieldError::OutOfRange) => return self.no_field(),
        };
        if !microtesla.iter().all(|component| component.is_finite()) {
            return self.no_field();
        }
        let units = microtesla * convert::<f64, T>(UNITS_PER_MICROTESLA);
        // A cast to an integer saturates, and from there on it is too far from any anchor.
        let units = units.map(|u| convert_unchecked::<T, f32>(u.round()) as i32);
        let anchor = *self.anchor.get_or_insert(units.into());
        let at = [0, 1, 2].map(|axis| units[axis].saturating_sub(anchor[axis]));
        if at
            .iter()
            .any(|c| c.unsigned_abs() > moments::LARGEST.unsigned_abs())
        {
            return self.beside_a_magnet();
        }
        // Within ±2¹¹.
        let visit = self.places.visit(at.map(|c| c as i16));
        if visit != Visit::Enough && self.counted < moments::MOST {
            self.moments.add(at);
            self.counted += 1;
        }
        match visit {
            Visit::New => Sighting::New,
            Visit::Again | Visit::Enough => Sighting::Known,
        }
    }

    fn beside_a_magnet(&mut self) -> Sighting {
        self.magnet = self.magnet.saturating_add(1);
        Sighting::Unusable
    }

    fn no_field(&mut self) -> Sighting {
        self.unreadable = self.unreadable.saturating_add(1);
        Sighting::Unusable
    }

    /// Samples that count.
    pub fn samples(&self) -> u32 {
        self.counted
    }

    /// The result, if all there is to check says that it is one. `temperature_celsius` is noted.
    ///
    /// It may be asked for at any time; 96 directions are compared with up to 192 places, so not with
    /// every sample.
    ///
    /// # Errors
    ///
    /// A [`Refusal`]: the first thing that is wrong, and what to do about it. Beside a magnet or with
    /// unreadable fields the procedure must start again, otherwise more directions may mend it.
    pub fn result<T: RealField + Copy>(
        &self,
        temperature_celsius: f32,
    ) -> Result<Magnetometer<T>, Refusal<T>> {
        self.check_samples()?;
        let ellipsoid = quadric::fit::<T>(&self.moments);
        let ellipsoid = ellipsoid.ok_or(Refusal::NoEllipsoid)?;
        let coverage = self
            .places
            .coverage(|place| ellipsoid.to_unit_sphere * (place - ellipsoid.centre));
        let hole = coverage.largest_hole.degrees();
        if coverage.share < convert(LEAST_SHARE) || hole > convert(LARGEST_HOLE_DEGREES) {
            return Err(Refusal::Coverage(coverage));
        }
        if ellipsoid.axis_ratio > convert(LARGEST_AXIS_RATIO) {
            return Err(Refusal::Lopsided(ellipsoid.axis_ratio));
        }
        let microtesla: T = convert(1.0 / UNITS_PER_MICROTESLA);
        // The geometric mean of the axes: that of a sphere of the same volume.
        // By logarithms, for the cube root goes through double precision.
        let volume = ellipsoid.to_unit_sphere.determinant();
        let radius = (-volume.ln() / convert(3.0)).exp();
        let strength_microtesla = radius * microtesla;
        if !(convert(WEAKEST)..=convert(STRONGEST)).contains(&strength_microtesla) {
            return Err(Refusal::Strength(strength_microtesla));
        }
        let error_percent = ellipsoid.rms * convert(100.0);
        if error_percent > convert(LARGEST_ERROR_PERCENT) {
            return Err(Refusal::Disturbed(error_percent));
        }
        let anchor = self.anchor.unwrap_or_default();
        let anchor = Vector3::from(anchor.map(|c| convert::<f32, T>(c as f32)));
        Ok(Magnetometer {
            hard_iron: MagneticField::from_microtesla((anchor + ellipsoid.centre) * microtesla),
            soft_iron: ellipsoid.to_unit_sphere * radius,
            strength_microtesla,
            error_percent,
            coverage: coverage.share,
            largest_hole: coverage.largest_hole,
            temperature_celsius,
        })
    }

    /// What can be said without a fit.
    fn check_samples<T: RealField + Copy>(&self) -> Result<(), Refusal<T>> {
        if self.magnet > 0 {
            let samples = self.magnet;
            return Err(Refusal::Magnet { samples });
        }
        if self.unreadable > 0 {
            let samples = self.unreadable;
            return Err(Refusal::Unreadable { samples });
        }
        if self.counted < FEWEST {
            let (samples, needed) = (self.counted, FEWEST);
            return Err(Refusal::TooFew { samples, needed });
        }
        let variances = quadric::variances::<T>(&self.moments).ok_or(Refusal::NoEllipsoid)?;
        let dead: T = convert(DEAD_AXIS * UNITS_PER_MICROTESLA);
        if let Some(axis) = (0..3).find(|&axis| variances[axis] < dead * dead) {
            return Err(Refusal::DeadAxis { axis });
        }
        let [most, _, least] = quadric::spread::<T>(&self.moments).ok_or(Refusal::NoEllipsoid)?;
        if least < most * convert(FLAT) {
            return Err(Refusal::Flat);
        }
        Ok(())
    }
}
