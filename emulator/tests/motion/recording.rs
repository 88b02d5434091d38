//! `.imub` files.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

use vrduino_emulator::motion::rotation::{IDENTITY, about, angle_between, multiply, rotate};
use vrduino_emulator::motion::{self, Head, Motion, MotionError, Turns, imub};

use crate::{close, length};

/// A recording of the given body samples at 100 Hz: counts of rate and force, reference, flags.
fn recording(samples: &[([i16; 6], [i16; 4], u16)]) -> Vec<u8> {
    let mut bytes = b"IMUB\x01\0\x40\0".to_vec();
    bytes.extend((samples.len() as u32).to_le_bytes());
    bytes.extend(200_u32.to_le_bytes());
    bytes.extend(2_u32.to_le_bytes());
    for scale in [0.001_f32, 0.01, 0.1] {
        bytes.extend(scale.to_le_bytes());
    }
    bytes.extend([0; 32]);
    for (body, reference, flags) in samples {
        let values = body.iter().chain(&[0; 3]).chain(reference);
        bytes.extend(values.flat_map(|value| value.to_le_bytes()));
        bytes.extend(flags.to_le_bytes());
    }
    bytes
}

const LEVEL: [i16; 4] = [32767, 0, 0, 0];

#[test]
fn a_recording_is_resampled_and_then_lies_still() {
    let bytes = recording(&[
        ([0, 0, 0, 0, 0, 1000], LEVEL, 2),
        ([100, -200, 300, 100, 0, 900], [0, 0, 0, -32767], 2),
        ([1, 2, 3, 4, 5, 6], LEVEL, 0),
    ]);
    let motion = motion::parse(&bytes).unwrap();
    assert_eq!(motion.duration(), Some(0.02));
    let half = motion.at(0.005);
    assert!(close(half.rate, [0.05, -0.1, 0.15], 1e-7));
    assert!(close(half.force, [0.5, 0.0, 9.5], 1e-6));
    let quarter_turn = multiply(
        imub::y_up_from_enu(IDENTITY),
        about([0.0, 0.0, 1.0], FRAC_PI_2),
    );
    let other_way = multiply(
        imub::y_up_from_enu(IDENTITY),
        about([0.0, 0.0, 1.0], -FRAC_PI_2),
    );
    let truth = half.truth.unwrap();
    assert!(angle_between(truth, quarter_turn).min(angle_between(truth, other_way)) < 1e-4);
    assert_eq!(motion.at(0.015).truth, None);
    assert!(close(motion.at(0.02).rate, [0.001, 0.002, 0.003], 1e-9));
    assert_eq!(motion.at(0.021).rate, [0.0; 3]);
    assert!(close(motion.at(1e9).force, [0.04, 0.05, 0.06], 1e-7));
    assert!(motion.describe().contains("3 samples"));
}

#[test]
fn the_magnetic_field_is_the_recorded_one_and_else_the_earths() {
    let mut bytes = recording(&[([0; 6], LEVEL, 2)]);
    for (place, counts) in bytes[76..82].chunks_exact_mut(2).zip([300_i16, -200, 100]) {
        place.copy_from_slice(&counts.to_le_bytes());
    }
    let recorded = motion::parse(&bytes).unwrap().at(0.0);
    assert!(close(recorded.magnetic_field(), [30.0, -20.0, 10.0], 1e-5));

    // Level and looking north (−z): 61° below the horizon, ahead. Turned left by 90°: to the right.
    let north = Head::new().at(0.0).magnetic_field();
    assert!((length(north) - 48.0).abs() < 1e-9);
    assert!((north[1].atan2(-north[2]).to_degrees() + 61.0).abs() < 1e-9);
    let west = Turns::new(0.0, 0.0)
        .turn([0.0, 1.0, 0.0], 90.0, 1.0)
        .at(2.0);
    assert!(close(
        west.magnetic_field(),
        [-north[2], north[1], 0.0],
        1e-9
    ));
}

#[test]
fn the_reference_is_written_in_a_world_with_y_up() {
    // A body aligned with east, north and up: its x is east, its y north, its z up.
    let to_world = imub::y_up_from_enu(IDENTITY);
    assert!(close(
        rotate(to_world, [1.0, 0.0, 0.0]),
        [1.0, 0.0, 0.0],
        1e-12
    ));
    assert!(close(
        rotate(to_world, [0.0, 1.0, 0.0]),
        [0.0, 0.0, -1.0],
        1e-12
    ));
    assert!(close(
        rotate(to_world, [0.0, 0.0, 1.0]),
        [0.0, 1.0, 0.0],
        1e-12
    ));
    // A body that stands on its −y side is level in the new world.
    let standing = [FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0, 0.0];
    assert!(angle_between(imub::y_up_from_enu(standing), IDENTITY) < 1e-12);
}

#[test]
fn broken_recordings_are_refused() {
    let good = recording(&[([0; 6], LEVEL, 2)]);
    assert!(motion::parse(&good).is_ok());
    let patched = |offset: usize, patch: &[u8]| {
        let mut bytes = good.clone();
        bytes[offset..offset + patch.len()].copy_from_slice(patch);
        motion::parse(&bytes).map(|_| ()).unwrap_err()
    };
    assert!(matches!(
        patched(4, &[2]),
        MotionError::Version {
            version: 2,
            header: 64
        }
    ));
    assert!(matches!(
        patched(6, &[32]),
        MotionError::Version { header: 32, .. }
    ));
    assert!(matches!(
        patched(8, &[2]),
        MotionError::Length {
            expected: 120,
            found: 92
        }
    ));
    assert!(matches!(patched(8, &[0xFF; 4]), MotionError::Length { .. }));
    let field = |error| match error {
        MotionError::Header { field, .. } => field,
        other => panic!("{other}"),
    };
    assert_eq!(field(patched(12, &[0; 4])), "sampling rate");
    assert_eq!(field(patched(16, &[0; 4])), "sampling rate");
    assert_eq!(field(patched(12, &[0xFF; 4])), "sampling rate");
    for scale in [f32::NAN, f32::INFINITY, 0.0, -1.0, 1e30] {
        assert_eq!(field(patched(20, &scale.to_le_bytes())), "gyroscope scale");
        assert_eq!(
            field(patched(24, &scale.to_le_bytes())),
            "accelerometer scale"
        );
        assert_eq!(
            field(patched(28, &scale.to_le_bytes())),
            "magnetometer scale"
        );
    }
    assert!(matches!(
        patched(82, &[0; 8]),
        MotionError::Reference { record: 0 }
    ));
    assert!(matches!(
        motion::parse(&recording(&[])),
        Err(MotionError::Empty)
    ));
    for cut in 0..good.len() {
        assert!(motion::parse(&good[..cut]).is_err(), "cut to {cut}");
    }
}

/// Real recordings: gravity is up in the world where the sensor rests, so axes and signs agree.
#[test]
// Ignored without the recordings: they are a benchmark's data, which this repository does not carry.
#[ignore = "needs VRDUINO_MOTIONS, a folder of recorded motions, which are not kept here"]
fn recorded_motions_rest_upright_and_turn_as_their_reference() {
    let folder =
        std::env::var_os("VRDUINO_MOTIONS").expect("VRDUINO_MOTIONS names a folder of .imub files");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "imub") {
            continue;
        }
        let motion = motion::open(&path).unwrap();
        // Every recording is still for its first half minute.
        let rest: Vec<[f64; 3]> = (0..2500)
            .map(|i| motion.at(f64::from(i) * 0.01))
            .filter_map(|instant| instant.truth.map(|truth| rotate(truth, instant.force)))
            .collect();
        for axis in 0..3 {
            let mean = rest.iter().map(|force| force[axis]).sum::<f64>() / rest.len() as f64;
            let expected = [0.0, 9.81, 0.0][axis];
            assert!(
                rest.is_empty() || (mean - expected).abs() < 0.5,
                "{}: {mean}",
                motion.describe()
            );
        }
        // Two seconds of turning by rate and by reference agree to a degree or two.
        let mut turned = IDENTITY;
        let start = motion.at(60.0).truth;
        for i in 0..2000 {
            let rate = motion.at(60.0005 + f64::from(i) * 0.001).rate;
            let speed = length(rate).max(1e-12);
            turned = multiply(turned, about(rate.map(|c| c / speed), speed * 0.001));
        }
        if let (Some(start), Some(end)) = (start, motion.at(62.0).truth) {
            let error = angle_between(multiply(start, turned), end).to_degrees();
            eprintln!("{}: {error:.2}° {}", motion.describe(), rest.len());
            assert!(error < 5.0, "{}: {error}°", motion.describe());
            seen += 1;
        }
    }
    assert!(seen > 0, "no recording with a reference was found");
}
