//! The same filter written once more, with rotation matrices, exponentials and nothing of the
//! library: what it does is the definition, so it is defined twice.

use nalgebra::RealField;
use vrduino::fusion::Parameters;

use crate::matrices::{Matrix, Vector, apply, degrees_between, length, product, rotation, turn};
use crate::random::Random;
use crate::world::{Body, DT, G, dps, fusion, matrix, sample};

const TAU: f64 = 3.0;
const ZETA: f64 = 0.5;

/// Six axes, without rest and integral: those are judged by what they find.
struct Reference {
    attitude: Matrix,
    error: [f64; 2],
    age: u32,
}

impl Reference {
    fn update(&mut self, rate: Vector, force: Vector) {
        let natural = 2_f64.sqrt() / TAU;
        let low_pass = 1.0 - (-2.0 * ZETA * natural * DT).exp();
        let share = natural * DT / (2.0 * ZETA);
        self.attitude = product(&self.attitude, &turn(rate, DT));
        let [x, _, z] = apply(&self.attitude, force).map(|part| part / G);
        let e = [-z, x];
        let c = if self.age < 1000 {
            self.age += 1;
            e.map(|e| e.clamp(-1.0, 1.0) / f64::from(self.age))
        } else {
            for (error, e) in self.error.iter_mut().zip(e) {
                *error += low_pass * (e - *error);
            }
            self.error.map(|error| error * share)
        };
        let size = c[0].hypot(c[1]);
        if size > 0.0 {
            // (1, c/2) made a unit quaternion turns by 2 atan(|c|/2), not by |c|.
            let angle = 2.0 * (size / 2.0).atan();
            let correction = rotation([c[0] / size, 0.0, c[1] / size], angle);
            self.attitude = product(&correction, &self.attitude);
        }
    }
}

/// Never at rest: a head that turns about all axes and is pushed about.
fn motion(i: u32) -> (Vector, Vector) {
    let t = f64::from(i) * DT;
    let rate = [
        (3.1 * t).sin(),
        0.7 * (1.7 * t).cos(),
        1.3 * (2.3 * t).sin(),
    ];
    let push = [
        2.0 * (9.0 * t).sin(),
        (13.0 * t).cos(),
        3.0 * (7.0 * t).sin(),
    ];
    (rate, push)
}

fn follows_the_reference<T: RealField + Copy>(tolerance: f64) {
    let c = nalgebra::convert::<f64, T>;
    let parameters = Parameters {
        tilt_integral: c(0.0),
        rest_rate_dps: c(0.0),
        ..Parameters::default()
    };
    let mut fusion = fusion::<T>(&parameters);
    let mut body = Body::level();
    let mut reference = Reference {
        attitude: body.attitude,
        error: [0.0; 2],
        age: 0,
    };
    for i in 0..60_000 {
        let (rate, push) = motion(i);
        let (rate, force, _) = body.read(rate, push);
        if i == 0 {
            // Level by the first force: the turn that takes it to up about a horizontal axis.
            let [x, y, z] = force.map(|part| part / length(force));
            let horizontal = x.hypot(z);
            if horizontal > 0.0 {
                let axis = [-z / horizontal, 0.0, x / horizontal];
                reference.attitude = rotation(axis, horizontal.atan2(y));
            }
        }
        reference.update(rate, force);
        fusion.update(&sample(rate, force), None);
        let off = degrees_between(&matrix(&fusion.orientation()), &reference.attitude);
        assert!(off < tolerance, "{off}° after {i} samples");
    }
}

#[test]
fn in_double_precision_it_is_the_filter_as_defined() {
    follows_the_reference::<f64>(1e-7);
}

#[test]
fn in_single_precision_it_stays_within_a_hundredth_of_a_degree() {
    follows_the_reference::<f32>(0.01);
}

#[test]
fn an_error_of_tilt_is_gone_after_a_few_time_constants() {
    let mut body = Body::level();
    let mut fusion = fusion::<f64>(&Parameters::default());
    let spin = dps([0.0, 15.0, 0.0]);
    for _ in 0..3000 {
        let (rate, force, _) = body.read(spin, [0.0; 3]);
        fusion.update(&sample(rate, force), None);
    }
    fusion.set_bias(vrduino::units::AngularRate::zero());
    fusion.set(nalgebra::UnitQuaternion::from_axis_angle(
        &nalgebra::Vector3::x_axis(),
        0.2,
    ));
    let mut tilt = Vec::new();
    for _ in 0..20_000 {
        let (rate, force, _) = body.read(spin, [0.0; 3]);
        fusion.update(&sample(rate, force), None);
        let up = matrix(&fusion.orientation())[1];
        tilt.push(up[0].hypot(up[2]).atan2(up[1]).to_degrees());
    }
    assert!((tilt[0] - 11.46).abs() < 0.1, "{}", tilt[0]);
    assert!(tilt[3000] < 6.0, "{}° after τ", tilt[3000]);
    assert!(tilt[15_000] < 1.0, "{}° after 5 τ", tilt[15_000]);
}

#[test]
fn pushes_that_come_back_do_not_tilt_it() {
    let mut body = Body::level();
    let mut fusion = fusion::<f64>(&Parameters::default());
    let mut worst = 0.0_f64;
    for i in 0..30_000 {
        let t = f64::from(i) * DT;
        // Half a g to and fro, twice a second.
        let push = [0.5 * G * (12.566 * t).sin(), 0.0, 0.0];
        let (rate, force, _) = body.read([0.0; 3], push);
        fusion.update(&sample(rate, force), None);
        if i > 5000 {
            worst = crate::matrices::larger(
                worst,
                degrees_between(&matrix(&fusion.orientation()), &body.attitude),
            );
        }
    }
    // The force itself leans by 27°.
    assert!(worst < 1.5, "{worst}°");
}

#[test]
fn it_starts_level_from_any_attitude() {
    let mut random = Random(5);
    for _ in 0..200 {
        let mut body = Body::level();
        body.attitude = turn(random.vector(3.0), 1.0);
        let mut fusion = fusion::<f64>(&Parameters::default());
        let (rate, force, _) = body.read([0.0; 3], [0.0; 3]);
        fusion.update(&sample(rate, force), None);
        let up = apply(&matrix(&fusion.orientation()), force.map(|part| part / G));
        assert!((up[1] - 1.0).abs() < 1e-12, "{up:?}");
    }
}
