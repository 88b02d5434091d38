//! Everything that makes orientations of samples, behind one name.

use nalgebra::{RealField, UnitQuaternion, Vector3, convert, try_convert};
use vrduino::calibration::{GyroBias, Reading};
use vrduino::fusion::{Fusion, Parameters, Rates};
use vrduino::orientation::complementary::Complementary;
use vrduino::orientation::gyro::DeadReckoning;
use vrduino::orientation::{DEFAULT_TIME_CONSTANT, TimeConstant};
use vrduino::sensor::Sample;
use vrduino::units::{AngularRate, MagneticField, Seconds, SpecificForce};

use crate::trial::{NineAxes, Trial};

/// Which sensors are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Axes {
    /// Gyro and accelerometer.
    Six,
    /// And the magnetometer.
    Nine,
}

type Orientations = Vec<UnitQuaternion<f64>>;

/// One subject.
pub struct Estimator {
    /// As the tables and files call it.
    pub name: String,
    /// What it takes.
    pub axes: Axes,
    run: Box<dyn Fn(&Trial) -> Orientations + Send + Sync>,
}

impl Estimator {
    fn new(
        name: &str,
        axes: Axes,
        run: impl Fn(&Trial) -> Orientations + Send + Sync + 'static,
    ) -> Self {
        Self {
            name: name.into(),
            axes,
            run: Box::new(run),
        }
    }

    /// The name without what stands in brackets or behind a comma.
    pub fn short_name(&self) -> &str {
        self.name
            .split([',', '('])
            .next()
            .unwrap_or_default()
            .trim()
    }

    /// Body → world (y up) after each sample.
    pub fn run(&self, trial: &Trial) -> Orientations {
        (self.run)(trial)
    }
}

/// Ours, and those of others where they are built in (feature `peers`).
pub fn all() -> Vec<Estimator> {
    let mut all = ours();
    all.extend(peers());
    all
}

#[cfg(not(feature = "peers"))]
fn peers() -> Vec<Estimator> {
    Vec::new()
}

/// Each on the parameters its authors chose.
#[cfg(feature = "peers")]
fn peers() -> Vec<Estimator> {
    use vrduino_accuracy_peers::{PEERS, Sample};
    use vrduino_emulator::motion::imub::y_up_from_enu;

    let estimator = |peer: vrduino_accuracy_peers::Peer| {
        let axes = if peer.axes == 6 {
            Axes::Six
        } else {
            Axes::Nine
        };
        let name = peer.name.trim_end_matches(['-', '6', '9']);
        Estimator::new(&format!("{name} ({})", peer.source), axes, move |trial| {
            let sample = |axes: &NineAxes| Sample {
                rate: axes.sample.rate.rad_per_s().into(),
                force: axes.sample.force.m_per_s2().into(),
                field: axes.field.microtesla().into(),
            };
            let samples: Vec<_> = trial.samples.iter().map(sample).collect();
            let found = peer.run(trial.period, &samples).into_iter();
            let y_up = found.map(y_up_from_enu);
            let unit = |[w, x, y, z]: [f64; 4]| {
                UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z))
            };
            y_up.map(unit).collect()
        })
    };
    PEERS.into_iter().map(estimator).collect()
}

/// A lead that suits BROAD: its optical reference is so much ahead of its sensor, s.
const LEAD: f64 = 0.0025;

/// The estimators of this project.
pub fn ours() -> Vec<Estimator> {
    let led = |lead| Parameters {
        lead: Seconds(lead),
        ..Parameters::default()
    };
    let fusion = |name, axes, parameters| {
        Estimator::new(name, axes, move |trial| fused(trial, axes, &parameters))
    };
    vec![
        fusion("vrduino", Axes::Six, led(0.0)),
        fusion("vrduino, 2.5 ms lead", Axes::Six, led(LEAD)),
        Estimator::new("vrduino, f32", Axes::Six, |trial| {
            fused::<f32>(trial, Axes::Six, &Parameters::default())
        }),
        Estimator::new("course notes, eq. 24, 7.6 s", Axes::Six, course),
        Estimator::new("gyro alone", Axes::Six, dead_reckoning),
        fusion("vrduino", Axes::Nine, led(0.0)),
        fusion("vrduino, 2.5 ms lead", Axes::Nine, led(LEAD)),
        Estimator::new("vrduino, f32", Axes::Nine, |trial| {
            fused::<f32>(trial, Axes::Nine, &Parameters::default())
        }),
    ]
}

fn fused<T: RealField + Copy>(
    trial: &Trial,
    axes: Axes,
    parameters: &Parameters<T>,
) -> Orientations {
    let period = Seconds(convert(trial.period));
    let rates = Rates {
        sample: period,
        field: period,
    };
    let mut fusion = Fusion::new(parameters, rates);
    let narrow = |v: Vector3<f64>| v.map(convert::<f64, T>);
    let orientations = trial.samples.iter().map(|NineAxes { sample, field }| {
        let sample = Sample {
            rate: AngularRate::from_rad_per_s(narrow(sample.rate.rad_per_s())),
            force: SpecificForce::from_m_per_s2(narrow(sample.force.m_per_s2())),
        };
        let field = MagneticField::from_microtesla(narrow(field.microtesla()));
        fusion.update(&sample, (axes == Axes::Nine).then_some(field));
        fusion.orientation()
    });
    orientations.map(widened).collect()
}

fn widened<T: RealField + Copy>(q: UnitQuaternion<T>) -> UnitQuaternion<f64> {
    let part = |value: T| try_convert(value).unwrap_or(f64::NAN);
    UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(
        part(q.w),
        part(q.i),
        part(q.j),
        part(q.k),
    ))
}

/// Without the bias of the first second, in which the firmware measures it too.
fn readings(trial: &Trial) -> impl Iterator<Item = Reading<f64>> {
    let second = ((1.0 / trial.period) as usize).clamp(1, trial.samples.len());
    let sum: Vector3<f64> = trial.samples[..second]
        .iter()
        .map(|axes| axes.sample.rate.rad_per_s())
        .sum();
    let bias = GyroBias::new(AngularRate::from_rad_per_s(sum / second as f64));
    trial
        .samples
        .iter()
        .map(move |axes| bias.correct(axes.sample))
}

fn course(trial: &Trial) -> Orientations {
    let time = Seconds(f64::from(DEFAULT_TIME_CONSTANT.time().0));
    let mut filter = Complementary::new(TimeConstant::new(time), Seconds(trial.period));
    if let Some(first) = trial.samples.first() {
        filter.reset(first.sample.force);
    }
    readings(trial)
        .map(|reading| filter.update(&reading))
        .collect()
}

fn dead_reckoning(trial: &Trial) -> Orientations {
    let mut gyro = DeadReckoning::new(Seconds(trial.period));
    readings(trial)
        .map(|reading| gyro.update(&reading))
        .collect()
}
