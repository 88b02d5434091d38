//! One recording: nine axes and the orientation an optical system saw.

use std::fmt;
use std::path::{Path, PathBuf};

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use vrduino::sensor::Sample;
use vrduino::units::{AngularRate, MagneticField, SpecificForce};
use vrduino_emulator::motion::MotionError;
use vrduino_emulator::motion::imub::{self, File};

/// What the three sensors read at one moment, body frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NineAxes {
    /// Gyro and accelerometer.
    pub sample: Sample<f64>,
    /// Magnetometer.
    pub field: MagneticField<f64>,
}

/// A motion, sample by sample.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The file's name without its ending.
    pub name: String,
    /// Between two samples, s.
    pub period: f64,
    /// What the sensors read.
    pub samples: Vec<NineAxes>,
    /// Body → world (y up, −z north) after each sample, where the optical system saw the sensor.
    pub reference: Vec<Option<UnitQuaternion<f64>>>,
    /// Whether the sensor moves: only then is it scored.
    pub scored: Vec<bool>,
}

/// Why there is nothing to judge.
#[derive(Debug)]
pub enum TrialError {
    /// The folder or a file in it cannot be read.
    Unreadable(PathBuf, std::io::Error),
    /// A file is no recording.
    NoRecording(PathBuf, MotionError),
    /// A recording has no scored sample with a reference.
    NothingToScore(PathBuf),
    /// The folder holds no `.imub` file.
    Empty(PathBuf),
}

impl fmt::Display for TrialError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(path, error) => {
                write!(f, "{}: cannot read it: {error}", path.display())
            }
            Self::NoRecording(path, error) => write!(f, "{}: {error}", path.display()),
            Self::NothingToScore(path) => write!(
                f,
                "{}: no sample is both marked as moving and has a reference, so there is nothing to score",
                path.display()
            ),
            Self::Empty(path) => write!(
                f,
                "{}: no .imub recording in this folder; emulator/README.md says what such a file holds",
                path.display()
            ),
        }
    }
}

impl std::error::Error for TrialError {}

impl Trial {
    /// Reads one recording.
    ///
    /// # Errors
    ///
    /// [`TrialError`] if it cannot be read, is no recording, or has nothing to score.
    pub fn open(path: &Path) -> Result<Self, TrialError> {
        let bytes =
            std::fs::read(path).map_err(|error| TrialError::Unreadable(path.into(), error))?;
        let file =
            imub::read(&bytes).map_err(|error| TrialError::NoRecording(path.into(), error))?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let trial = Self::of(name.into_owned(), &file);
        if trial.scored_references().next().is_none() {
            return Err(TrialError::NothingToScore(path.into()));
        }
        Ok(trial)
    }

    fn of(name: String, file: &File) -> Self {
        let [rate, force, field] = file.scales;
        let physical = |counts: [i16; 3], scale| Vector3::from(counts.map(f64::from)) * scale;
        let samples = file.records.iter().map(|record| NineAxes {
            sample: Sample {
                rate: AngularRate::from_rad_per_s(physical(record.counts[0], rate)),
                force: SpecificForce::from_m_per_s2(physical(record.counts[1], force)),
            },
            field: MagneticField::from_microtesla(physical(record.counts[2], field)),
        });
        let reference = file.records.iter().map(|record| {
            record
                .truth
                .map(|[w, x, y, z]| UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)))
        });
        Self {
            name,
            period: 1.0 / file.rate,
            samples: samples.collect(),
            reference: reference.collect(),
            scored: file.records.iter().map(|record| record.scored).collect(),
        }
    }

    /// All recordings of a folder, by name.
    ///
    /// # Errors
    ///
    /// [`TrialError`] of the first that cannot be judged, or if there is none.
    pub fn open_all(folder: &Path) -> Result<Vec<Self>, TrialError> {
        let unreadable = |error| TrialError::Unreadable(folder.into(), error);
        let mut paths = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(unreadable)? {
            let path = entry.map_err(unreadable)?.path();
            if path.extension().is_some_and(|ending| ending == "imub") {
                paths.push(path);
            }
        }
        if paths.is_empty() {
            return Err(TrialError::Empty(folder.into()));
        }
        paths.sort();
        paths.iter().map(|path| Self::open(path)).collect()
    }

    /// Index and reference of every sample that is scored.
    pub fn scored_references(&self) -> impl Iterator<Item = (usize, UnitQuaternion<f64>)> {
        let references = self.reference.iter().zip(&self.scored).enumerate();
        references.filter_map(|(index, (reference, scored))| {
            reference.filter(|_| *scored).map(|truth| (index, truth))
        })
    }

    /// The first sample in motion.
    pub fn first_motion(&self) -> Option<usize> {
        self.scored.iter().position(|scored| *scored)
    }

    /// The benchmark's groups this trial belongs to, by the words in its name.
    pub fn groups(&self) -> impl Iterator<Item = &'static str> {
        let disturbed = if self.name.contains("_undisturbed_") {
            "undisturbed"
        } else {
            "disturbed"
        };
        let kinds = GROUPS[3..]
            .iter()
            .copied()
            .filter(|kind| self.name.contains(&format!("_{kind}")));
        ["all", disturbed].into_iter().chain(kinds)
    }
}

/// The benchmark's groups.
pub const GROUPS: [&str; 12] = [
    "all",
    "undisturbed",
    "disturbed",
    "rotation",
    "translation",
    "combined",
    "slow",
    "fast",
    "tapping",
    "phone_vibration",
    "stationary_magnet",
    "attached_magnet",
];
