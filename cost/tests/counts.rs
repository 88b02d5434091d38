//! What `cargo cost` counts: within the budgets, the same every time, and right.

use std::path::Path;
use std::sync::OnceLock;

use vrduino_cost::count::{Count, count};
use vrduino_cost::reference::Orientation;
use vrduino_cost::subject::{OURS, Subject};
use vrduino_cost_images::filter::Filter;
use vrduino_cost_images::head::{FEW, HEAD, HEAD_Z_UP};
use vrduino_cost_images::ours::{Course, CourseInFixedPoint};

use vrduino::fixed::multiply::Portable;

/// Instructions of an update of the notes' filter in fixed point, with the multiply instructions.
const COURSE_BUDGET: u64 = 215;
/// The default estimator's with six axes, after the first sample.
const DEFAULT_BUDGET: u64 = 360;
/// The same with nine in a sample that has a field: 640, and the field's way from counts to units.
const COMPASS_BUDGET: u64 = 660;
/// What it may be off by, in degrees.
const DEFAULT_ERROR: f64 = 0.002;
const COMPASS_ERROR: f64 = 0.01;
/// The course filter's in plain Rust, which a compiler for another chip may do better.
const PORTABLE_BUDGET: u64 = 350;
/// What fixed point may be off by, in degrees.
const COURSE_ERROR: f64 = 1e-4;

fn subject(name: &str) -> &'static Subject {
    let mut subjects = OURS.subjects.iter();
    subjects
        .find(|subject| subject.name == name)
        .expect("a filter of ours")
}

fn counted(name: &str) -> Count {
    static IMAGE: OnceLock<std::path::PathBuf> = OnceLock::new();
    let image: &Path = IMAGE.get_or_init(|| OURS.build().expect("the images build"));
    count(image, subject(name)).expect("the filter runs")
}

fn on_the_host<F: Filter>() -> Vec<Orientation> {
    let mut filter = F::start();
    HEAD.iter()
        .map(|counts| {
            filter.update(counts);
            filter.orientation()
        })
        .collect()
}

#[test]
fn what_is_in_fixed_point_is_within_its_budget_and_right() {
    for (name, budget, most) in [
        ("course_fixed", COURSE_BUDGET, COURSE_ERROR),
        ("course_fixed_portable", PORTABLE_BUDGET, COURSE_ERROR),
        ("default_fixed", DEFAULT_BUDGET, DEFAULT_ERROR),
        ("default_fixed_compass", COMPASS_BUDGET, COMPASS_ERROR),
    ] {
        let count = counted(name);
        let reference = subject(name).reference.orientations().unwrap();
        let error = count.error(&reference);
        println!(
            "{name}: {} instructions at most, {error:e} degrees",
            count.most
        );
        assert!(count.most <= budget, "{name}: {}", count.most);
        assert!(error <= most, "{name}: {error:e} degrees");
    }
}

#[test]
fn two_runs_count_the_same() {
    assert_eq!(counted("course_f32"), counted("course_f32"));
}

/// What is counted is the filter: its orientations are those of the host.
#[test]
fn chip_and_host_come_to_the_same() {
    let fixed = counted("course_fixed");
    assert_eq!(fixed.updates, FEW as u64 - 1);
    assert_eq!(fixed.orientations.len(), FEW / 8);
    assert_eq!(
        fixed.error(&on_the_host::<CourseInFixedPoint<Portable>>()),
        0.0
    );
    let readable = counted("course_f32");
    assert_eq!(readable.error(&on_the_host::<Course<f32>>()), 0.0);
}

/// The motion is what it says it is: 100 to 300 °/s, 1 g, and nothing at the end of a range.
#[test]
fn a_head_turns_as_a_head_does() {
    let mut fastest = [0; 3];
    for (counts, z_up) in HEAD.iter().zip(&HEAD_Z_UP) {
        for (fastest, &rate) in fastest.iter_mut().zip(&counts.sample.gyro) {
            *fastest = rate.unsigned_abs().max(*fastest);
        }
        let force: f64 = counts
            .sample
            .accel
            .iter()
            .map(|&part| f64::from(part).powi(2))
            .sum();
        assert!((force.sqrt() / 16384.0 - 1.0).abs() < 0.02, "{counts:?}");
        let [x, y, z] = counts.sample.accel;
        assert_eq!(z_up.sample.accel, [x, -z, y]);
    }
    for rate in fastest {
        let dps = f64::from(rate) * 2000.0 / 32768.0;
        assert!((100.0..310.0).contains(&dps), "{dps}");
    }
    assert_eq!(HEAD_Z_UP[0].sample.accel[2], HEAD[0].sample.accel[1]);
}
