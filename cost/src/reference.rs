//! What a filter should have come to: the same one in double precision, on the same counts.

use vrduino_cost_images::filter::Filter;
use vrduino_cost_images::head::HEAD;
use vrduino_cost_images::ours::{Course, Default};

/// Body to world: w, x, y, z.
pub type Orientation = [f64; 4];

/// What a filter is held against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// The notes' filter, eq. 24.
    Course,
    /// The default estimator with six axes.
    Default6,
    /// The same with a compass.
    Default9,
    /// One of the filters of the registry.
    Peer(&'static str),
    /// There is none in double precision.
    None,
}

impl Reference {
    /// Its orientation after each sample; none where there is no such filter, or where it is not built.
    pub fn orientations(self) -> Option<Vec<Orientation>> {
        match self {
            Self::Course => Some(run::<Course<f64>>()),
            Self::Default6 => Some(run::<Default<f64, false>>()),
            Self::Default9 => Some(run::<Default<f64, true>>()),
            Self::Peer(name) => peer(name),
            Self::None => None,
        }
    }
}

fn run<F: Filter>() -> Vec<Orientation> {
    let mut filter = F::start();
    HEAD.iter()
        .map(|counts| {
            filter.update(counts);
            filter.orientation()
        })
        .collect()
}

#[cfg(feature = "peers")]
fn peer(name: &str) -> Option<Vec<Orientation>> {
    use vrduino_accuracy_peers::{PEERS, Sample};
    use vrduino_cost_images::filter::PERIOD_S;
    use vrduino_cost_images::head::HEAD_Z_UP;

    let scaled = |counts: [i16; 3], unit: f64| counts.map(|count| f64::from(count) * unit);
    let samples: Vec<Sample> = HEAD_Z_UP
        .iter()
        .map(|counts| Sample {
            rate: scaled(counts.sample.gyro, (2000.0 / 32768.0_f64).to_radians()),
            force: scaled(counts.sample.accel, 2.0 / 32768.0 * 9.806_65),
            field: scaled(counts.field, 0.15),
        })
        .collect();
    let peer = PEERS.iter().find(|peer| peer.name == name)?;
    Some(peer.run(PERIOD_S, &samples))
}

#[cfg(not(feature = "peers"))]
fn peer(_: &str) -> Option<Vec<Orientation>> {
    None
}

/// The angle between two, in degrees; by the sine of its half, which keeps its digits near zero.
pub fn degrees_apart(p: Orientation, q: Orientation) -> f64 {
    let [a, b, c, d] = p;
    let [w, x, y, z] = q;
    let vector = [
        a * x - b * w - c * z + d * y,
        a * y - c * w - d * x + b * z,
        a * z - d * w - b * y + c * x,
    ];
    let sine = vector.iter().map(|part| part * part).sum::<f64>().sqrt();
    2.0 * sine.min(1.0).asin().to_degrees()
}
