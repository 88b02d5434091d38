//! What the sensor experiences: generated, scripted and recorded motions.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};
use std::path::Path;

use vrduino_emulator::motion::rotation::{
    IDENTITY, about, angle_between, gravity_in_body, multiply, rotate,
};
use vrduino_emulator::motion::{
    self, Head, Imperfect, Imperfections, Motion, MotionError, Turns, imub,
};

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

fn close(a: [f64; 3], b: [f64; 3], tolerance: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
}

/// Follows a motion by its angular rate alone and returns the largest angle to its truth (°).
fn drift(motion: &dyn Motion, seconds: f64) -> f64 {
    const STEP: f64 = 0.001;
    let mut attitude = motion.at(0.0).truth.unwrap();
    let mut worst: f64 = 0.0;
    for step in 0..(seconds / STEP).round() as u32 {
        let t = f64::from(step) * STEP;
        let rate = motion.at(t + STEP / 2.0).rate;
        let speed = length(rate);
        if speed > 0.0 {
            let turn = about(rate.map(|c| c / speed), speed * STEP);
            attitude = multiply(attitude, turn);
        }
        let truth = motion.at(t + STEP).truth.unwrap();
        worst = worst.max(angle_between(attitude, truth).to_degrees());
    }
    worst
}

#[test]
fn the_head_motion_turns_as_its_rate_says() {
    assert!(drift(&Head::new(), 20.0) < 0.01);
}

#[test]
fn the_head_motion_begins_level_and_still() {
    for t in [0.0, 1.7, 3.0] {
        let instant = Head::new().at(t);
        assert_eq!(instant.rate, [0.0; 3]);
        assert!(close(instant.force, [0.0, 9.81, 0.0], 1e-12));
        assert_eq!(instant.truth.unwrap()[0], 1.0);
    }
}

#[test]
fn the_head_motion_feels_gravity_and_stays_in_its_range() {
    let head = Head::new();
    let (mut fastest, mut furthest): (f64, f64) = (0.0, 0.0);
    for step in 0..60_000 {
        let instant = head.at(f64::from(step) * 0.002);
        let truth = instant.truth.unwrap();
        assert!(close(instant.force, gravity_in_body(truth), 1e-9));
        fastest = fastest.max(length(instant.rate).to_degrees());
        // Where the sensor's −z axis, the direction of view, points to the side.
        let view = rotate(truth, [0.0, 0.0, -1.0]);
        furthest = furthest.max(view[0].atan2(-view[2]).abs().to_degrees());
    }
    assert!((150.0..=250.0).contains(&fastest), "{fastest} °/s");
    assert!((45.0..=60.0).contains(&furthest), "{furthest}°");
}

#[test]
fn a_lever_arm_adds_the_acceleration_of_the_carried_sensor() {
    let head = Head {
        lever_arm: Head::ON_THE_NECK,
    };
    let step = 1e-3;
    let place = |t: f64| rotate(head.at(t).truth.unwrap(), Head::ON_THE_NECK);
    let (before, now, after) = (place(9.0 - step), place(9.0), place(9.0 + step));
    let expected: [f64; 3] = std::array::from_fn(|i| {
        let gravity = if i == 1 { 9.81 } else { 0.0 };
        (before[i] - 2.0 * now[i] + after[i]) / (step * step) + gravity
    });
    let instant = head.at(9.0);
    let felt = rotate(instant.truth.unwrap(), instant.force);
    assert!(close(felt, expected, 1e-4), "{felt:?} {expected:?}");
    assert!(!close(felt, [0.0, 9.81, 0.0], 0.05));
}

#[test]
fn imperfections_are_the_same_however_the_motion_is_sampled() {
    let imperfect = || Imperfect::new(Box::new(Head::new()), Imperfections::default());
    let forward = imperfect();
    let seen: Vec<_> = (0..100).map(|i| forward.at(f64::from(i) * 0.01)).collect();
    let backward = imperfect();
    for i in (0..100).rev() {
        assert_eq!(backward.at(f64::from(i) * 0.01), seen[i as usize]);
    }
}

#[test]
fn imperfections_have_the_size_they_say() {
    let imperfections = Imperfections {
        seed: 7,
        ..Imperfections::default()
    };
    let motion = Imperfect::new(Box::new(Turns::new(60.0, 0.0)), imperfections);
    let samples: Vec<_> = (0..50_000)
        .map(|i| motion.at(f64::from(i) * 0.001))
        .collect();
    let statistics = |values: Vec<f64>| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let square = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
        (mean, (square / values.len() as f64).sqrt())
    };
    for (axis, bias) in imperfections.gyro_bias_dps.into_iter().enumerate() {
        let (mean, rms) = statistics(samples.iter().map(|s| s.rate[axis].to_degrees()).collect());
        assert!((mean - bias).abs() < 0.003, "{mean}");
        assert!((rms - 0.1).abs() < 0.002, "{rms}");
        let (mean, rms) = statistics(samples.iter().map(|s| s.force[axis]).collect());
        assert!((mean - [0.0, 9.81, 0.0][axis]).abs() < 0.001, "{mean}");
        assert!((rms - 0.03).abs() < 0.001, "{rms}");
    }
    assert_eq!(samples[0].truth, Some(IDENTITY));
}

#[test]
fn scripted_turns_end_where_they_should() {
    let turns =
        Turns::new(2.0, 0.5)
            .turn([0.0, 3.0, 0.0], 90.0, 1.0)
            .turn([1.0, 0.0, 0.0], -30.0, 0.5);
    assert_eq!(turns.duration(), Some(4.5));
    assert_eq!(turns.at(1.9).rate, [0.0; 3]);
    assert_eq!(turns.at(3.2).rate, [0.0; 3]);
    assert!((turns.at(2.5).rate[1].to_degrees() - 180.0).abs() < 1e-9);
    let expected = multiply(
        about([0.0, 1.0, 0.0], FRAC_PI_2),
        about([1.0, 0.0, 0.0], (-30.0_f64).to_radians()),
    );
    let end = turns.at(99.0);
    assert!(angle_between(end.truth.unwrap(), expected) < 1e-9);
    assert!(close(end.force, gravity_in_body(expected), 1e-9));
    assert!(drift(&turns, 5.0) < 0.001);
}

#[test]
fn a_motion_can_begin_later() {
    let script = || Box::new(Turns::new(0.0, 0.0).turn([0.0, 0.0, 1.0], 45.0, 2.0));
    let later = motion::skip(script(), 0.5).unwrap();
    assert_eq!(later.at(0.25), script().at(0.75));
    assert_eq!(later.duration(), Some(1.5));
    for start in [2.0, 1e300, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            motion::skip(script(), start),
            Err(MotionError::Start { .. })
        ));
    }
    assert!(motion::skip(Box::new(Head::new()), 1e6).is_ok());
}

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

fn text_error(text: &str) -> String {
    motion::parse(text.as_bytes())
        .map(|_| ())
        .unwrap_err()
        .to_string()
}

#[test]
fn a_table_is_read_by_its_column_names() {
    let text = "\u{feff}# a nod\r\n\r\naz, AY,ax,gz,gy,gx_dps,t_ms,note,qw,qx,qy,qz\r\n\
                1,9,3,4,5,180,1000,start,1,0,0,0\r\n3,9,3,4,5,360,1500,end,1,0,0,0 # done\r\n";
    let motion = motion::parse(text.as_bytes()).unwrap();
    assert_eq!(motion.duration(), Some(0.5));
    let instant = motion.at(0.25);
    assert!(close(
        instant.rate,
        [1.5 * std::f64::consts::PI, 5.0, 4.0],
        1e-12
    ));
    assert!(close(instant.force, [3.0, 9.0, 2.0], 1e-12));
    assert_eq!(instant.truth, Some(IDENTITY));
}

#[test]
fn a_table_may_hold_the_magnetic_field() {
    let motion =
        motion::parse(b"t,gx,gy,gz,ax,ay,az,mx,my_ut,mz\n0,0,0,0,0,9.8,0,20,-40,5\n").unwrap();
    assert_eq!(motion.at(0.0).magnetic_field(), [20.0, -40.0, 5.0]);
    let message = text_error("t,gx,gy,gz,ax,ay,az,mx,mz\n0,0,0,0,0,0,0,0,0\n");
    assert!(
        message.contains("the magnetic field lacks the column my"),
        "{message}"
    );
}

#[test]
fn a_table_without_truth_has_none() {
    let motion = motion::parse(b"t,gx,gy,gz,ax_g,ay_g,az_g\n0,0,0,0,0,1,0\n").unwrap();
    assert_eq!(motion.at(0.0).truth, None);
    assert!(close(motion.at(5.0).force, [0.0, 9.80665, 0.0], 1e-12));
}

#[test]
fn a_wrong_table_is_refused_with_its_place() {
    const NAMES: &str = "t,gx,gy,gz,ax,ay,az\n";
    let with = |rows: &str| text_error(&format!("{NAMES}{rows}"));
    assert!(
        with("0,0,0,0,0,9.81,0\n1,0, x,0,0,9.81,0\n").starts_with("line 3, column 6: \"x\" for gy")
    );
    assert!(with("0,0,0,0,0,9.81\n").starts_with("line 2, column 1: 6 values"));
    assert!(with("0,0,0,0,0,NaN,0\n").starts_with("line 2, column 11: \"NaN\""));
    assert!(with("0,0,0,0,0,1e400,0\n").contains("1e400"));
    assert!(with("0,0,0,0,0,9,0\n0,0,0,0,0,9,0\n").starts_with("line 3, column 1: the time 0 s"));
    assert!(with("").contains("no motion"));
    assert!(text_error("t,gx,gy,gz,ax,ay\n").contains("no column az"));
    assert!(text_error("t,t,gx,gy,gz,ax,ay,az\n").contains("two columns hold t"));
    assert!(text_error("t,gx,gy,gz,ax,ay,az,qw,qx\n").contains("lacks the column qy, qz"));
    assert!(
        text_error("t,gx,gy,gz,ax,ay,az,qw,qx,qy,qz\n0,0,0,0,0,9,0,0,0,0,0\n")
            .contains("unit quaternion")
    );
    assert!(text_error("hello world\n").contains("no column t"));
    assert!(text_error("# nothing\n\n").contains("no motion"));
}

#[test]
fn the_courses_rows_are_read_in_every_dress() {
    let dresses = [
        "180 0 0 0.37 9.0 2.3\n0 0 90 0.37, 9.0, 2.3\n",
        "180,0,0,0.37,9.0,2.3,\n\n0,0,90,0.37,9.0,2.3,\n",
        "#pragma once\n// made { by hand }\nconst double imuData[2*6] = {\n180, 0, 0, 0.37f, 9.0,\n 2.3, \
         0, 0, 90, 0.37, /* a\n b */ 9.0, 2.3,\n};\n",
        "double imuData[][6] = {\n{180,0,0,0.37,9.0,2.3},\n{0,0,90,0.37,9.0,2.3}};",
        "{1.8e2,0,0,0.37,9.0,2.3},\n{0,0,90,0.37,9.0,2.3},\n",
    ];
    for text in dresses {
        let motion =
            motion::parse(text.as_bytes()).unwrap_or_else(|error| panic!("{error}: {text}"));
        assert_eq!(motion.duration(), Some(0.002), "{text}");
        assert!(close(
            motion.at(0.0).rate,
            [std::f64::consts::PI, 0.0, 0.0],
            1e-12
        ));
        assert!(close(motion.at(0.002).rate, [0.0, 0.0, FRAC_PI_2], 1e-12));
        assert!(close(motion.at(0.001).force, [0.37, 9.0, 2.3], 1e-7));
    }
}

#[test]
fn wrong_rows_are_refused_with_their_place() {
    assert!(text_error("1 2 3 4 5 6\n1 2 3 4 5\n").starts_with("line 2, column 1: 5 numbers"));
    assert!(text_error("0,1,2,3,4,5,6\n").starts_with("line 1, column 1: 7 numbers"));
    assert!(
        text_error("1 2 3 4 5 6\n1 2 three 4 5 6\n").starts_with("line 2, column 5: \"three\"")
    );
    assert!(text_error("double a[] = {1,2,3,4,5,6,7};").contains("7 numbers"));
    assert!(text_error("double a[] = {1,2,3,4,5,6").contains("ends inside the array"));
    assert!(text_error("double a[] = {};").contains("no motion"));
    assert!(
        text_error("double a[] = {{1,2,3},{4,5,6}};").starts_with("line 1, column 21: a row of 3")
    );
    assert!(text_error("double a[] = {1,2,3,4,5,6}; int b;").contains("after the end"));
    assert!(text_error("{}}").contains("after the end"));
    assert!(text_error("1 2 3 4 5 inf").contains("inf"));
}

#[test]
fn anything_else_is_refused_without_a_panic() {
    assert!(matches!(motion::parse(b""), Err(MotionError::Empty)));
    assert!(matches!(
        motion::parse(b"ab\xFFcd"),
        Err(MotionError::NotAMotion { offset: 2 })
    ));
    assert!(matches!(
        motion::parse(b"1 2 3\0"),
        Err(MotionError::NotAMotion { offset: 5 })
    ));
    let mut state = 1_u32;
    for round in 0..2000_usize {
        let alphabet: &[u8] = b"IMUB{};,.-+e0123456789 \n#/*\"xtgaf_\xC3\xA4";
        let noise: Vec<u8> = (0..round % 97)
            .map(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                alphabet[(state >> 16) as usize % alphabet.len()]
            })
            .collect();
        if let Ok(motion) = motion::parse(&noise) {
            let instant = motion.at(0.001);
            assert!(
                instant
                    .rate
                    .iter()
                    .chain(&instant.force)
                    .all(|value| value.is_finite())
            );
        }
    }
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    for path in [
        Path::new("no/such/motion.imub"),
        Path::new(env!("CARGO_MANIFEST_DIR")),
    ] {
        let error = motion::open(path).map(|_| ()).unwrap_err().to_string();
        assert!(error.starts_with(&path.display().to_string()), "{error}");
        assert!(error.contains("cannot read"), "{error}");
    }
}

/// Real recordings: gravity is up in the world where the sensor rests, so axes and signs agree.
#[test]
#[ignore = "needs VRDUINO_MOTIONS"]
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
