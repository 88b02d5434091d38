//! The estimators a host can choose between, and what it can set of each.

use super::SAMPLE_PERIOD;
use crate::calibration::GyroBias;
use crate::command::request::{Choice, Setting};
use crate::fixed::complementary::{self, Complementary};
use crate::fixed::fusion::{Field, Force, Fusion, Nanoseconds, Rates};
use crate::fixed::multiply::Multiply;
use crate::fusion::{Parameters, Source};
use crate::orientation::{DEFAULT_TIME_CONSTANT, TimeConstant};
use crate::sensor::Ranges;
use crate::units::{AngularRate, Seconds};

/// Of the sensor, nominally.
pub const SAMPLE_NANOSECONDS: Nanoseconds = Nanoseconds(1_000_000);

/// The magnetometer's own rate, 100 Hz.
const FIELD_NANOSECONDS: Nanoseconds = Nanoseconds(10_000_000);

/// Both estimators. Only the chosen one runs.
#[derive(Clone, Debug)]
pub struct Estimators<M> {
    choice: Choice,
    ranges: Ranges,
    parameters: Parameters<f32>,
    fusion: Fusion<M>,
    notes: Complementary<M>,
    notes_time: TimeConstant<f32>,
    /// What the notes' filter takes off, as their section 2 has it: measured once.
    notes_bias: GyroBias<f32>,
    /// The sensor's period as it was measured last.
    period: Nanoseconds,
}

impl<M: Multiply> Estimators<M> {
    /// For a sensor set to these ranges.
    pub fn new(ranges: Ranges) -> Self {
        let parameters = Parameters::default();
        let rates = Rates {
            sample: SAMPLE_NANOSECONDS,
            field: FIELD_NANOSECONDS,
            ranges,
        };
        Self {
            choice: Choice::default(),
            ranges,
            parameters,
            fusion: Fusion::with(&parameters, rates),
            notes: Complementary::with(&notes(ranges, DEFAULT_TIME_CONSTANT)),
            notes_time: DEFAULT_TIME_CONSTANT,
            notes_bias: GyroBias::zero(),
            period: SAMPLE_NANOSECONDS,
        }
    }

    /// One sample, with the gyro's bias still in it, and a field where there is a new one.
    #[inline(always)]
    pub fn update(&mut self, gyro: [i16; 3], force: Force, field: Option<Field>) {
        match self.choice {
            Choice::Default => self.fusion.update_corrected(gyro, &force, field),
            Choice::Notes => self.notes.update_corrected(gyro, force),
        }
    }

    /// So long is a sample by the board's crystal: the sensor's own clock is a per cent or so off.
    pub fn set_sample_period(&mut self, period: Nanoseconds) {
        if period != self.period {
            self.period = period;
            self.fusion.set_sample_period(period);
            self.notes.set_sample_period(period);
        }
    }

    /// As it was measured last.
    pub fn sample_period(&self) -> Nanoseconds {
        self.period
    }

    /// w, x, y, z, body to world, in units of 2⁻³⁰.
    pub fn orientation(&self) -> [i32; 4] {
        match self.choice {
            Choice::Default => self.fusion.bits(),
            Choice::Notes => self.notes.bits(),
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
        self.set_notes_bias(at_rest);
    }

    /// A bias from another day: better than none until one is measured.
    pub fn guess_bias(&mut self, rate: AngularRate<f32>) {
        self.fusion.guess_bias(rate);
        self.set_notes_bias(rate);
    }

    fn set_notes_bias(&mut self, rate: AngularRate<f32>) {
        self.notes_bias = GyroBias::new(rate);
        let bias = complementary::Bias::new(self.notes_bias, self.ranges.gyro);
        self.notes.set_bias(bias);
    }

    /// Heading 0 and the tilt this force (body frame) shows.
    pub fn reset(&mut self, force: Force) {
        match self.choice {
            Choice::Default => self.fusion.reset(force),
            Choice::Notes => self.notes.reset(force),
        }
    }

    /// The tilt this force (body frame) shows, heading kept.
    pub fn level(&mut self, force: Force) {
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
            Choice::Notes => self.notes.bits(),
        };
        self.choice = choice;
        // It is of unit length, so neither refuses.
        match choice {
            Choice::Default => {
                self.fusion.set(orientation);
            }
            Choice::Notes => {
                self.notes.set(orientation);
                self.set_notes_bias(self.fusion.bias().rate());
            }
        }
    }

    /// The default estimator, for its verdicts.
    pub fn fusion(&self) -> &Fusion<M> {
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
            Setting::NotesTime => self.notes_time = TimeConstant::new(Seconds(value)),
            Setting::NotesAlpha => {
                self.notes_time = TimeConstant::from_gyro_weight(value, SAMPLE_PERIOD);
            }
        }
        self.tune();
    }

    /// All settings as they were at the start, and the default estimator.
    pub fn set_defaults(&mut self) {
        self.parameters = Parameters::default();
        self.notes_time = DEFAULT_TIME_CONSTANT;
        self.tune();
        self.choose(Choice::Default);
    }

    fn tune(&mut self) {
        self.fusion.tune(&self.parameters);
        self.notes.tune(&notes(self.ranges, self.notes_time));
        let period = self.period;
        self.fusion.set_sample_period(period);
        self.notes.set_sample_period(period);
    }
}

fn notes(ranges: Ranges, time_constant: TimeConstant<f32>) -> complementary::Parameters {
    complementary::Parameters {
        gyro: ranges.gyro,
        sample_period: SAMPLE_NANOSECONDS,
        time_constant,
    }
}
