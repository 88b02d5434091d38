//! Rotations as unit quaternions `[w, x, y, z]` in double precision.
//!
//! A quaternion `q` that is called a → b turns a vector written in frame a into the same vector
//! written in frame b: [`rotate`]`(q, v)` = q v q*. Products are Hamilton's, so b → c after a → b is
//! [`multiply`]`(b_to_c, a_to_b)`.

/// No rotation at all.
pub const IDENTITY: [f64; 4] = [1.0, 0.0, 0.0, 0.0];

/// Hamilton's product p ⊗ q: first `q`, then `p`.
pub fn multiply(p: [f64; 4], q: [f64; 4]) -> [f64; 4] {
    [
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    ]
}

/// The opposite rotation.
pub fn conjugate(q: [f64; 4]) -> [f64; 4] {
    [q[0], -q[1], -q[2], -q[3]]
}

/// The vector `v` turned by `q`.
pub fn rotate(q: [f64; 4], v: [f64; 3]) -> [f64; 3] {
    let [_, x, y, z] = multiply(multiply(q, [0.0, v[0], v[1], v[2]]), conjugate(q));
    [x, y, z]
}

/// The rotation about the unit vector `axis` by `angle` (rad), right-handed.
pub fn about(axis: [f64; 3], angle: f64) -> [f64; 4] {
    let (sin, cos) = (angle / 2.0).sin_cos();
    [cos, sin * axis[0], sin * axis[1], sin * axis[2]]
}

/// `q` scaled to unit length; `None` if it is too far from a unit quaternion to mean a rotation.
///
/// "Too far" is a length outside 0.5 to 2: rounding to a few digits stays well inside, a row of
/// zeros or a swapped column does not.
pub fn normalized(q: [f64; 4]) -> Option<[f64; 4]> {
    let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    (0.5..=2.0).contains(&length).then(|| q.map(|c| c / length))
}

/// The angle between two rotations (rad), 0 to π.
pub fn angle_between(p: [f64; 4], q: [f64; 4]) -> f64 {
    let [w, x, y, z] = multiply(conjugate(p), q);
    2.0 * (x * x + y * y + z * z).sqrt().atan2(w.abs())
}

/// The rotation a `fraction` (0 to 1) of the way from `p` to `q`, at constant speed along the
/// shorter way (spherical linear interpolation).
pub fn between(p: [f64; 4], q: [f64; 4], fraction: f64) -> [f64; 4] {
    let step = multiply(conjugate(p), q);
    // q and −q are the same rotation: take the sign that makes the way the shorter one.
    let step = if step[0] < 0.0 {
        step.map(|c| -c)
    } else {
        step
    };
    let sine = (step[1] * step[1] + step[2] * step[2] + step[3] * step[3]).sqrt();
    if sine == 0.0 {
        return p;
    }
    let axis = [step[1] / sine, step[2] / sine, step[3] / sine];
    multiply(p, about(axis, fraction * 2.0 * sine.atan2(step[0])))
}

/// The vector product a × b.
pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// What an accelerometer at rest reads (m/s²), in the body frame, for an attitude body → world.
pub fn gravity_in_body(body_to_world: [f64; 4]) -> [f64; 3] {
    rotate(conjugate(body_to_world), [0.0, super::GRAVITY, 0.0])
}
