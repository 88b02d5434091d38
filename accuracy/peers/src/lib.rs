//! The orientation filters of the registry, each on the parameters its authors chose, behind one
//! interface.
//!
//! Nothing is tuned here. A filter is told the sample period and, where it can be told, that the
//! world is east, north, up. What else differs between the crates is turned into one convention:
//!
//! | file | filters | gyro | accelerometer | world | scalar |
//! |---|---|---|---|---|---|
//! | `madgwick_mahony` | Madgwick, Mahony | rad/s | direction only | x north, y west, z up | f64 |
//! | `fusion` | x-io Fusion, with and without its bias correction | °/s | direction only | ENU on request | f32 |
//! | `vqf` | VQF | rad/s | m/s² | ENU | f64 |
//!
//! All of them take a force that points up at rest and a field in any unit, and give body → world.
//!
//! The tests see to the conventions. What each filter scores on recorded motions is for the bench
//! that depends on this crate to say.

mod fusion;
mod madgwick_mahony;
mod vqf;

/// One sample of the three sensors, in the axes of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Angular rate, rad/s.
    pub rate: [f64; 3],
    /// Specific force, m/s²: up at rest.
    pub force: [f64; 3],
    /// Magnetic field, µT. A filter with 6 axes does not look at it.
    pub field: [f64; 3],
}

/// An orientation, body → world, as w x y z. World: x east, y north, z up.
type Orientation = [f64; 4];

/// A filter somebody else wrote.
#[derive(Clone, Copy, Debug)]
pub struct Peer {
    /// What it is called here: unique, and fit for the name of a directory.
    pub name: &'static str,
    /// Crate and version.
    pub source: &'static str,
    /// 6 without magnetometer, 9 with.
    pub axes: u8,
    run: fn(f64, &[Sample]) -> Vec<Orientation>,
}

impl Peer {
    /// The orientation after each sample: body → world as w x y z. World: z up, and with 9 axes y to
    /// magnetic north; with 6 the heading at the start is the filter's own.
    ///
    /// Every run starts afresh. `period_s` is the time between samples in seconds and must be
    /// positive. What a filter makes of values that are not finite is its own affair.
    pub fn run(&self, period_s: f64, samples: &[Sample]) -> Vec<[f64; 4]> {
        (self.run)(period_s, samples)
    }
}

const AHRS: &str = "ahrs 0.8.0";
const FUSION: &str = "fusion-ahrs 1.0.1";
const VQF: &str = "vqf-rs 0.3.0";

/// All of them.
#[rustfmt::skip] // one filter per line
pub const PEERS: [Peer; 10] = [
    Peer { name: "madgwick-6",    source: AHRS,   axes: 6, run: madgwick_mahony::madgwick_6 },
    Peer { name: "madgwick-9",    source: AHRS,   axes: 9, run: madgwick_mahony::madgwick_9 },
    Peer { name: "mahony-6",      source: AHRS,   axes: 6, run: madgwick_mahony::mahony_6 },
    Peer { name: "mahony-9",      source: AHRS,   axes: 9, run: madgwick_mahony::mahony_9 },
    Peer { name: "fusion-6",      source: FUSION, axes: 6, run: fusion::plain_6 },
    Peer { name: "fusion-9",      source: FUSION, axes: 9, run: fusion::plain_9 },
    Peer { name: "fusion-bias-6", source: FUSION, axes: 6, run: fusion::bias_6 },
    Peer { name: "fusion-bias-9", source: FUSION, axes: 9, run: fusion::bias_9 },
    Peer { name: "vqf-6",         source: VQF,    axes: 6, run: vqf::run_6 },
    Peer { name: "vqf-9",         source: VQF,    axes: 9, run: vqf::run_9 },
];
