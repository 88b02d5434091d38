//! Section 3.5.5: the angular velocity beside the differentiated matrix.

use crate::reference::*;
use nalgebra::{Quaternion, RealField, UnitQuaternion, convert};
use std::f64::consts::{FRAC_PI_2, PI};
use vrduino::units::Seconds;
use vrduino::virtual_gyro::angular_velocity::nearer;
use vrduino::virtual_gyro::attitude_quaternion::{from_angles, from_matrix, to_angles};
use vrduino::virtual_gyro::{AngularVelocity, TaitBryan};

const H: f64 = 1e-3;

/// d/dt at t = 0 by differences of fourth order.
fn derivative(f: impl Fn(f64) -> f64) -> f64 {
    (8.0 * (f(H) - f(-H)) - (f(2.0 * H) - f(-2.0 * H))) / (12.0 * H)
}

fn at(angles: Vector, rates: Vector, t: f64) -> Vector {
    [0, 1, 2].map(|i| angles[i] + rates[i] * t)
}

/// ω_d and ω_r from the matrix A = Rᵀ, device to reference: AᵀȦ and ȦAᵀ are their cross products.
fn from_matrices(angles: Vector, rates: Vector) -> [Vector; 2] {
    let a = transpose(&r(angles));
    let a_dot = [0, 1, 2]
        .map(|i| [0, 1, 2].map(|j| derivative(|t| transpose(&r(at(angles, rates, t)))[i][j])));
    [
        product(&transpose(&a), &a_dot),
        product(&a_dot, &transpose(&a)),
    ]
    .map(|w| [w[2][1], w[0][2], w[1][0]])
}

fn quaternion(angles: Vector) -> UnitQuaternion<f64> {
    let [phi, theta, psi] = angles;
    from_angles(&TaitBryan::from_rad(phi, theta, psi))
}

fn q_dot(angles: Vector, rates: Vector) -> Quaternion<f64> {
    let component = |i: usize| derivative(|t| quaternion(at(angles, rates, t)).coords[i]);
    Quaternion::from_vector([0, 1, 2, 3].map(component).into())
}

fn both<T: RealField + Copy>(velocity: &AngularVelocity<T>) -> [Vector; 2] {
    [velocity.device, velocity.reference].map(|rate| array(rate.rad_per_s()))
}

#[test]
fn derivative_of_q_and_rates_of_the_angles_give_the_velocity_of_the_matrix() {
    let mut random = Random(1);
    for _ in 0..100_000 {
        let (angles, rates) = (random.attitude(), random.vector(2.0));
        let expected = from_matrices(angles, rates);
        let [phi, theta, psi] = angles;
        let by_rates =
            AngularVelocity::from_angle_rates(&TaitBryan::from_rad(phi, theta, psi), vector(rates));
        let by_q = AngularVelocity::from_derivative(&quaternion(angles), &q_dot(angles, rates));
        for found in [both(&by_rates), both(&by_q)] {
            assert!(apart(found[0], expected[0]) < 1e-9);
            assert!(apart(found[1], expected[1]) < 1e-9);
        }
    }
}

#[test]
fn the_printed_velocity_is_in_neither_frame() {
    let (angles, rates) = ([0.3, -0.4, 1.1], [0.7, 0.5, -0.9]);
    let [device, reference] = from_matrices(angles, rates);
    assert!(apart(device, [0.350, 0.233, -0.940]) < 1e-3);
    assert!(apart(reference, [-0.153, 0.801, -0.627]) < 1e-3);
    let ([_, theta, psi], [d_phi, d_theta, d_psi]) = (angles, rates);
    let printed = [
        theta.cos() * psi.cos() * d_phi + psi.sin() * d_theta,
        -theta.cos() * psi.sin() * d_phi + psi.cos() * d_theta,
        theta.sin() * d_phi + d_psi,
    ];
    assert!(apart(printed, [0.738, -0.348, -1.173]) < 1e-3);
    // And 2 q⁻¹ q̇ with q reference to device, the other way to read the page, is −ω_r.
    let inverse = quaternion(angles).conjugate().into_inner();
    let d_inverse = q_dot(angles, rates).conjugate();
    let other = (inverse.conjugate() * d_inverse).imag() * 2.0;
    assert!(apart(array(-other), reference) < 1e-9);
}

fn worst<T: RealField + Copy>() -> f64 {
    let mut random = Random(2);
    let mut worst: f64 = 0.0;
    for _ in 0..2_000_000 {
        let v = random.vector(1.0);
        let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
        let axis = v.map(|c| c / length);
        let turn = match random.unit() {
            u if u < 0.2 => 10_f64.powf(random.between(-9.0, 0.0)),
            _ => random.between(0.0, 3.0),
        };
        // Seconds as long as the turn, within reason: the rate is of the order of 1.
        let time = turn.max(0.1);
        let start = transpose(&r(random.attitude()));
        let end = product(&start, &about(axis, turn)); // about an axis of the device
        let [q, p] = [start, end].map(|m| {
            let m = nalgebra::Matrix3::from_fn(|i, j| convert::<f64, T>(m[j][i]));
            from_matrix(&nalgebra::Rotation3::from_matrix_unchecked(m)).unwrap()
        });
        let found = AngularVelocity::between(&q, &p, Seconds(convert(time))).unwrap();
        let device = axis.map(|c| c * turn / time);
        let reference = apply(&start, device);
        let [found_device, found_reference] = both(&found);
        worst = worst
            .max(apart(found_device, device))
            .max(apart(found_reference, reference));
    }
    worst
}

#[test]
fn between_two_attitudes_a_steady_turn_is_exact() {
    let worst_double = worst::<f64>();
    assert!(worst_double < 1e-9, "{worst_double:e}");
    let worst_single = worst::<f32>();
    assert!(worst_single < 1e-5, "{worst_single:e}");
}

#[test]
fn a_change_of_sign_between_samples_is_no_turn() {
    let (q, p) = (quaternion([0.3, -0.4, 1.1]), quaternion([0.3, -0.4, 1.2]));
    let time = Seconds(0.1);
    let plus = AngularVelocity::between(&q, &p, time).unwrap();
    let negative = negated(&p);
    let minus = AngularVelocity::between(&q, &negative, time).unwrap();
    assert_eq!(plus, minus);
    assert!(apart(both(&plus)[1], [0.0, 0.0, 1.0]) < 1e-12);
    // The plain difference for q̇ would have it turn backwards.
    let difference = (negative.into_inner() - q.into_inner()) / time.0;
    let naive = AngularVelocity::from_derivative(&q, &difference);
    assert!(apart(both(&naive)[1], [0.0, 0.0, -1.0]) < 1e-3);
    assert_eq!(nearer(&q, &negative), p);
    assert_eq!(nearer(&q, &p), p);
}

#[test]
fn a_difference_quotient_falls_short_by_the_cube_of_the_turn() {
    let turn = 0.2;
    let (q, p) = (quaternion([0.0; 3]), quaternion([0.0, 0.0, turn]));
    let quotient = p.into_inner() - q.into_inner();
    let short = turn
        - AngularVelocity::from_derivative(&q, &quotient)
            .device
            .rad_per_s()
            .z;
    assert!((short - turn.powi(3) / 24.0).abs() < 1e-5);
    let exact = AngularVelocity::between(&q, &p, Seconds(1.0)).unwrap();
    assert!((exact.device.rad_per_s().z - turn).abs() < 1e-15);
}

#[test]
fn without_a_positive_finite_time_there_is_no_velocity() {
    let (q, p) = (quaternion([0.3, -0.4, 1.1]), quaternion([0.3, -0.4, 1.2]));
    for time in [0.0, -0.01, f64::NAN, f64::INFINITY, 1e-320] {
        assert_eq!(AngularVelocity::between(&q, &p, Seconds(time)), None);
    }
    let huge = AngularVelocity::between(&q, &p, Seconds(1e300)).unwrap();
    assert!(huge.device.rad_per_s().norm() < 1e-299);
}

#[test]
fn the_total_velocity_is_steady_where_the_rates_of_the_angles_are_not() {
    // Section 1: differentiating angles is the well-known way. A steady turn of 1 rad/s that
    // passes half a degree from θ = π/2.
    let (mut angle_rate, mut total_off): (f64, f64) = (0.0, 0.0);
    let time = 1e-3;
    let tilted = about([0.0, 0.0, 1.0], 0.0087);
    let attitude = |k: u32| {
        let turn = 1.2 + f64::from(k) * time;
        let m = product(&tilted, &about([0.0, 1.0, 0.0], turn));
        let m = product(&m, &about([0.0, 0.0, 1.0], 0.0087));
        let m = nalgebra::Matrix3::from_fn(|i, j| m[j][i]);
        from_matrix(&nalgebra::Rotation3::from_matrix_unchecked(m)).unwrap()
    };
    for k in 0..700 {
        let (q, p) = (attitude(k), attitude(k + 1));
        let velocity = AngularVelocity::between(&q, &p, Seconds(time)).unwrap();
        total_off = total_off.max((velocity.device.rad_per_s().norm() - 1.0).abs());
        let (a, b) = (rad(&to_angles(&q, None)), rad(&to_angles(&p, None)));
        angle_rate = angle_rate.max(((b[2] - a[2]) / time).abs());
    }
    assert!(total_off < 1e-9, "{total_off:e}");
    assert!(angle_rate > 50.0, "{angle_rate}");
    // Nor are they the same thing anywhere but level: nose up, φ̇ and ψ̇ are one axis.
    let up = TaitBryan::from_rad(0.0, FRAC_PI_2, 0.0);
    let spin = AngularVelocity::from_angle_rates(&up, vector([PI, 0.0, PI]));
    assert!(spin.device.rad_per_s().norm() < 1e-12);
}
