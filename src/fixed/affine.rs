//! Corrections by a matrix and an offset, 001's A x + b, from a sensor's counts to what the estimators take.

use super::measurement::{Field, Force};
use super::multiply::{Multiply, Portable};
use super::number::Q;
use super::vector::Vector;
use crate::sensor::AccelRange;
use crate::sensor::magnetometer::to_body;
use crate::sensor::measurement::Calibration;
use crate::units::{MagneticField, SpecificForce};
use nalgebra::{Matrix3, Vector3};

/// A x + b of numbers with 15 fraction bits.
#[derive(Clone, Copy, Debug)]
struct Affine<M> {
    /// Of A; below ½.
    rows: [Vector<M, 32>; 3],
    /// b.
    offset: Vector<M, 15>,
}

impl<M: Multiply> Affine<M> {
    /// None where a row of A comes to more than `largest_row` or b to more than 2¹⁴, or where they are no
    /// numbers: the result would not fit.
    fn new(matrix: &Matrix3<f32>, offset: Vector3<f32>, largest_row: f32) -> Option<Self> {
        // Written so that what is not a number is not within.
        let rows_fit = (0..3).all(|row| {
            let sum: f32 = matrix.row(row).iter().map(|part| part.abs()).sum();
            sum <= largest_row && matrix.row(row).iter().all(|part| part.abs() < 0.5)
        });
        let offset_fits = offset.iter().all(|part| part.abs() <= 16_384.0);
        let row = |row: usize| {
            let [x, y, z] = [0, 1, 2].map(|column| Q::nearest(matrix[(row, column)]));
            Vector::new(x, y, z)
        };
        (rows_fit && offset_fits).then(|| Self {
            rows: [0, 1, 2].map(row),
            offset: Vector::new(
                Q::nearest(offset.x),
                Q::nearest(offset.y),
                Q::nearest(offset.z),
            ),
        })
    }

    /// `start` + A x.
    #[inline(always)]
    fn added(&self, start: Vector<M, 15>, x: Vector<M, 15>) -> [i32; 3] {
        let along = |start: Q<M, 15>, row: Vector<M, 32>| {
            start
                .plus(row.x, x.x)
                .plus(row.y, x.y)
                .plus(row.z, x.z)
                .bits()
        };
        let [row_x, row_y, row_z] = self.rows;
        [
            along(start.x, row_x),
            along(start.y, row_y),
            along(start.z, row_z),
        ]
    }
}

/// The accelerometer's.
#[derive(Clone, Copy, Debug)]
pub struct Accelerometer<M = Portable> {
    /// A − 1, which is small and so keeps more bits, and b in counts.
    difference: Affine<M>,
}

impl<M: Multiply> Accelerometer<M> {
    /// For a sensor at this range. None if a row of A − 1 comes to more than 0.46, or b to more than a quarter of the
    /// range: no sensor is so far off, and no [record](crate::calibration::record) holds more.
    pub fn new(calibration: &Calibration<SpecificForce<f32>>, range: AccelRange) -> Option<Self> {
        let counts_per_g = f32::from(range.counts_per_g());
        let difference = calibration.matrix() - Matrix3::identity();
        let offset = calibration.offset().g() * counts_per_g;
        let is_near = offset.iter().all(|part| part.abs() <= 8_192.0);
        let difference = Affine::new(&difference, offset, 0.46)?;
        is_near.then_some(Self { difference })
    }

    /// The force that these counts stand for; at most the end of the range.
    #[inline(always)]
    pub fn force(&self, counts: [i16; 3]) -> Force {
        let x = Vector::from_counts(counts);
        let start = x + self.difference.offset;
        Force::from_parts_of_counts(self.difference.added(start, x))
    }
}

/// The magnetometer's.
#[derive(Clone, Copy, Debug)]
pub struct Magnetometer<M = Portable> {
    /// From counts along its own axes to µT along the body's.
    affine: Affine<M>,
}

impl<M: Multiply> Magnetometer<M> {
    /// For a sensor of which a count along its own axes is so many µT, `sensitivity`: the resolution's times the
    /// factory's adjustment. None if a count became half a microtesla or more, or if the offset is beyond
    /// 16 mT.
    pub fn new(
        calibration: &Calibration<MagneticField<f32>>,
        sensitivity: Vector3<f32>,
    ) -> Option<Self> {
        let to_body = Matrix3::from_columns(&[
            to_body(Vector3::x() * sensitivity.x),
            to_body(Vector3::y() * sensitivity.y),
            to_body(Vector3::z() * sensitivity.z),
        ]);
        let offset = calibration.offset().microtesla();
        Affine::new(&(calibration.matrix() * to_body), offset, 1.5).map(|affine| Self { affine })
    }

    /// The field that these counts, along the sensor's own axes, stand for.
    #[inline(always)]
    pub fn field(&self, counts: [i16; 3]) -> Field {
        let x = Vector::from_counts(counts);
        Field::from_parts_of_microtesla(self.affine.added(self.affine.offset, x))
    }
}
