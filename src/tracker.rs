//! [`Tracker::update`] is called once per [`SAMPLE_PERIOD`] with what the sensor sent, and does
//! everything that follows: corrections, bias, filter ([`fixed`](crate::fixed)), and every tenth time a
//! line. The firmware and the tests run this same code.
//!
//! The sensor is the time base, and its clock a per cent or so off: [`Tracker::timed`] says by how much. A sample that
//! could not be read is bridged by the one before (the rate is held for the sample that is not there) and counted.
//!
//! [`Tracker::update`]: crate::tracker::Tracker::update
//! [`Tracker::timed`]: crate::tracker::Tracker::timed
//! [`SAMPLE_PERIOD`]: crate::tracker::SAMPLE_PERIOD

mod answers;
mod bias;
mod calibration;
mod compass;
mod estimators;
mod show;
mod stream;
mod views;

use crate::calibration::record::Record;
use crate::calibration::{Reading, Rest};
use crate::command::request::{CoreClock, UseCompass};
use crate::command::{Command, Mode};
use crate::fixed::fusion::{Field, Force, Nanoseconds};
use crate::fixed::multiply::{Multiply, Portable};
use crate::sampling::{Lock, Timing};
use crate::sensor::magnetometer::{RawField, SensitivityAdjustment};
use crate::sensor::{Ranges, RawSample, Sample};
use crate::units::Seconds;
use crate::wire::frame::{Counts, Frame};
use crate::wire::{self, Line};
use bias::Measurement;
use calibration::Calibration;
use compass::Compass;
use estimators::Estimators;
use nalgebra::{Quaternion, UnitQuaternion};
use stream::Stream;
use views::Views;

/// The sensor's own rate with its filter in use, 1 kHz.
pub const SAMPLE_PERIOD: Seconds<f32> = Seconds(0.001);

/// The same in µs.
const SAMPLE_MICROS: u32 = 1000;

/// Samples per line, if nobody asks for more or less: 100 lines a second. The course's Unity script reads
/// 64 bytes per frame and falls behind by a second above about 128 lines a second.
pub const LINE_EVERY: u16 = 10;

/// Samples between two looks at the sensor's measured period.
const PERIOD_EVERY: u32 = 64;

/// Samples per INFO block: one second.
const INFO_EVERY: u32 = 1000;

/// Samples within the range after which one at its end is worth another warning: a second.
const CLIPPED_AGAIN: u32 = 1000;

/// Samples to wait for a still window: 5 s. Someone who is already wearing the board should see a
/// picture, even a drifting one.
pub const STILL_DEADLINE: u32 = 5000;

/// What the board knows and the tracker does not. For the INFO block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Health {
    /// Lines thrown away because the host did not read.
    pub dropped_lines: u32,
    /// Samples that were never read, the bus being in error or in use, or that found no room on their way.
    pub overruns: u32,
    /// Times that measurements of the magnetometer were overwritten before they were read.
    pub skipped_fields: u32,
}

/// Everything between the sensor's counts and the lines to the host.
#[derive(Clone, Debug)]
pub struct Tracker<M = Portable> {
    ranges: Ranges,
    mode: Mode,
    stream: Stream,
    /// The window the bias came from; none if it was never still.
    rest: Option<Rest>,
    measurement: Option<Measurement>,
    /// Whether the orientation runs without a bias measured at rest.
    bias_unknown: bool,
    estimators: Estimators<M>,
    views: Views<M>,
    compass: Compass,
    use_compass: UseCompass,
    calibration: Calibration<M>,
    phase: Phase,
    ticks: u32,
    counts: Tally,
    timing: Option<Timing>,
    lock: Lock,
    core: CoreClock,
}

/// Whether there is an orientation, and what the next sample is to do to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// The first measurement of the bias is still running: no orientation yet.
    Starting,
    Running,
    /// Back to yaw 0 with the next sample.
    Resetting,
    /// The sensor was away: back to level with the next sample, yaw kept.
    Releveling,
}

#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    fresh_this_second: u32,
    fresh_last_second: u32,
    repeated: u32,
    /// Samples at an end of the sensor's range.
    clipped: u32,
    /// Samples since the last of them.
    unclipped: u32,
}

impl Tracker<Portable> {
    /// For a sensor set to these ranges, in plain Rust. See [`with`](Self::with).
    pub fn new(ranges: Ranges) -> Self {
        Self::with(ranges)
    }
}

impl<M: Multiply> Tracker<M> {
    /// For a sensor set to these ranges. Begins by measuring the bias. Products are taken by `M`.
    pub fn with(ranges: Ranges) -> Self {
        Self {
            ranges,
            mode: Mode::default(),
            stream: Stream::default(),
            rest: None,
            measurement: Some(Measurement::new(ranges)),
            bias_unknown: false,
            estimators: Estimators::new(ranges),
            views: Views::new(ranges),
            compass: Compass::none(),
            use_compass: UseCompass::default(),
            calibration: Calibration::new(ranges),
            phase: Phase::Starting,
            ticks: 0,
            counts: Tally::default(),
            timing: None,
            lock: Lock::default(),
            core: CoreClock::default(),
        }
    }

    /// To be called before [`Tracker::update`] by those who know it: when the sample was ready, and how far apart
    /// samples are. Without, they are [`SAMPLE_PERIOD`] apart.
    pub fn timed(&mut self, timing: &Timing) {
        self.timing = Some(*timing);
    }

    /// Takes a key, which has its effect with the next sample, or a line, which is answered at once.
    pub fn command(&mut self, command: Command, emit: &mut impl FnMut(&Line)) {
        match command {
            Command::Line(line) => emit(&self.answer(line)),
            Command::Mode(mode) => {
                self.mode = mode;
                // The views that are not shown do not run, so they begin where the tracker is now.
                self.restart_views();
            }
            // Before the start there is nothing to reset, and the bias is being measured already.
            Command::Reset if self.phase != Phase::Starting => self.phase = Phase::Resetting,
            Command::MeasureBias if self.phase != Phase::Starting => {
                self.measurement = Some(Measurement::new(self.ranges));
            }
            Command::Reset | Command::MeasureBias => {}
        }
    }

    /// To be called when the sensor is back after it was lost: the next sample levels the
    /// orientation at once and keeps its yaw, which nobody knows better. A window of stillness
    /// that was under way begins again, for it has a hole.
    pub fn resume(&mut self) {
        if self.phase == Phase::Running {
            self.phase = Phase::Releveling;
        }
        if let Some(measurement) = &mut self.measurement {
            measurement.stillness.restart();
        }
    }

    /// To be called when the sensor has been set up: how sensitive its magnetometer is, if it has one.
    /// Without, every field is passed over.
    pub fn set_magnetometer(&mut self, adjustment: Option<SensitivityAdjustment>) {
        self.compass = Compass::of(adjustment);
        self.calibration.set_magnetometer(adjustment);
    }

    /// What was found by calibrations before, and kept.
    pub fn set_calibration(&mut self, record: &Record) {
        self.calibration.set(record);
        self.guess_bias(record);
    }

    /// Until one is measured here, a bias from another day is better than none.
    fn guess_bias(&mut self, record: &Record) {
        if let Some(gyro) = record.gyro
            && !self.estimators.bias_is_measured()
        {
            self.estimators.guess_bias(gyro.bias);
        }
    }

    /// What the host wants the sensor to be read by.
    pub fn lock(&self) -> Lock {
        self.lock
    }

    /// How fast the host wants the processor to run.
    pub fn core(&self) -> CoreClock {
        self.core
    }

    /// What is to be kept, once after each change of it.
    pub fn take_calibration_to_keep(&mut self) -> Option<Record> {
        self.calibration.take_to_keep()
    }

    /// A board of which the iron is not known has no compass worth following.
    fn follows_compass(&self) -> bool {
        match self.use_compass {
            UseCompass::Auto => self.calibration.knows_field(),
            UseCompass::On => true,
            UseCompass::Off => false,
        }
    }

    /// The fused orientation, body to world; the identity until there is one.
    pub fn orientation(&self) -> UnitQuaternion<f32> {
        unit(self.estimators.orientation())
    }

    /// One sample, with what the magnetometer has measured since the one before, if it has. `emit` is
    /// given the lines they lead to: mostly none, every tenth time one to three, and once a second
    /// up to eleven. Returns the binary frame of this sample, where one is asked for and due.
    ///
    /// What does not happen with every sample is in functions of its own, so that a board can keep the
    /// rest where it is quick.
    #[inline(always)]
    pub fn update(
        &mut self,
        raw: &RawSample,
        field: Option<RawField>,
        health: &Health,
        emit: &mut impl FnMut(&Line),
    ) -> Option<Frame> {
        self.count(raw);
        self.counts.unclipped = self.counts.unclipped.saturating_add(1);
        if raw.clipped() {
            self.tell_of_clipping(raw, emit);
        }
        let taken = field.and_then(|field| self.take_field(field, emit));
        self.track(raw, taken);
        if self.measurement.is_some() {
            self.measure(raw, emit);
        }
        if self.phase == Phase::Starting {
            return None;
        }
        if self.bias_unknown || !self.estimators.bias_is_measured() {
            self.tell_of_bias(emit);
        }
        if !self.every(self.shown_every()) {
            return None;
        }
        let counts = Counts {
            sample: *raw,
            field,
        };
        self.show(&counts, health, emit)
    }

    #[inline(always)]
    fn count(&mut self, raw: &RawSample) {
        self.ticks = self.ticks.wrapping_add(1);
        if raw.fresh {
            self.counts.fresh_this_second += 1;
        } else {
            self.counts.repeated = self.counts.repeated.saturating_add(1);
        }
        if self.every(PERIOD_EVERY) {
            self.follow_period();
        }
        if self.every(INFO_EVERY) {
            self.counts.fresh_last_second = self.counts.fresh_this_second;
            self.counts.fresh_this_second = 0;
            self.compass.end_second();
        }
    }

    #[inline(never)]
    fn follow_period(&mut self) {
        if let Some(timing) = self.timing {
            let period = Nanoseconds(timing.period_ns);
            self.estimators.set_sample_period(period);
        }
    }

    /// The field corrected, if it is to be followed.
    #[inline(never)]
    fn take_field(&mut self, raw: RawField, emit: &mut impl FnMut(&Line)) -> Option<Field> {
        if let Some(error) = self.compass.update(raw) {
            emit(&wire::text(format_args!("warning: {error}")));
        }
        if !self.follows_compass() {
            return None;
        }
        raw.check().ok()?;
        self.calibration.field(&raw)
    }

    /// A sensor at the end of its range hides how far beyond it the truth is. It is told of when it
    /// begins; the estimators make good what they can once it is over.
    #[cold]
    #[inline(never)]
    fn tell_of_clipping(&mut self, raw: &RawSample, emit: &mut impl FnMut(&Line)) {
        let counts = &mut self.counts;
        if raw.fresh && (counts.clipped == 0 || counts.unclipped > CLIPPED_AGAIN) {
            emit(&wire::text(
                "warning: the sensor is at the end of its range: turned or knocked too hard",
            ));
        }
        counts.clipped = counts.clipped.saturating_add(u32::from(raw.fresh));
        counts.unclipped = 0;
    }

    #[inline(always)]
    fn every(&self, samples: u32) -> bool {
        self.ticks.is_multiple_of(samples)
    }

    /// The default mode runs the chosen estimator and nothing else.
    #[inline(never)] // a function of its own in the image, which the emulator times
    fn track(&mut self, raw: &RawSample, field: Option<Field>) {
        match self.phase {
            Phase::Starting => return,
            Phase::Running => {
                let force = self.force(raw);
                self.estimators.update(raw.gyro, force, field);
            }
            Phase::Resetting => self.start(self.force(raw)),
            Phase::Releveling => self.level(self.force(raw)),
        }
        if matches!(self.mode, Mode::Flat | Mode::ThreeD) {
            self.update_views(raw);
        }
    }

    #[inline(never)]
    fn update_views(&mut self, raw: &RawSample) {
        match self.mode {
            Mode::Flat => {
                let (sample, bias) = (self.sample(raw), self.estimators.bias());
                self.views
                    .update_flat(sample, bias, self.estimators.sample_period());
            }
            Mode::ThreeD => {
                let (bias, period) = (self.estimators.bias(), self.estimators.sample_period());
                self.views.update_gyro(raw.gyro, bias, period);
            }
            Mode::Info | Mode::Gyro | Mode::Accel | Mode::Quaternion => {}
        }
    }

    /// The force corrected.
    #[inline(always)]
    fn force(&self, raw: &RawSample) -> Force {
        self.calibration.force(raw.accel)
    }

    /// In physical units, with the force corrected and the gyro's bias still in it.
    fn sample(&self, raw: &RawSample) -> Sample<f32> {
        self.calibration.sample(self.ranges.sample(raw))
    }

    /// In physical units, without the bias that the estimator takes off.
    fn reading(&self, raw: &RawSample) -> Reading<f32> {
        self.estimators.bias().correct(self.sample(raw))
    }

    /// Yaw 0, and the tilt that this force (body frame) shows.
    ///
    /// For `r` the course's firmware goes to the identity and leaves the rest to its filter, which
    /// is level again within a few samples. With a time constant of seconds the picture would lean
    /// for half a minute.
    #[cold]
    #[inline(never)]
    fn start(&mut self, force: Force) {
        self.estimators.reset(force);
        self.restart_views();
        self.phase = Phase::Running;
    }

    /// After a gap: the tilt at once, the yaw kept.
    #[cold]
    #[inline(never)]
    fn level(&mut self, force: Force) {
        self.estimators.level(force);
        self.restart_views();
        self.phase = Phase::Running;
    }

    fn restart_views(&mut self) {
        self.views.restart(self.estimators.orientation());
    }
}

/// In single precision, from units of 2⁻³⁰.
fn unit(bits: [i32; 4]) -> UnitQuaternion<f32> {
    let [w, x, y, z] = bits.map(|bits| bits as f32 / (1 << 30) as f32);
    UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
}
