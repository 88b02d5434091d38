//! The blog post's drift correction is right where the post is not: for a gyro fixed to the body,
//! in the order of tilt and yaw, and in the sign of yaw. The printed forms stand beside it.

mod matrices;

mod random;

mod rotations;

use nalgebra::{Matrix3, RealField, UnitQuaternion, Vector3, convert};
use rotations::{
    IDENTITY, Matrix, Random, angle_between, anything, apply, assert_is_a_rotation, exponential,
    larger, largest_difference, length, matrix, product, random_quaternion, reading, rotation,
    transpose, unit_quaternion,
};
use std::f64::consts::{FRAC_PI_2, PI};
use vrduino::calibration::Reading;
use vrduino::orientation::complementary::Complementary;
use vrduino::orientation::drift::{DriftCorrection, correct, error};
use vrduino::orientation::quaternion::{axis_angle, from_axis_angle, from_matrix};
use vrduino::orientation::{TimeConstant, yaw};
use vrduino::sensor::Sample;
use vrduino::sensor::measurement::{Calibration, Triaxial};
use vrduino::units::{Angle, AngularRate, MagneticField, Seconds, SpecificForce};

const G: f64 = 9.81;
const DT: f64 = 0.01;

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];

/// The field of the earth in the world: to −z, and down by the dip.
fn earth(dip_degrees: f64) -> [f64; 3] {
    let (sin, cos) = dip_degrees.to_radians().sin_cos();
    [0.0, -48.0 * sin, -48.0 * cos]
}

fn field<T: RealField + Copy>(v: [f64; 3]) -> MagneticField<T> {
    MagneticField::from_microtesla(vector(v))
}

fn force<T: RealField + Copy>(v: [f64; 3]) -> SpecificForce<T> {
    SpecificForce::from_m_per_s2(vector(v))
}

fn vector<T: RealField + Copy>(v: [f64; 3]) -> Vector3<T> {
    Vector3::from(v.map(convert::<f64, T>))
}

/// What a resting board feels of something fixed in the world.
fn felt(orientation: &Matrix, world: [f64; 3]) -> [f64; 3] {
    apply(&transpose(orientation), world)
}

fn yaw_degrees(world: [f64; 3]) -> Option<f64> {
    yaw::error(field::<f64>(world)).map(Angle::degrees)
}

#[test]
fn yaw_has_a_sign_and_no_dip_in_it() {
    for (dip, heading) in [
        (60.0, -30.0),
        (60.0, 0.0),
        (60.0, 30.0),
        (-80.0, 179.0),
        (0.0, -90.0),
    ] {
        // An estimate turned too far by the heading sees the field turned by it.
        let n = apply(&rotation(Y, f64::to_radians(heading)), earth(dip));
        let psi = yaw_degrees(n).expect("a horizontal part");
        assert!((psi - heading).abs() < 1e-9, "{dip} {heading} {psi}");
    }
    // As printed, cos⁻¹(−n·z/|n|): 64.3°, 60°, 64.3° for −30°, 0°, 30° at a dip of 60°.
    for (heading, printed) in [(-30.0, 64.3), (0.0, 60.0), (30.0, 64.3)] {
        let n = apply(&rotation(Y, f64::to_radians(heading)), earth(60.0));
        let psi = (-n[2] / length(n)).acos().to_degrees();
        assert!((psi - printed).abs() < 0.05, "{psi}");
    }
}

#[test]
fn yaw_is_unknown_where_the_field_has_no_horizontal_part() {
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    for v in [
        [0.0; 3],
        [0.0, 48.0, 0.0],
        [0.0, -48.0, 0.0],
        [1e-5, -48.0, 1e-5],
    ] {
        assert_eq!(yaw_degrees(v), None, "{v:?}");
    }
    for axis in 0..3 {
        for bad in bad {
            let mut v = earth(60.0);
            v[axis] = bad;
            assert_eq!(yaw_degrees(v), None, "{v:?}");
        }
    }
    // Of any strength it is the same, and a count of the magnetometer is seen.
    for size in [1e-300, 1e-30, 1.0, 1e300] {
        assert_eq!(yaw_degrees(earth(60.0).map(|c| c * size)), Some(0.0));
    }
    assert_eq!(yaw_degrees([0.15, -48.0, 0.0]), Some(-90.0));
}

/// The largest angle by which d times the truth misses the estimate.
fn error_is_what_separates<T: RealField + Copy>(tolerance: f64) {
    let mut random = Random(51);
    for _ in 0..2_000_000 {
        let truth = random.rotation();
        let estimate = unit_quaternion::<T>(random_quaternion(&mut random));
        let n = earth(random.between(-75.0, 75.0));
        let d = error(
            estimate,
            force(felt(&truth, [0.0, G, 0.0])),
            Some(field(felt(&truth, n))),
        );
        // Two vectors fix an orientation: there is only one d.
        let expected = product(&matrix(&estimate), &transpose(&truth));
        let off = largest_difference(&matrix(&d), &expected);
        assert!(off < tolerance, "{off:e}");
        let corrected = correct(estimate, d, T::one());
        assert!(largest_difference(&matrix(&corrected), &truth) < 2.0 * tolerance);
    }
}

#[test]
fn force_and_field_together_show_the_whole_error() {
    error_is_what_separates::<f64>(1e-9);
    error_is_what_separates::<f32>(1e-5);
}

#[test]
fn a_share_of_the_error_is_taken_out_along_its_own_axis() {
    let mut random = Random(52);
    for _ in 0..200_000 {
        let (axis, angle) = (random.direction(), random.between(0.0, 3.1));
        let (truth, alpha) = (random.rotation(), random.unit());
        let d = from_axis_angle(Vector3::from(axis), Angle::from_rad(angle)).expect("an axis");
        let sign = if random.unit() < 0.5 { 1.0 } else { -1.0 };
        let d = UnitQuaternion::new_unchecked(d.into_inner() * sign);
        let start = product(&rotation(axis, angle), &truth);
        let start = from_matrix(&Matrix3::from_fn(|i, j| start[i][j]));
        let q = correct(start.expect("a rotation"), d, alpha);
        let expected = product(&rotation(axis, (1.0 - alpha) * angle), &truth);
        assert!(largest_difference(&matrix(&q), &expected) < 1e-9);
    }
}

#[test]
fn without_a_magnetometer_it_is_the_complementary_filter() {
    let mut random = Random(53);
    for alpha in [0.0, 0.02, 0.5, 1.0] {
        let tau = TimeConstant::from_gyro_weight(1.0 - alpha, Seconds(DT));
        let mut notes = Complementary::new(tau, Seconds(DT));
        let mut post = DriftCorrection::new(alpha, Seconds(DT));
        for _ in 0..2000 {
            let sample = reading::<f64>(random.vector(5.0), random.vector(10.0));
            let (a, b) = (notes.update(&sample), post.update(&sample, None));
            assert!(largest_difference(&matrix(&a), &matrix(&b)) < 1e-9);
        }
    }
}

#[test]
fn the_gyro_turns_about_the_axes_of_the_body() {
    // A quarter turn about x, then a quarter turn about the body's y.
    let mut filter = DriftCorrection::new(0.0, Seconds(1.0));
    filter.update(&reading::<f64>(X.map(|c| c * FRAC_PI_2), [0.0; 3]), None);
    let q = filter.update(&reading(Y.map(|c| c * FRAC_PI_2), [0.0; 3]), None);
    let step = |axis: [f64; 3]| exponential(axis.map(|c| c * FRAC_PI_2));
    let truth = product(&step(X), &step(Y));
    assert!(largest_difference(&matrix(&q), &truth) < 1e-12);
    let half = [q.w, q.i, q.j, q.k].map(|c| (c - 0.5).abs());
    assert!(half.into_iter().all(|off| off < 1e-12));
    // As printed, Δq q: 120° off.
    let printed = product(&step(Y), &step(X));
    assert!((angle_between(&printed, &truth).to_degrees() - 120.0).abs() < 1e-9);
}

#[test]
fn the_order_of_tilt_and_yaw_matters() {
    let (tilt, yaw) = (
        rotation(X, 40_f64.to_radians()),
        rotation(Y, 60_f64.to_radians()),
    );
    let apart = angle_between(&product(&tilt, &yaw), &product(&yaw, &tilt)).to_degrees();
    assert!((apart - 39.4).abs() < 0.05, "{apart}");
    // The library's is d_tilt d_yaw: its tilt has a horizontal axis, and what is left is yaw.
    let truth = IDENTITY;
    let estimate = from_axis_angle(Vector3::x(), Angle::from_degrees(40.0)).expect("an axis")
        * from_axis_angle(Vector3::y(), Angle::from_degrees(60.0)).expect("an axis");
    let up = force(felt(&truth, [0.0, G, 0.0]));
    let d_tilt = error(estimate, up, None);
    assert!(largest_difference(&matrix(&d_tilt), &tilt) < 1e-9);
    let d = error(estimate, up, Some(field(felt(&truth, earth(60.0)))));
    assert!(largest_difference(&matrix(&d), &product(&tilt, &yaw)) < 1e-9);
}

#[test]
fn yaw_read_before_tilt_is_taken_out_is_wrong() {
    // No error of yaw at all, a tilt of 20° about the north-south axis, and a dip of 60°.
    let lean = from_axis_angle(Vector3::z(), Angle::from_degrees(20.0)).expect("an axis");
    let seen = apply(&matrix(&lean), earth(60.0));
    let early = yaw_degrees(seen).expect("a horizontal part");
    assert!((early.abs() - 30.6).abs() < 0.1, "{early}");
    let d = error(lean, force([0.0, G, 0.0]), Some(field(earth(60.0))));
    assert!(largest_difference(&matrix(&d), &matrix(&lean)) < 1e-9);
}

#[test]
fn the_tilt_axis_of_the_post_turns_up_into_u_and_not_back() {
    let mut random = Random(54);
    for _ in 0..100_000 {
        let u = random.direction();
        let horizontal = u[0].hypot(u[2]);
        // t = (u_z, 0, −u_x) by φ, as printed.
        let axis = [u[2] / horizontal, 0.0, -u[0] / horizontal];
        let printed = rotation(axis, u[1].acos());
        let turned = apply(&printed, Y);
        assert!((0..3).all(|i| (turned[i] - u[i]).abs() < 1e-7));
        // It is the error all the same, and its inverse is the notes' correction.
        let d = error(UnitQuaternion::identity(), force::<f64>(u), None);
        assert!(largest_difference(&matrix(&d), &printed) < 1e-7);
    }
}

#[test]
fn drift_of_yaw_ends_with_a_magnetometer_and_not_without() {
    // A gyro that reads 1 °/s too much about y, for a minute, on a board that leans.
    let truth = rotation([0.6, 0.0, 0.8], 0.5);
    let bias = felt(&truth, [0.0, 1_f64.to_radians(), 0.0]);
    let (up, north) = (felt(&truth, [0.0, G, 0.0]), felt(&truth, earth(60.0)));
    let start = from_axis_angle(Vector3::new(0.6, 0.0, 0.8), Angle::from_rad(0.5));
    let off_after_a_minute = |field_seen: &dyn Fn(u32) -> bool| {
        let mut filter = DriftCorrection::new(0.02, Seconds(DT));
        filter.set(start.expect("an axis"));
        for i in 0..6000 {
            let seen = field_seen(i).then(|| field::<f64>(north));
            filter.update(&reading(bias, up), seen);
        }
        angle_between(&truth, &matrix(&filter.orientation())).to_degrees()
    };
    assert!((off_after_a_minute(&|_| false) - 60.0).abs() < 1e-6);
    // Each sample adds b Δt and takes out α of the whole: b Δt (1 − α)/α is left.
    let bound = DT * 0.98 / 0.02;
    assert!((off_after_a_minute(&|_| true) - bound).abs() < 1e-6);
    // With a magnetometer ten times slower than the gyro, a little more.
    let stale = off_after_a_minute(&|i| i % 10 == 9);
    assert!((stale - 10.0 * bound).abs() < 1e-4, "{stale}");
}

/// What the filter settles on, level and without yaw, under this force.
fn settled(force_seen: [f64; 3], alpha: f64) -> Matrix {
    let mut filter = DriftCorrection::new(alpha, Seconds(DT));
    for _ in 0..3000 {
        filter.update(&reading([0.0; 3], force_seen), Some(field(earth(60.0))));
    }
    matrix(&filter.orientation())
}

#[test]
fn an_acceleration_passes_for_a_tilt() {
    // To the right with 1 m/s²: the sum leans by atan(1/9.81) = 5.82°, and so does the estimate.
    for alpha in [0.02, 0.5, 1.0] {
        let off = settled([1.0, G, 0.0], alpha);
        let up = apply(&off, [1.0 / G.hypot(1.0), G / G.hypot(1.0), 0.0]);
        assert!((up[1] - 1.0).abs() < 1e-9);
        let lean = apply(&off, Y)[1].acos().to_degrees();
        assert!((lean - 5.82).abs() < 5e-3, "{lean}");
    }
}

#[test]
fn the_strength_of_gravity_plays_no_part() {
    let (up, tenth) = ([3.0, 8.0, -4.0], [0.3, 0.8, -0.4]);
    let apart = largest_difference(&settled(up, 0.1), &settled(tenth, 0.1));
    assert!(apart < 1e-12, "{apart:e}");
}

#[test]
fn a_gain_outside_of_0_to_1_is_the_nearer_end() {
    let wrong = unit_quaternion::<f64>([0.8, 0.0, 0.6, 0.0]);
    let all = matrix(&wrong);
    for (gain, left) in [
        (-3.0, all),
        (f64::NAN, all),
        (1.5, IDENTITY),
        (f64::INFINITY, IDENTITY),
    ] {
        let mut filter = DriftCorrection::new(gain, Seconds(DT));
        filter.set(wrong);
        let q = filter.update(&reading([0.0; 3], [0.0, G, 0.0]), Some(field(earth(60.0))));
        assert!(largest_difference(&matrix(&q), &left) < 1e-12, "{gain}");
    }
}

#[test]
fn without_a_direction_of_up_nothing_is_corrected() {
    let estimate = unit_quaternion::<f64>([0.5, 0.5, 0.5, 0.5]);
    for up in [[0.0; 3], [f64::NAN, G, 0.0], [0.0, f64::INFINITY, 0.0]] {
        let d = error(estimate, force(up), Some(field(earth(60.0))));
        assert_eq!(d, UnitQuaternion::identity());
    }
    // A vertical field leaves the tilt to be corrected and yaw as it is.
    let up = force([G, 0.0, 0.0]);
    let d = error(estimate, up, Some(field([48.0, 0.0, 0.0])));
    assert_eq!(d, error(estimate, up, None));
    // Upside down is half a turn, and with a compass there is only one.
    let d = error(
        UnitQuaternion::identity(),
        force::<f64>([0.0, -G, 0.0]),
        Some(field([0.0, 40.0, -30.0])),
    );
    let over = rotation([0.0, 0.0, 1.0], PI);
    assert!(largest_difference(&matrix(&d), &over) < 1e-9);
}

fn survives<T: RealField + Copy>(tolerance: f64) {
    let mut random = Random(55);
    for _ in 0..100 {
        let mut any = || convert::<f64, T>(anything(&mut random));
        let mut filter = DriftCorrection::new(any(), Seconds(any()));
        for _ in 0..1000 {
            let [w, a, m] = [(); 3].map(|()| [(); 3].map(|()| anything(&mut random)));
            let seen = (random.unit() < 0.5).then(|| field(m));
            let q = filter.update(&reading::<T>(w, a), seen);
            assert_is_a_rotation(&q, tolerance);
            let d = axis_angle(error(q, force(a), Some(field(m))));
            assert!(d.angle.rad().is_finite());
            if let Some(psi) = yaw::error::<T>(field(m)) {
                assert!(psi.rad().is_finite());
            }
        }
    }
}

#[test]
fn no_input_makes_anything_but_a_rotation() {
    survives::<f64>(1e-10);
    survives::<f32>(1e-6);
}

#[test]
fn an_error_of_a_ten_thousandth_is_resolved_in_single_precision() {
    for axis in [X, Y, [0.6, 0.0, 0.8], [0.6, 0.8, 0.0]] {
        let truth = rotation(axis, -1e-4);
        let d = axis_angle(error(
            UnitQuaternion::<f32>::identity(),
            force(felt(&truth, [0.0, G, 0.0])),
            Some(field(felt(&truth, earth(60.0)))),
        ));
        assert!((d.angle.rad() - 1e-4).abs() < 1e-6, "{d:?}");
        let off = (0..3).map(|i| (f64::from(d.axis[i]) - axis[i]).abs());
        assert!(off.fold(0.0, larger) < 0.01, "{d:?}");
    }
}

/// Three sensors off their axes by up to a tenth, and off zero: what 001 calibrates.
struct Triad {
    a: Matrix,
    b: [f64; 3],
}

impl Triad {
    fn new(random: &mut Random, largest_offset: f64) -> Self {
        let faults = [(); 3].map(|()| random.vector(0.1));
        let a = [0, 1, 2].map(|i| [0, 1, 2].map(|j| IDENTITY[i][j] + faults[i][j]));
        let b = random.vector(largest_offset);
        Self { a, b }
    }

    /// What it reads of the truth: A x + b = truth, solved for x by Cramer's rule.
    fn reads(&self, truth: [f64; 3]) -> [f64; 3] {
        let right = [0, 1, 2].map(|i| truth[i] - self.b[i]);
        let columns = transpose(&self.a);
        [0, 1, 2].map(|j| {
            let mut replaced = columns;
            replaced[j] = right;
            determinant(&replaced) / determinant(&columns)
        })
    }

    fn calibration<Q: Triaxial>(&self) -> Calibration<Q> {
        let matrix = Matrix3::from_fn(|i, j| convert(self.a[i][j]));
        let offset = Vector3::from(self.b.map(convert::<f64, Q::Scalar>));
        Calibration::new(matrix, Q::from_components(offset))
    }
}

fn determinant([a, b, c]: &Matrix) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// The whole of 001, from what three faulty sensors read on a tumbling board to its orientation.
/// The gyro's step turns estimate and truth alike, so that the error keeps its axis: after k
/// samples (1 − α)ᵏ of its angle is left, of the tilt alone where there is no magnetometer.
fn from_readings_to_orientation<T: RealField + Copy>(compass: bool, tolerance: f64) {
    let mut random = Random(56);
    for _ in 0..20 {
        let [gyro, accelerometer] = [0.3, 1.0].map(|offset| Triad::new(&mut random, offset));
        let magnetometer = Triad::new(&mut random, 10.0);
        let (by_gyro, by_accelerometer) = (gyro.calibration(), accelerometer.calibration());
        let by_magnetometer = magnetometer.calibration::<MagneticField<T>>();
        let mut truth = random.rotation();
        let (angle, turned) = (random.between(0.0, 3.0), random.between(-PI, PI));
        let (axis, rest) = if compass {
            (random.direction(), IDENTITY)
        } else {
            ([turned.cos(), 0.0, turned.sin()], rotation(Y, turned))
        };
        let wrong = product(&product(&rotation(axis, angle), &rest), &truth);
        let alpha = random.between(0.01, 0.2);
        let mut filter = DriftCorrection::new(convert(alpha), Seconds(convert::<f64, T>(DT)));
        let start = from_matrix(&Matrix3::from_fn(|i, j| convert::<f64, T>(wrong[i][j])));
        filter.set(start.expect("a rotation"));
        let north = earth(60.0);
        for k in 1..=500 {
            let rate = random.vector(10.0);
            truth = product(&truth, &exponential(rate.map(|w| w * DT)));
            let sample = Sample {
                rate: AngularRate::from_rad_per_s(vector(gyro.reads(rate))),
                force: force(accelerometer.reads(felt(&truth, [0.0, G, 0.0]))),
            };
            let calibrated = Reading::calibrated(sample, &by_gyro, &by_accelerometer);
            let seen = field::<T>(magnetometer.reads(felt(&truth, north)));
            let seen = compass.then(|| by_magnetometer.corrected(seen));
            let q = filter.update(&calibrated, seen);
            let left = rotation(axis, angle * (1.0 - alpha).powi(k));
            let expected = product(&product(&left, &rest), &truth);
            let off = largest_difference(&matrix(&q), &expected);
            assert!(off < tolerance, "{k}: {off:e}");
        }
    }
}

#[test]
fn calibrated_readings_lead_to_the_orientation() {
    from_readings_to_orientation::<f64>(true, 1e-9);
    from_readings_to_orientation::<f32>(true, 1e-5);
}

#[test]
fn calibrated_readings_without_a_magnetometer_lead_to_the_tilt_and_leave_yaw() {
    from_readings_to_orientation::<f64>(false, 1e-9);
    from_readings_to_orientation::<f32>(false, 1e-5);
}
