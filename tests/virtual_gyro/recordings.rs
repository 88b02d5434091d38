//! Figure 8 on recorded motions: the virtual gyroscope beside the gyro that was tied to it, and its
//! attitude beside the optical reference. `VRDUINO_MOTIONS` names the folder of the recordings.

use crate::reference::*;
use nalgebra::Vector3;
use std::path::PathBuf;
use vrduino::units::{MagneticField, Seconds, SpecificForce};
use vrduino::virtual_gyro::butterworth::CutOff;
use vrduino::virtual_gyro::{
    Estimate, GimbalLock, GravityExtraction, Method, Settings, VirtualGyro,
};
use vrduino_emulator::motion::{self, Instant};

/// Samples a second that are taken: every eighth of the recording. A rate is the difference of two
/// attitudes over the time between them, so that at the full 286 Hz the noise of the sensors, and
/// what the low-pass at 0.02 F_e lets through of accelerations, outweigh it.
const RATE: f64 = 2000.0 / 7.0 / 8.0;

/// From the first movement on (s).
const LENGTH: f64 = 60.0;

fn instants(name: &str) -> Vec<Instant> {
    let folder = std::env::var_os("VRDUINO_MOTIONS").expect("VRDUINO_MOTIONS names a folder");
    let path = PathBuf::from(folder).join(name);
    let motion = motion::open(&path).unwrap_or_else(|error| panic!("{error}"));
    let at = |k: usize| motion.at(k as f64 / RATE);
    let all = (motion.duration().expect("a recording ends") * RATE) as usize;
    let moves = |i: &Instant| i.rate.iter().map(|w| w * w).sum::<f64>().sqrt() > 0.3;
    let start = (0..all)
        .find(|&k| moves(&at(k)))
        .expect("there is movement");
    (start..all.min(start + (LENGTH * RATE) as usize))
        .map(at)
        .collect()
}

type Gyro = VirtualGyro<f64, 5, 5>;

fn run(mut gyro: Gyro, instants: &[Instant]) -> Vec<Option<Estimate<f64>>> {
    let feed = |instant: &Instant| {
        let force = SpecificForce::from_m_per_s2(Vector3::from(instant.force));
        let field = instant.field.map(Vector3::from);
        gyro.update(force, field.map(MagneticField::from_microtesla))
            .ok()
    };
    instants.iter().map(feed).collect()
}

/// The recorded rate, the error of the virtual one (both °/s, rms over all axes), the correlation
/// of the two, and the error of the attitude in degrees rms, all at a lag in samples.
#[derive(Clone, Copy, Debug)]
struct Score {
    lag: usize,
    recorded: f64,
    error: f64,
    correlation: f64,
    attitude: f64,
}

fn score(estimates: &[Option<Estimate<f64>>], instants: &[Instant], lag: usize) -> Score {
    let [mut rr, mut vv, mut rv, mut ee]: [f64; 4] = [0.0; 4];
    let (mut n, mut squares, mut references) = (0.0, 0.0, 0.0);
    for (estimate, instant) in estimates.iter().skip(lag).zip(instants) {
        let Some(estimate) = estimate else { continue };
        if let Some(velocity) = estimate.velocity {
            for (virtual_rate, rate) in array(velocity.device.rad_per_s()).iter().zip(instant.rate)
            {
                rr += rate * rate;
                vv += virtual_rate * virtual_rate;
                rv += rate * virtual_rate;
                ee += (rate - virtual_rate) * (rate - virtual_rate);
            }
            n += 3.0;
        }
        if let Some([w, x, y, z]) = instant.truth {
            // Rows of device → (east, up, south), taken as north, east, down.
            let [east, up, south] = sandwich([x, y, z, w]);
            let truth = [south.map(|c| -c), east, up.map(|c| -c)];
            let found = sandwich(scalar_last(&estimate.orientation));
            squares += degrees_between(&found, &truth).powi(2);
            references += 1.0;
        }
    }
    assert!(n > 1000.0 && references > 300.0, "too little to compare");
    Score {
        lag,
        recorded: (rr / n).sqrt().to_degrees(),
        error: (ee / n).sqrt().to_degrees(),
        correlation: rv / (rr * vv).sqrt(),
        attitude: (squares / references).sqrt(),
    }
}

fn best(estimates: &[Option<Estimate<f64>>], instants: &[Instant]) -> Score {
    (0..40)
        .map(|lag| score(estimates, instants, lag))
        .min_by(|a, b| a.error.total_cmp(&b.error))
        .expect("there are lags")
}

fn follows(name: &str) -> Score {
    let instants = instants(name);
    let settings = |method| Settings {
        sample_period: Seconds(1.0 / RATE),
        method,
    };
    let fixed = |method| {
        let extraction = GravityExtraction::with_cut_off(CutOff::new(0.02).unwrap());
        run(
            Gyro::with_extraction(settings(method), extraction),
            &instants,
        )
    };
    let (angles, matrix) = (
        fixed(Method::Angles(GimbalLock::Resolve)),
        fixed(Method::Matrix),
    );
    // The two methods are two ways to the same number.
    for (a, b) in angles.iter().zip(&matrix) {
        assert_eq!(a.is_some(), b.is_some());
        let (Some(a), Some(b)) = (a, b) else { continue };
        assert!(a.orientation.angle_to(&b.orientation) < 1e-7);
    }
    let by_fixed = best(&matrix, &instants);
    let adaptive = run(Gyro::new(settings(Method::Matrix)), &instants);
    let by_adaptive = best(&adaptive, &instants);
    for (cut_off, score) in [("fixed", by_fixed), ("adaptive", by_adaptive)] {
        eprintln!(
            "{name}, {cut_off} cut-off: gyro {:.1} °/s, error {:.1} °/s rms, correlation {:.2}, \
             attitude {:.1}° rms, {} samples late",
            score.recorded, score.error, score.correlation, score.attitude, score.lag
        );
    }
    by_fixed
}

#[test]
// Ignored without the recordings: they are a benchmark's data, which this repository does not carry.
#[ignore = "needs VRDUINO_MOTIONS, a folder of recorded motions, which are not kept here"]
fn follows_the_gyro_of_a_recorded_slow_rotation() {
    let score = follows("02_undisturbed_slow_rotation_B.imub");
    assert!(score.correlation > 0.85, "{score:?}");
    assert!(score.error < score.recorded / 2.0, "{score:?}");
    assert!(score.attitude < 8.0, "{score:?}");
}

#[test]
// Ignored without the recordings: they are a benchmark's data, which this repository does not carry.
#[ignore = "needs VRDUINO_MOTIONS, a folder of recorded motions, which are not kept here"]
fn follows_the_gyro_of_a_recorded_fast_rotation() {
    let score = follows("06_undisturbed_fast_rotation_A.imub");
    assert!(score.correlation > 0.65, "{score:?}");
    assert!(score.error < score.recorded, "{score:?}");
    assert!(score.attitude < 25.0, "{score:?}");
}

#[test]
// Ignored without the recordings: they are a benchmark's data, which this repository does not carry.
#[ignore = "needs VRDUINO_MOTIONS, a folder of recorded motions, which are not kept here"]
fn a_recorded_fast_translation_is_beyond_it() {
    // The device is accelerated by more than 1 g half of the time: nothing tells gravity from that.
    let score = follows("15_undisturbed_fast_translation_A.imub");
    assert!(score.error > score.recorded, "{score:?}");
}
