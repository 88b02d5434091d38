//! The motion that an example is run on: the recording named on the command line, or a generated one.

#![allow(dead_code)] // Every example asks for its own part of this.

use std::error::Error;
use std::ops::Range;
use std::path::Path;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use vrduino::calibration::GyroBias;
use vrduino::units::AngularRate;
use vrduino_emulator::motion::{self, Instant, Motion};

/// What is looked at of a motion without end (s).
const OF_ENDLESS: f64 = 60.0;
/// The longest that is looked at (s): an hour. The examples keep every sample for their pictures.
const LONGEST: f64 = 3600.0;
/// At the beginning, for the gyro's bias (s).
const REST: f64 = 2.0;

type Outcome<T> = Result<T, Box<dyn Error>>;

/// A motion with what the examples say about it.
pub struct Chosen {
    motion: Box<dyn Motion>,
    /// For titles of pictures.
    pub name: String,
    /// How much of it is looked at (s).
    pub seconds: f64,
}

/// The recording named on the command line, or else this generated motion.
pub fn chosen(name: &str, generated: impl Motion + 'static) -> Outcome<Chosen> {
    named()?.map_or_else(|| Chosen::new(name.to_owned(), Box::new(generated)), Ok)
}

/// The recording named on the command line, if there is one.
pub fn named() -> Outcome<Option<Chosen>> {
    let Some(path) = std::env::args_os().nth(1) else {
        return Ok(None);
    };
    let path: &Path = path.as_ref();
    let name = path.file_stem().unwrap_or(path.as_os_str());
    let name = name.to_string_lossy().into_owned();
    Chosen::new(name, motion::open(path)?).map(Some)
}

impl Chosen {
    fn new(name: String, motion: Box<dyn Motion>) -> Outcome<Self> {
        let seconds = motion.duration().unwrap_or(OF_ENDLESS);
        let chosen = Self {
            motion,
            name,
            seconds,
        };
        if seconds > LONGEST {
            return Err(chosen.lacks(&format!(
                "lasts {seconds:.0} s; cut out a part of at most {LONGEST} s"
            )));
        }
        Ok(chosen)
    }

    /// It is of use only if it lasts so long.
    pub fn lasting(self, least: f64) -> Outcome<Self> {
        if self.seconds >= least {
            return Ok(self);
        }
        let lasts = self.seconds;
        Err(self.lacks(&format!(
            "lasts {lasts:.3} s; give one of at least {least} s"
        )))
    }

    /// It is of use only with a true orientation to compare with, at least in parts.
    pub fn with_truth(self) -> Outcome<Self> {
        let mut times = (0..=(self.seconds * 100.0) as u32).map(|k| f64::from(k) / 100.0);
        if times.any(|t| self.at(t).truth.is_some()) {
            return Ok(self);
        }
        Err(self.lacks(
            "has no true orientation to compare with; give one with truth (columns qw,qx,qy,qz)",
        ))
    }

    /// It is of use only with a magnetic field: one that was recorded, or the earth's where the true
    /// orientation is known.
    pub fn with_field(self) -> Outcome<Self> {
        let start = self.at(0.0);
        if start.field.is_some() || start.truth.is_some() {
            return Ok(self);
        }
        Err(self.lacks("has no magnetic field; give one with it (columns mx,my,mz)"))
    }

    fn lacks(&self, what: &str) -> Box<dyn Error> {
        format!("{} {what}", self.name).into()
    }

    /// What the sensor feels after so many seconds.
    pub fn at(&self, t: f64) -> Instant {
        self.motion.at(t)
    }

    /// What is drawn where all of it would be too much to see: twenty seconds in its middle.
    pub fn middle(&self) -> Range<f64> {
        let middle = self.seconds / 2.0;
        middle - 10.0..middle + 10.0
    }

    /// A line about it.
    pub fn describe(&self) -> String {
        self.motion.describe()
    }

    /// The gyro's bias: its mean over the first two seconds, in which motions rest, these generated
    /// ones and those of BROAD.
    pub fn bias(&self) -> GyroBias<f64> {
        let steps = (REST * 500.0) as u32;
        let rates = (0..steps).map(|k| Vector3::from(self.at(f64::from(k) / 500.0).rate));
        let mean = rates.sum::<Vector3<f64>>() / f64::from(steps);
        GyroBias::new(AngularRate::from_rad_per_s(mean))
    }
}

/// The true orientation, body to world, where it is known.
pub fn truth(instant: &Instant) -> Option<UnitQuaternion<f64>> {
    let [w, x, y, z] = instant.truth?;
    Some(UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)))
}
