//! Sums of powers of whole numbers: exact, and so independent of where the origin was.
//!
//! The normal equations of a quadric are sums of products of coordinates up to the fourth degree. In
//! floating point they must be about the right centre, which is what they are to find, or single
//! precision is lost. In whole numbers they can be taken about any point and moved afterwards
//! without an error, and one sample costs this chip some hundred instructions.

/// Largest coordinate, either sign: 2¹¹.
pub(super) const LARGEST: i32 = 1 << 11;

/// Most samples. With a centre that is itself within [`LARGEST`], (2 · 2¹¹)⁴ · 2¹⁴ = 2⁶² is the largest
/// sum there can be.
pub(super) const MOST: u32 = 1 << 14;

/// One more than the highest power.
const POWERS: usize = 5;

/// Σ xⁱ yʲ zᵏ for i + j + k ≤ 4.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moments([[[i64; POWERS]; POWERS]; POWERS]);

impl Moments {
    pub(super) const fn new() -> Self {
        Self([[[0; POWERS]; POWERS]; POWERS])
    }

    /// Takes a point. Coordinates beyond [`LARGEST`] must not come here.
    pub(super) fn add(&mut self, point: [i32; 3]) {
        let [x, y, z] = point.map(powers);
        for (i, x) in x.into_iter().enumerate() {
            for (j, y) in y.into_iter().enumerate().take(POWERS - i) {
                let xy = x * y;
                for (k, z) in z.into_iter().enumerate().take(POWERS - i - j) {
                    self.0[i][j][k] = self.0[i][j][k].wrapping_add(xy.wrapping_mul(z));
                }
            }
        }
    }

    /// Σ xⁱ yʲ zᵏ; zero beyond the fourth degree.
    pub(super) fn sum(&self, i: usize, j: usize, k: usize) -> i64 {
        let plane = self.0.get(i).and_then(|plane| plane.get(j));
        plane.and_then(|line| line.get(k)).copied().unwrap_or(0)
    }

    /// How many points.
    pub(super) fn count(&self) -> i64 {
        self.0[0][0][0]
    }

    /// The moments of the same points with `centre` as the origin.
    ///
    /// On the way there sums may pass the end of an i64 and come back: arithmetic modulo 2⁶⁴ is exact
    /// as long as the result fits, and with a centre within [`LARGEST`] it does.
    pub(super) fn about(&self, centre: [i32; 3]) -> Self {
        let [cx, cy, cz] = centre.map(|c| i64::from(-c));
        let mut moments = self.0;
        for a in 0..POWERS {
            for b in 0..POWERS - a {
                let line: [i64; POWERS] = moments.map(|plane| plane[a][b]);
                for (i, value) in shifted(line, cx).into_iter().enumerate() {
                    moments[i][a][b] = value;
                }
            }
        }
        for plane in &mut moments {
            for b in 0..POWERS {
                let line: [i64; POWERS] = plane.map(|line| line[b]);
                for (j, value) in shifted(line, cy).into_iter().enumerate() {
                    plane[j][b] = value;
                }
            }
            for line in plane {
                *line = shifted(*line, cz);
            }
        }
        let mut result = Self(moments);
        result.drop_beyond_the_fourth_degree();
        result
    }

    /// Shifting fills the corners of the cube with what means nothing.
    fn drop_beyond_the_fourth_degree(&mut self) {
        for (i, plane) in self.0.iter_mut().enumerate() {
            for (j, line) in plane.iter_mut().enumerate() {
                for (k, value) in line.iter_mut().enumerate() {
                    if i + j + k >= POWERS {
                        *value = 0;
                    }
                }
            }
        }
    }
}

/// 1, x, x², x³, x⁴.
fn powers(x: i32) -> [i64; POWERS] {
    let x = i64::from(x);
    [1, x, x * x, x * x * x, x * x * x * x]
}

/// Σ (x + d)ⁿ from Σ xⁿ: the binomial theorem, by repeated addition as in Horner's scheme.
fn shifted(mut sums: [i64; POWERS], d: i64) -> [i64; POWERS] {
    // After pass p, entry n holds Σ xⁿ⁻ᵖ⁻¹ (x + d)ᵖ⁺¹ wherever that has a meaning.
    for pass in 1..POWERS {
        for n in (pass..POWERS).rev() {
            sums[n] = sums[n].wrapping_add(d.wrapping_mul(sums[n - 1]));
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::Moments;

    const POINTS: [[i32; 3]; 4] = [
        [3, -4, 5],
        [-2048, 2048, 17],
        [2047, -2048, 2048],
        [0, 1, -1],
    ];

    #[test]
    fn moments_about_a_centre_are_those_of_points_taken_from_there() {
        let mut about_zero = Moments::new();
        POINTS.iter().for_each(|&point| about_zero.add(point));
        for centre in [[0; 3], [1, -2, 3], [-2048, 2048, -2048], [700, 0, -9]] {
            let mut expected = Moments::new();
            for point in POINTS {
                expected.add([0, 1, 2].map(|axis| point[axis] - centre[axis]));
            }
            assert_eq!(about_zero.about(centre).0, expected.0, "{centre:?}");
        }
    }
}
