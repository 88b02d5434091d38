//! From which directions the field has come: the sphere about the board, unrolled.

use nalgebra::Vector3;
use vrduino::calibration::coverage::{DIRECTIONS, direction};
use vrduino::units::MagneticField;

use super::procedure::Procedure;

/// Columns about the board's y axis, from −180° to 180°, and rows above and below the x-z plane.
const COLUMNS: usize = 48;
const ROWS: usize = 12;

/// Something seen so near (cosine of 20°) counts: as in the library's fit.
const REACH: f32 = 0.939_692_6;

/// Directions that are looked at, at most: enough for a map as coarse as this.
const MOST: usize = 1500;

/// The directions so far: unit vectors in the body frame.
#[derive(Clone, Debug, Default)]
pub struct Map {
    seen: Vec<Vector3<f32>>,
}

impl Map {
    /// How many directions there are to be seen.
    pub const DIRECTIONS: usize = DIRECTIONS;

    /// As far as it goes: of what the fit corrects, if there is one.
    pub fn so_far(procedure: &Procedure) -> Self {
        let fields = procedure.fields();
        match procedure.magnetometer() {
            Ok(found) => {
                let correct = found.calibration();
                Self::of(fields.iter().map(|&field| {
                    let field = MagneticField::from_microtesla(field);
                    correct.corrected(field).microtesla()
                }))
            }
            Err(_) => Self::about_the_middle(fields),
        }
    }

    /// Of fields that were corrected.
    pub fn of(corrected: impl ExactSizeIterator<Item = Vector3<f32>>) -> Self {
        let every = corrected.len() / MOST + 1;
        let seen = corrected
            .step_by(every)
            .filter_map(|field| field.try_normalize(0.0))
            .collect();
        Self { seen }
    }

    /// Of fields as they are read, about the middle of what was seen: until there is a fit.
    fn about_the_middle(fields: &[Vector3<f32>]) -> Self {
        let (mut least, mut most) = (
            Vector3::repeat(f32::INFINITY),
            Vector3::repeat(f32::NEG_INFINITY),
        );
        for field in fields {
            least = least.inf(field);
            most = most.sup(field);
        }
        let middle = (least + most) / 2.0;
        Self::of(fields.iter().map(|field| field - middle))
    }

    /// The directions.
    pub fn seen(&self) -> &[Vector3<f32>] {
        &self.seen
    }

    /// Those of the library's map near which nothing was seen.
    pub fn missing(&self) -> Vec<Vector3<f32>> {
        (0..DIRECTIONS)
            .map(direction)
            .filter(|direction| !self.has_seen(direction))
            .collect()
    }

    fn has_seen(&self, direction: &Vector3<f32>) -> bool {
        self.seen.iter().any(|seen| seen.dot(direction) >= REACH)
    }

    /// A line for each row, the top of the board first.
    pub fn lines(&self) -> Vec<String> {
        let cell = |row: usize, column: usize| {
            let about = (column as f32 + 0.5) / COLUMNS as f32 * 360.0 - 180.0;
            let above = 90.0 - (row as f32 + 0.5) / ROWS as f32 * 180.0;
            if self.has_seen(&towards(about, above)) {
                '█'
            } else {
                '·'
            }
        };
        (0..ROWS)
            .map(|row| (0..COLUMNS).map(|column| cell(row, column)).collect())
            .collect()
    }
}

/// The direction so many degrees about y, from z towards x, and above the x-z plane.
fn towards(about: f32, above: f32) -> Vector3<f32> {
    let (about, above) = (about.to_radians(), above.to_radians());
    Vector3::new(
        above.cos() * about.sin(),
        above.sin(),
        above.cos() * about.cos(),
    )
}

/// The same angles of a direction.
pub fn angles(direction: &Vector3<f32>) -> [f32; 2] {
    [
        direction.x.atan2(direction.z).to_degrees(),
        direction.y.clamp(-1.0, 1.0).asin().to_degrees(),
    ]
}

#[cfg(test)]
mod tests {
    use super::{COLUMNS, Map, ROWS, angles, towards};
    use nalgebra::Vector3;

    #[test]
    fn a_direction_is_seen_where_it_is() {
        // y, the top of the board, and -x, a quarter to the left.
        let map = Map::of([Vector3::y() * 40.0, Vector3::x() * -40.0].into_iter());
        let lines: Vec<Vec<char>> = map.lines().iter().map(|l| l.chars().collect()).collect();
        assert_eq!((lines.len(), lines[0].len()), (ROWS, COLUMNS));
        assert!(lines[0].iter().all(|&c| c == '█'));
        assert!(lines[ROWS - 1].iter().all(|&c| c == '·'));
        assert_eq!(lines[ROWS / 2][COLUMNS / 4], '█');
        assert_eq!(lines[ROWS / 2][3 * COLUMNS / 4], '·');
    }

    #[test]
    fn what_surrounds_the_middle_is_seen_whatever_the_iron() {
        let iron = Vector3::new(100.0, -30.0, 7.0);
        let ring: Vec<_> = (0..3600)
            .map(|k| iron + towards(k as f32, (k as f32 / 3600.0).mul_add(180.0, -90.0)) * 48.0)
            .collect();
        assert!(Map::about_the_middle(&ring).missing().is_empty());
        assert!(!Map::of(ring.iter().copied()).missing().is_empty());
    }

    #[test]
    fn angles_are_those_of_the_map() {
        let [about, above] = angles(&towards(-130.0, 55.0));
        assert!((about + 130.0).abs() < 1e-3 && (above - 55.0).abs() < 1e-3);
    }
}
