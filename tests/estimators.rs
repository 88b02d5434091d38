//! The estimators follow the course notes, and no input makes them return anything but a rotation.

use nalgebra::{Quaternion, RealField, UnitQuaternion, Vector3, convert};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use vrduino::calibration::{GyroBias, Reading};
use vrduino::orientation::angles::pitch_and_roll;
use vrduino::orientation::complementary::Complementary;
use vrduino::orientation::flatland::Flatland;
use vrduino::orientation::gyro::DeadReckoning;
use vrduino::orientation::{DEFAULT_TIME_CONSTANT, TimeConstant, tilt};
use vrduino::sensor::Sample;
use vrduino::units::{AngularRate, Seconds, SpecificForce};

const G: f64 = 9.81;
const DT: f64 = 0.001;

/// The notes once more, in double precision, with matrices and trigonometry instead of
/// quaternions and series. It shares no arithmetic with the library.
mod reference {
    pub type Vector = [f64; 3];
    pub type Matrix = [[f64; 3]; 3];

    pub const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
        let mut c = [[0.0; 3]; 3];
        for (i, row) in c.iter_mut().enumerate() {
            for (j, element) in row.iter_mut().enumerate() {
                *element = (0..3).map(|k| a[i][k] * b[k][j]).sum();
            }
        }
        c
    }

    pub fn apply(a: &Matrix, v: Vector) -> Vector {
        [0, 1, 2].map(|i| (0..3).map(|k| a[i][k] * v[k]).sum())
    }

    pub fn transpose(a: &Matrix) -> Matrix {
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[j][i]))
    }

    /// Rodrigues: about a unit axis by an angle.
    pub fn rotation(axis: Vector, angle: f64) -> Matrix {
        let ([x, y, z], (s, c)) = (axis, angle.sin_cos());
        let d = 1.0 - c;
        [
            [c + x * x * d, x * y * d - z * s, x * z * d + y * s],
            [y * x * d + z * s, c + y * y * d, y * z * d - x * s],
            [z * x * d - y * s, z * y * d + x * s, c + z * z * d],
        ]
    }

    fn length(v: Vector) -> f64 {
        v.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Eq. 17 and 18.
    pub fn gyro(r: &Matrix, rate: Vector, dt: f64) -> Matrix {
        let size = length(rate);
        if size == 0.0 {
            return *r;
        }
        product(r, &rotation(rate.map(|w| w / size), size * dt))
    }

    /// Eq. 20 to 24. `share` is 1 − α.
    pub fn tilt(r: &Matrix, force: Vector, share: f64) -> Matrix {
        let [x, y, z] = apply(r, force);
        let horizontal = x.hypot(z);
        if horizontal == 0.0 {
            return *r;
        }
        let axis = [-z / horizontal, 0.0, x / horizontal];
        product(&rotation(axis, share * horizontal.atan2(y)), r)
    }
}

/// Reproducible random numbers (xorshift64*).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn vector(&mut self, size: f64) -> [f64; 3] {
        [(); 3].map(|()| self.between(-size, size))
    }
}

fn reading<T: RealField + Copy>(rad_per_s: [f64; 3], m_per_s2: [f64; 3]) -> Reading<T> {
    let vector = |v: [f64; 3]| Vector3::from(v.map(convert::<f64, T>));
    GyroBias::zero().correct(Sample {
        rate: AngularRate::from_rad_per_s(vector(rad_per_s)),
        force: SpecificForce::from_m_per_s2(vector(m_per_s2)),
    })
}

fn components<T: RealField + Copy>(q: &UnitQuaternion<T>) -> [f64; 4] {
    [q.w, q.i, q.j, q.k].map(|c| nalgebra::try_convert::<T, f64>(c).expect("a real number"))
}

/// Eq. 33.
fn matrix<T: RealField + Copy>(q: &UnitQuaternion<T>) -> reference::Matrix {
    let [w, x, y, z] = components(q);
    [
        [
            w * w + x * x - y * y - z * z,
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
        ],
        [
            2.0 * (x * y + w * z),
            w * w - x * x + y * y - z * z,
            2.0 * (y * z - w * x),
        ],
        [
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            w * w - x * x - y * y + z * z,
        ],
    ]
}

fn largest_difference(a: &reference::Matrix, b: &reference::Matrix) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[track_caller]
fn assert_is_a_rotation<T: RealField + Copy>(q: &UnitQuaternion<T>, tolerance: f64) {
    let c = components(q);
    let norm = c.iter().map(|c| c * c).sum::<f64>().sqrt();
    // Also false for NaN.
    assert!((norm - 1.0).abs() <= tolerance, "{c:?}");
}

/// A few seconds of random turning about all axes, with the forces a board would feel.
fn motion(seed: u64, fastest_rad_per_s: f64) -> Vec<([f64; 3], [f64; 3])> {
    let mut random = Random(seed * 2 + 1);
    let parts: Vec<_> = (0..4)
        .map(|_| {
            let size = random.vector(fastest_rad_per_s / 4.0);
            (size, random.between(0.1, 3.0), random.between(0.0, TAU))
        })
        .collect();
    let mut truth = reference::rotation([0.6, 0.0, 0.8], random.between(0.0, PI));
    (0..5000)
        .map(|i| {
            let t = f64::from(i) * DT;
            let mut rate = [0.0; 3];
            for (size, hertz, phase) in &parts {
                for axis in 0..3 {
                    rate[axis] += size[axis] * (TAU * hertz * t + phase).sin();
                }
            }
            truth = reference::gyro(&truth, rate, DT);
            let mut force = reference::apply(&reference::transpose(&truth), [0.0, G, 0.0]);
            for (axis, noise) in random.vector(2.0).into_iter().enumerate() {
                force[axis] += noise;
                rate[axis] += 0.01;
            }
            (rate, force)
        })
        .collect()
}

/// Largest difference of any element of the rotation matrix over many motions.
fn deviation_from_the_notes<T: RealField + Copy>() -> f64 {
    let mut worst = 0.0_f64;
    // The default, one in between, and the course's α = 0.9 at 1 kHz.
    for tau in [7.6, 0.5, 0.009] {
        for seed in 0..20 {
            let fastest = [1.0, 5.0, 20.0, 60.0][seed as usize % 4];
            let time_constant = TimeConstant::new(Seconds(convert::<f64, T>(tau)));
            let mut filter = Complementary::new(time_constant, Seconds(convert::<f64, T>(DT)));
            let mut expected = reference::IDENTITY;
            for (rate, force) in motion(seed, fastest) {
                let q = filter.update(&reading::<T>(rate, force));
                assert_is_a_rotation(&q, 2e-6);
                let by_gyro = reference::gyro(&expected, rate, DT);
                expected = reference::tilt(&by_gyro, force, DT / (tau + DT));
                worst = worst.max(largest_difference(&matrix(&q), &expected));
            }
        }
    }
    worst
}

#[test]
fn in_double_precision_the_filter_is_that_of_the_notes() {
    let worst = deviation_from_the_notes::<f64>();
    assert!(worst < 1e-9, "{worst:e}");
}

#[test]
fn in_single_precision_the_filter_stays_within_a_hundredth_of_a_degree() {
    let worst = deviation_from_the_notes::<f32>();
    assert!(worst < 0.01_f64.to_radians(), "{worst:e}");
}

#[test]
fn dead_reckoning_is_that_of_the_notes() {
    for seed in 0..10 {
        let mut gyro = DeadReckoning::new(Seconds(DT));
        let mut expected = reference::IDENTITY;
        for (rate, force) in motion(seed, 30.0) {
            let q = gyro.update(&reading::<f64>(rate, force));
            expected = reference::gyro(&expected, rate, DT);
            assert!(largest_difference(&matrix(&q), &expected) < 1e-9);
        }
    }
}

#[test]
fn steps_of_any_size_are_exact() {
    // From a thousandth of a degree to three turns in one sample.
    for exponent in -50..=12 {
        let angle = 2.0_f64.powf(f64::from(exponent) / 4.0);
        for axis in [[1.0, 0.0, 0.0], [0.6, 0.0, -0.8], [0.48, 0.6, 0.64]] {
            let mut gyro = DeadReckoning::new(Seconds(1.0));
            let q = gyro.update(&reading::<f64>(axis.map(|a| a * angle), [0.0, G, 0.0]));
            let expected = reference::rotation(axis, angle);
            let difference = largest_difference(&matrix(&q), &expected);
            assert!(difference < 1e-13, "{angle}: {difference:e}");
        }
    }
}

#[test]
fn quarter_turns_go_the_right_way() {
    // With the world's y up: pitch up lifts −z, yaw left turns −z to −x, roll left drops −x.
    let cases = [
        ([FRAC_PI_2, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]),
        ([0.0, FRAC_PI_2, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]),
        ([0.0, 0.0, FRAC_PI_2], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]),
    ];
    for (rate, body, world) in cases {
        let mut gyro = DeadReckoning::new(Seconds(DT));
        for _ in 0..1000 {
            gyro.update(&reading::<f64>(rate, [0.0; 3]));
        }
        let turned = gyro.orientation() * Vector3::from(body);
        assert!((turned - Vector3::from(world)).amax() < 1e-12);
    }
}

#[test]
fn the_turn_is_about_the_axes_of_the_body() {
    // Pitch up a quarter turn, then yaw: the body's y now points back along the world's z.
    let mut gyro = DeadReckoning::new(Seconds(1.0));
    gyro.update(&reading::<f64>([FRAC_PI_2, 0.0, 0.0], [0.0; 3]));
    let q = gyro.update(&reading::<f64>([0.0, FRAC_PI_2, 0.0], [0.0; 3]));
    let expected = Quaternion::new(0.5, 0.5, 0.5, 0.5);
    assert!((q.into_inner() - expected).norm() < 1e-12);
}

#[test]
fn an_error_of_tilt_decays_to_one_part_in_e_in_the_time_constant() {
    for tau in [0.1, 1.0, 7.6] {
        let mut filter = Complementary::new(TimeConstant::new(Seconds(tau)), Seconds(DT));
        let start = 0.3;
        filter.set(UnitQuaternion::from_axis_angle(&Vector3::z_axis(), start));
        for _ in 0..(tau / DT).round() as u32 {
            filter.update(&reading::<f64>([0.0; 3], [0.0, G, 0.0]));
        }
        let left = filter.orientation().angle() / start;
        assert!((left - (-1.0_f64).exp()).abs() < 0.5 * DT / tau, "{left}");
    }
}

#[test]
fn weight_and_time_constant_say_the_same() {
    let tau = TimeConstant::from_gyro_weight(0.9, Seconds(DT));
    assert!((tau.time().0 - 0.009_f64).abs() < 1e-12);
    assert!((tau.accelerometer_weight(Seconds(DT)) - 0.1).abs() < 1e-12);
    assert_eq!(DEFAULT_TIME_CONSTANT.time(), Seconds(7.6));
}

#[test]
fn tilt_correction_never_turns_about_the_vertical() {
    let mut random = Random(11);
    for _ in 0..10_000 {
        let force = SpecificForce::from_m_per_s2(Vector3::from(random.vector(20.0)));
        let q = tilt::correction(force, random.unit());
        assert_eq!(q.j, 0.0);
    }
}

#[test]
fn full_correction_points_the_force_up_from_anywhere() {
    let mut random = Random(12);
    for i in 0..10_000 {
        // Near up, near down and everything between, at all scales.
        let mut v = Vector3::from(random.vector(1.0));
        if i % 2 == 0 {
            let spread = 10.0_f64.powf(random.between(-9.0, 0.0));
            v = Vector3::new(v.x * spread, v.y.signum(), v.z * spread);
        }
        let scale = 10.0_f64.powf(random.between(-30.0, 30.0));
        let force = SpecificForce::from_m_per_s2(v * scale);
        let up = tilt::correction(force, 1.0) * v.normalize();
        // The series near level is good to 1e-11.
        assert!((up - Vector3::y()).amax() < 1e-11, "{v:?} {up:?}");
    }
}

#[test]
fn the_corners_the_notes_leave_open_are_closed() {
    let force = |x, y, z| SpecificForce::from_m_per_s2(Vector3::<f64>::new(x, y, z));
    let identity = UnitQuaternion::identity();
    assert_eq!(tilt::correction(force(0.0, G, 0.0), 1.0), identity);
    assert_eq!(tilt::correction(force(0.0, 0.0, 0.0), 1.0), identity);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let mut v = Vector3::new(0.1, G, 0.2);
            v[axis] = bad;
            let q = tilt::correction(SpecificForce::from_m_per_s2(v), 1.0);
            assert_eq!(q, identity, "{v:?}");
        }
    }
    // Upside down: half a turn about a horizontal axis, in full or in part.
    let half_turn = tilt::correction(force(0.0, -G, 0.0), 1.0);
    assert!((half_turn.angle() - PI).abs() < 1e-12);
    assert_eq!(half_turn.j, 0.0);
    let tenth = tilt::correction(force(0.0, -G, 0.0), 0.1);
    assert!((tenth.angle() - PI / 10.0).abs() < 1e-12);
}

#[test]
fn levelling_keeps_the_heading() {
    let mut random = Random(13);
    for _ in 0..1000 {
        let yaw = random.between(-PI, PI);
        let (pitch, roll) = (random.between(-1.4, 1.4), random.between(-1.4, 1.4));
        let y = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), yaw);
        let x = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), pitch);
        let z = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), roll);
        let force = SpecificForce::from_m_per_s2((y * x * z).inverse() * Vector3::y() * G);
        let mut filter = Complementary::new(TimeConstant::new(Seconds(7.6)), Seconds(DT));
        filter.set(y);
        filter.level(force);
        let up = filter.orientation() * force.m_per_s2() / G;
        assert!((up - Vector3::y()).amax() < 1e-10);
        // What levelling added is a turn about a horizontal axis.
        assert!((filter.orientation() * y.inverse()).j.abs() < 1e-12);
        filter.reset(force);
        assert!((filter.orientation() * force.m_per_s2() / G - Vector3::y()).amax() < 1e-10);
        assert!(filter.orientation().j.abs() < 1e-12);
    }
}

#[test]
fn a_board_turned_upside_down_is_found_again() {
    let mut filter = Complementary::new(TimeConstant::new(Seconds(0.1_f32)), Seconds(0.001));
    for _ in 0..3000 {
        filter.update(&reading::<f32>([0.0; 3], [0.0, -G, 0.0]));
    }
    let up = filter.orientation() * -Vector3::y();
    assert!((up - Vector3::y()).amax() < 1e-5, "{up:?}");
}

/// Everything a float can be: ordinary, huge, tiny, zero, infinite, and not a number.
fn anything(random: &mut Random) -> f64 {
    let sign = if random.unit() < 0.5 { -1.0 } else { 1.0 };
    sign * match (random.unit() * 10.0) as u32 {
        0 => 0.0,
        1 => f64::NAN,
        2 => f64::INFINITY,
        3 => f64::from(f32::MAX),
        4 => f64::from(f32::MIN_POSITIVE),
        5 => f64::from(f32::from_bits(1)),
        6 => f64::from(f32::from_bits(random.unit().to_bits() as u32)),
        _ => 10.0_f64.powf(random.between(-3.0, 4.0)),
    }
}

fn survives_anything<T: RealField + Copy>(tolerance: f64) {
    let mut random = Random(14);
    let finite = |angle: T| assert!(angle.is_finite());
    for round in 0..100 {
        let (tau, dt) = match round {
            0 => (7.6, DT),
            1 => (7.6, 1e30),
            2 => (0.0, DT),
            3 => (-DT, DT),
            _ => (anything(&mut random), anything(&mut random)),
        };
        let (tau, dt) = (convert::<f64, T>(tau), Seconds(convert::<f64, T>(dt)));
        let tau = TimeConstant::new(Seconds(tau));
        let mut filter = Complementary::new(tau, dt);
        let mut gyro = DeadReckoning::new(dt);
        let mut flat = Flatland::new(tau, dt);
        for _ in 0..1000 {
            let rate = [(); 3].map(|()| anything(&mut random));
            let force = [(); 3].map(|()| anything(&mut random));
            let reading = reading::<T>(rate, force);
            assert_is_a_rotation(&filter.update(&reading), tolerance);
            assert_is_a_rotation(&gyro.update(&reading), tolerance);
            let roll = flat.update(&reading);
            for angle in [roll.gyro, roll.accelerometer, roll.fused] {
                finite(angle.rad());
            }
            let tilt = pitch_and_roll(reading.force());
            finite(tilt.pitch.rad());
            finite(tilt.roll.rad());
            if random.unit() < 0.01 {
                filter.level(reading.force());
                assert_is_a_rotation(&filter.orientation(), tolerance);
                filter.reset(reading.force());
                assert_is_a_rotation(&filter.orientation(), tolerance);
                flat.reset(reading.force());
                let bad = Quaternion::from(rate.map(convert::<f64, T>).push(tau.time().0));
                gyro.set(UnitQuaternion::new_unchecked(bad));
                assert_is_a_rotation(&gyro.orientation(), tolerance);
            }
        }
    }
}

/// An array with one more element.
trait Push<T> {
    fn push(self, last: T) -> [T; 4];
}

impl<T> Push<T> for [T; 3] {
    fn push(self, last: T) -> [T; 4] {
        let [a, b, c] = self;
        [a, b, c, last]
    }
}

#[test]
fn no_input_makes_anything_but_a_rotation_in_single_precision() {
    survives_anything::<f32>(1e-6);
}

#[test]
fn no_input_makes_anything_but_a_rotation_in_double_precision() {
    survives_anything::<f64>(1e-10);
}
