//! What the sensor experiences: generated, scripted and recorded motions.

#[path = "motion/generated.rs"]
mod generated;
#[path = "motion/recording.rs"]
mod recording;
#[path = "motion/table.rs"]
mod table;

use std::path::Path;

use vrduino_emulator::motion::{self, Motion, MotionError};

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

fn close(a: [f64; 3], b: [f64; 3], tolerance: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
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
