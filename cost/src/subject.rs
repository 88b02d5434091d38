//! The filters that are counted.

use crate::reference::Reference;
use std::path::PathBuf;
use vrduino_emulator::firmware::{self, BuildError, BuildOptions, Package};

/// How what is counted is compiled: as what is flashed, but for speed.
pub const PROFILE: &str = "cost";

/// One filter.
#[derive(Debug, Clone, Copy)]
pub struct Subject {
    /// Its module in the program that runs it.
    pub name: &'static str,
    /// What it is, in words.
    pub label: &'static str,
    /// What it is held against.
    pub reference: Reference,
}

/// A program, and the filters in it.
#[derive(Debug, Clone, Copy)]
pub struct Program {
    /// What builds it.
    pub package: Package,
    /// The name of its file.
    pub name: &'static str,
    /// In the order of the table.
    pub subjects: &'static [Subject],
}

impl Program {
    /// Builds it and says where it is.
    ///
    /// # Errors
    ///
    /// [`BuildError`], as for the firmware.
    pub fn build(&self) -> Result<PathBuf, BuildError> {
        let folder = firmware::build_package(self.package, BuildOptions { quiet: true })?;
        Ok(folder.join(self.name))
    }
}

/// Ours, and the course's filter as others write it.
#[rustfmt::skip] // one filter per line
pub const OURS: Program = Program {
    package: Package { manifest: "cost/images/Cargo.toml", feature: "image", profile: PROFILE },
    name: "filters",
    subjects: &[
        Subject { name: "course_fixed", label: "course filter, fixed, asm", reference: Reference::Course },
        Subject { name: "course_fixed_portable", label: "course filter, fixed, plain Rust", reference: Reference::Course },
        Subject { name: "default_fixed", label: "default estimator, fixed, 6 axes, asm", reference: Reference::Default6 },
        Subject { name: "default_fixed_portable", label: "default estimator, fixed, 6 axes, plain Rust", reference: Reference::Default6 },
        Subject { name: "default_fixed_compass", label: "default estimator, fixed, 9 axes, asm", reference: Reference::Default9 },
        Subject { name: "default_fixed_compass_portable", label: "default estimator, fixed, 9 axes, plain Rust", reference: Reference::Default9 },
        Subject { name: "course_f32", label: "course filter, readable, f32", reference: Reference::Course },
        Subject { name: "default_f32", label: "default estimator, readable, f32, 6 axes", reference: Reference::Default6 },
        Subject { name: "default_f32_compass", label: "default estimator, readable, f32, 9 axes", reference: Reference::Default9 },
        Subject { name: "textbook_f64", label: "course filter, textbook, f64", reference: Reference::Course },
        Subject { name: "textbook_f32", label: "course filter, textbook, f32", reference: Reference::Course },
        Subject { name: "straightforward", label: "course filter, nalgebra UnitQuaternion<f32>", reference: Reference::Course },
    ],
};

/// Everything is a ratio to this one.
pub const YARDSTICK: &str = "course_fixed";

/// The filters of the registry, in f32.
#[rustfmt::skip] // one filter per line
pub const PEERS: Program = Program {
    package: Package { manifest: "cost/peers/Cargo.toml", feature: "", profile: PROFILE },
    name: "peers",
    subjects: &[
        Subject { name: "madgwick_6", label: "ahrs 0.8.0 Madgwick, 6 axes", reference: Reference::Peer("madgwick-6") },
        Subject { name: "madgwick_9", label: "ahrs 0.8.0 Madgwick, 9 axes", reference: Reference::Peer("madgwick-9") },
        Subject { name: "mahony_6", label: "ahrs 0.8.0 Mahony, 6 axes", reference: Reference::Peer("mahony-6") },
        Subject { name: "mahony_9", label: "ahrs 0.8.0 Mahony, 9 axes", reference: Reference::Peer("mahony-9") },
        Subject { name: "xio_fusion_6", label: "fusion-ahrs 1.0.1, 6 axes", reference: Reference::None },
        Subject { name: "xio_fusion_9", label: "fusion-ahrs 1.0.1, 9 axes", reference: Reference::None },
        Subject { name: "vqf_6", label: "vqf-rs 0.3.0, 6 axes", reference: Reference::Peer("vqf-6") },
        Subject { name: "vqf_9", label: "vqf-rs 0.3.0, 9 axes", reference: Reference::None },
    ],
};
