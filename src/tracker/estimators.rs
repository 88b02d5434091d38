//! The estimators a host can choose between, and what it can set of each.

use super::SAMPLE_PERIOD;
use crate::calibration::GyroBias;
use crate::command::request::{Choice, Setting};
use crate::fusion::{Fusion, Parameters, Rates, Source};
use crate::orientation::complementary::Complementary;
use crate::orientation::{DEFAULT_TIME_CONSTANT, TimeConstant};
use crate::sensor::Sample;
use crate::units::{AngularRate, MagneticField, Seconds, SpecificForce};
use nalgebra::UnitQuaternion;

/// The magnetometer's own rate, 100 Hz.
const FIELD_PERIOD: Seconds<f32> = Seconds(0.01);

/// Both estimators. Only the chosen one runs.
#[derive(Clone, Debug)]
pub struct Estimators {
    choice: Choice,
    parameters: Parameters<f32>,
    fusion: Fusion<f32>,
    notes: Complementary<f32>,
    notes_time: TimeConstant<f32>,
    /// What the notes' filter takes off, as their section 2 has it: measured once.
    notes_bias: GyroBias<f32>,
}

impl Default for Estimators {
    fn default() -> Self {
        let parameters = Parameters::default();
        let rates = Rates {
            sample: SAMPLE_PERIOD,
            field: FIELD_PERIOD,
        };
        Self {
            choice: Choice::default(),
            parameters,
            fusion: Fusion::new(&parameters, rates),
            notes: Complementary::new(DEFAULT_TIME_CONSTANT, SAMPLE_PERIOD),
            notes_time: DEFAULT_TIME_CONSTANT,
            notes_bias: GyroBias::zero(),
        }
    }
}

impl Estimators {
    /// One sample, with the bias still in it, and a field where there is a new one.
    pub fn update(&mut self, sample: &Sample<f32>, field: Option<MagneticField<f32>>) {
        match self.choice {
            Choice::Default => {
                self.fusion.update(sample, field);
            }
            Choice::Notes => {
                self.notes.update(&self.notes_bias.correct(*sample));
            }
        }
    }

    /// Body to world.
    pub fn orientation(&self) -> UnitQuaternion<f32> {
        match self.choice {
            Choice::Default => self.fusion.orientation(),
            Choice::Notes => self.notes.orientation(),
        }
    }

    /// What the chosen estimator takes off the gyro.
    pub fn bias(&self) -> GyroBias<f32> {
        match self.choice {
            Choice::Default => GyroBias::new(self.fusion.bias().rate()),
            Choice::Notes => self.notes_bias,
        }
    }

    /// Whether it was measured at rest, by whoever is chosen.
    pub fn bias_is_measured(&self) -> bool {
        self.fusion.bias().source() != Source::Unmeasured
    }

    /// A bias measured at rest is everybody's.
    pub fn set_bias(&mut self, at_rest: AngularRate<f32>) {
        self.fusion.set_bias(at_rest);
        self.notes_bias = GyroBias::new(at_rest);
    }

    /// A bias from another day: better than none until one is measured.
    pub fn guess_bias(&mut self, rate: AngularRate<f32>) {
        self.fusion.guess_bias(rate);
        self.notes_bias = GyroBias::new(rate);
    }

    /// Heading 0 and the tilt this force (body frame) shows.
    pub fn reset(&mut self, force: SpecificForce<f32>) {
        match self.choice {
            Choice::Default => self.fusion.reset(force),
            Choice::Notes => self.notes.reset(force),
        }
    }

    /// The tilt this force (body frame) shows, heading kept.
    pub fn level(&mut self, force: SpecificForce<f32>) {
        match self.choice {
            Choice::Default => self.fusion.level(force),
            Choice::Notes => self.notes.level(force),
        }
    }

    /// Which is chosen.
    pub fn choice(&self) -> Choice {
        self.choice
    }

    /// Goes on with another, from the orientation of the one before.
    pub fn choose(&mut self, choice: Choice) {
        let orientation = match self.choice {
            Choice::Default => self.fusion.estimate(),
            Choice::Notes => self.notes.orientation(),
        };
        self.choice = choice;
        match choice {
            Choice::Default => self.fusion.set(orientation),
            Choice::Notes => {
                self.notes.set(orientation);
                self.notes_bias = GyroBias::new(self.fusion.bias().rate());
            }
        }
    }

    /// The default estimator, for its verdicts.
    pub fn fusion(&self) -> &Fusion<f32> {
        &self.fusion
    }

    /// In the unit and range of the setting.
    pub fn get(&self, setting: Setting) -> f32 {
        match setting {
            Setting::TiltTime => self.parameters.tilt_time.0,
            Setting::Damping => self.parameters.damping,
            Setting::Lead => self.parameters.lead.0 * 1000.0,
            Setting::HeadingTime => self.parameters.heading_time.0,
            Setting::FieldTolerance => self.parameters.field_tolerance,
            Setting::NotesTime => self.notes_time.time().0,
            Setting::NotesAlpha => self.notes_time.gyro_weight(SAMPLE_PERIOD),
        }
    }

    /// The estimators go on from where they are.
    pub fn set(&mut self, setting: Setting, value: f32) {
        match setting {
            Setting::TiltTime => self.parameters.tilt_time = Seconds(value),
            Setting::Damping => self.parameters.damping = value,
            Setting::Lead => self.parameters.lead = Seconds(value / 1000.0),
            Setting::HeadingTime => self.parameters.heading_time = Seconds(value),
            Setting::FieldTolerance => self.parameters.field_tolerance = value,
            Setting::NotesTime => self.set_notes(TimeConstant::new(Seconds(value))),
            Setting::NotesAlpha => {
                self.set_notes(TimeConstant::from_gyro_weight(value, SAMPLE_PERIOD));
            }
        }
        self.fusion.tune(&self.parameters);
    }

    /// All settings as they were at the start, and the default estimator.
    pub fn set_defaults(&mut self) {
        self.parameters = Parameters::default();
        self.fusion.tune(&self.parameters);
        self.set_notes(DEFAULT_TIME_CONSTANT);
        self.choose(Choice::Default);
    }

    fn set_notes(&mut self, time: TimeConstant<f32>) {
        let orientation = self.notes.orientation();
        self.notes_time = time;
        self.notes = Complementary::new(time, SAMPLE_PERIOD);
        self.notes.set(orientation);
    }
}
