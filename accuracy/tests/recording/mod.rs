//! Recordings made byte by byte, and trials without a file.

#![allow(dead_code)] // Every test file uses its own part of this.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use nalgebra::{UnitQuaternion, Vector3};
use vrduino::sensor::Sample;
use vrduino::units::{AngularRate, MagneticField, SpecificForce};
use vrduino_accuracy::trial::{NineAxes, Trial};

/// A board that lies level.
pub fn still(samples: usize) -> Vec<NineAxes> {
    let axes = NineAxes {
        sample: Sample {
            rate: AngularRate::zero(),
            force: SpecificForce::from_m_per_s2(Vector3::new(0.0, 9.81, 0.0)),
        },
        field: MagneticField::from_microtesla(Vector3::new(0.0, -40.0, -20.0)),
    };
    vec![axes; samples]
}

/// The same with its truth, scored in its second half.
pub fn trial(samples: usize) -> Trial {
    Trial {
        name: "still".into(),
        period: 0.01,
        samples: still(samples),
        reference: vec![Some(UnitQuaternion::identity()); samples],
        scored: (0..samples).map(|index| index >= samples / 2).collect(),
    }
}

/// An `.imub` file of a level board, each part of which a test can spoil.
#[derive(Clone)]
pub struct Bytes {
    /// Hz, numerator and denominator.
    pub rate: [u32; 2],
    pub scale: f32,
    pub scored: bool,
    pub seen: bool,
    pub reference: [i16; 4],
}

impl Default for Bytes {
    fn default() -> Self {
        Self {
            rate: [100, 1],
            scale: 0.001,
            scored: true,
            seen: true,
            // A level board in a world with z up: a quarter turn about x.
            reference: [23170, 23170, 0, 0],
        }
    }
}

impl Bytes {
    pub fn bytes(&self) -> Vec<u8> {
        let samples = 600_u32;
        let mut bytes = b"IMUB\x01\0\x40\0".to_vec();
        bytes.extend(samples.to_le_bytes());
        bytes.extend(self.rate.iter().flat_map(|part| part.to_le_bytes()));
        for scale in [self.scale, self.scale, 0.01] {
            bytes.extend(scale.to_le_bytes());
        }
        bytes.extend([0; 32]);
        for index in 0..samples {
            let body = [0, 0, 0, 0, 9810, 0, 0, -4000, -2000_i16];
            let flags = u16::from(self.scored && index >= 300) | u16::from(self.seen) << 1;
            let values = body.iter().chain(&self.reference);
            bytes.extend(values.flat_map(|value| value.to_le_bytes()));
            bytes.extend(flags.to_le_bytes());
        }
        bytes
    }
}

/// A folder of its own that goes away with this.
pub struct Folder(PathBuf);

impl Folder {
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

pub fn folder(files: &[(&str, &[u8])]) -> Folder {
    static NUMBER: AtomicU32 = AtomicU32::new(0);
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    let name = format!("accuracy-{}-{number}", std::process::id());
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&path).expect("a folder for the test");
    for (name, bytes) in files {
        std::fs::write(path.join(name), bytes).expect("a file for the test");
    }
    Folder(path)
}
