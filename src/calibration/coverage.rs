//! Which directions the field was seen from, and how large the largest hole is.
//!
//! A fit through points on one side of a sphere finds a centre that may be anywhere along the line
//! to the other side, with an error of the fit as small as ever. So the sphere itself is looked at:
//! 96 directions spread over it evenly, and whether something was seen near each.

use crate::units::Angle;
use heapless::Vec;
use nalgebra::{RealField, Vector3, convert};

/// Most places kept.
const PLACES: usize = 192;

/// Samples that count at each place: a board that lies still for a minute shall not outweigh the rest.
const SAMPLES_PER_PLACE: u8 = 40;

/// Two places are at least so far apart at first, in units of the points. It grows when there is no
/// room left; over a whole sphere that ends at 12° to 17°.
const FIRST_SPACING: i32 = 16;

/// A direction counts as seen if something was seen within 20° of it, of which this is the cosine: the
/// places' spacing and some more.
const REACH: f64 = 0.939_692_620_785_908_4;

/// Directions of the map: six faces of a cube, four by four on each.
pub const DIRECTIONS: usize = 96;

/// tan 11.25° and tan 33.75°: cells of equal angle on a cube's face.
const STEPS: [f32; 4] = [-0.668_178_6, -0.198_912_37, 0.198_912_37, 0.668_178_6];

/// How much of the sphere was seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coverage<T: RealField + Copy> {
    /// Share of the directions with something near, 0 to 1.
    pub share: T,
    /// From the middle of the largest hole to the nearest thing seen.
    pub largest_hole: Angle<T>,
    /// The middle of that hole: a unit vector, body frame. To see it, turn the board until the field
    /// comes from there.
    pub hole: Vector3<T>,
}

/// Direction number `index` of the map: a unit vector, body frame. Beyond [`DIRECTIONS`] they repeat.
pub fn direction<T: RealField + Copy>(index: usize) -> Vector3<T> {
    let step = |number: usize| convert::<f32, T>(STEPS[number % 4]);
    let (face, u, v) = (index / 16 % 6, step(index / 4), step(index));
    let mut direction = Vector3::zeros();
    direction[face / 2] = if face.is_multiple_of(2) {
        T::one()
    } else {
        -T::one()
    };
    direction[(face / 2 + 1) % 3] = u;
    direction[(face / 2 + 2) % 3] = v;
    direction.normalize()
}

/// Where something was seen, in whole units, no two places close to each other.
#[derive(Clone, Debug)]
pub(super) struct Places {
    places: Vec<Place, PLACES>,
    /// Square of the least distance.
    spacing: i32,
}

#[derive(Clone, Copy, Debug)]
struct Place {
    /// Within ±2¹¹.
    at: [i16; 3],
    samples: u8,
}

impl Place {
    /// Squared; at most 3 · 2²⁴.
    fn distance(&self, other: [i16; 3]) -> i32 {
        let squares = self.at.iter().zip(other).map(|(a, b)| {
            let difference = i32::from(*a) - i32::from(b);
            difference * difference
        });
        squares.sum()
    }
}

/// What a point is to the places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Visit {
    /// The first one there.
    New,
    /// One more.
    Again,
    /// There were enough: it should not count.
    Enough,
}

impl Places {
    pub(super) const fn new() -> Self {
        Self {
            places: Vec::new(),
            spacing: FIRST_SPACING * FIRST_SPACING,
        }
    }

    pub(super) fn visit(&mut self, at: [i16; 3]) -> Visit {
        let spacing = self.spacing;
        let near = self
            .places
            .iter_mut()
            .find(|place| place.distance(at) < spacing);
        if let Some(place) = near {
            if place.samples >= SAMPLES_PER_PLACE {
                return Visit::Enough;
            }
            place.samples += 1;
            return Visit::Again;
        }
        while self.places.is_full() {
            self.spacing *= 2;
            self.thin_out();
        }
        // There is room now.
        let _ = self.places.push(Place { at, samples: 1 });
        Visit::New
    }

    /// Merges places that are too close under the present spacing.
    fn thin_out(&mut self) {
        let mut kept: usize = 0;
        for index in 0..self.places.len() {
            let place = self.places[index];
            let spacing = self.spacing;
            let near = self.places[..kept].iter_mut();
            if let Some(near) = near
                .into_iter()
                .find(|other| other.distance(place.at) < spacing)
            {
                near.samples = near.samples.saturating_add(place.samples);
            } else {
                self.places[kept] = place;
                kept += 1;
            }
        }
        self.places.truncate(kept);
    }

    /// How the places cover the sphere once each was made a direction.
    pub(super) fn coverage<T: RealField + Copy>(
        &self,
        to_sphere: impl Fn(Vector3<T>) -> Vector3<T>,
    ) -> Coverage<T> {
        let mut nearest = [-T::one(); DIRECTIONS];
        for place in &self.places {
            let seen = to_sphere(Vector3::from(place.at.map(|c| convert(f32::from(c)))));
            let Some(seen) = seen.try_normalize(T::zero()) else {
                continue;
            };
            for (index, nearest) in nearest.iter_mut().enumerate() {
                *nearest = nearest.max(direction(index).dot(&seen));
            }
        }
        let reach = convert(REACH);
        let seen = nearest.iter().filter(|cosine| **cosine >= reach).count();
        let hole = (0..DIRECTIONS).fold(0, |hole, index| {
            if nearest[index] < nearest[hole] {
                index
            } else {
                hole
            }
        });
        let cosine = nearest[hole].clamp(-T::one(), T::one());
        Coverage {
            share: convert::<f32, T>(seen as f32 / DIRECTIONS as f32),
            largest_hole: Angle::from_rad(cosine.acos()),
            hole: direction(hole),
        }
    }
}
