//! Head tracking with an MPU-9250: from raw counts to a quaternion on a serial line.
//!
//! This is the part of the VRduino firmware that knows nothing of the chip it runs on. The same
//! code runs on a Teensy 3.2 (a Cortex-M4 without a floating-point unit) and in the tests on a
//! desk. It follows one sample from the sensor to the host, and so does the list of modules below:
//!
//! ```text
//! counts ──► sensor ──► calibration ──► orientation ──► wire ──► (USB) ──► viewer
//! i16×6      units      corrected       quaternion      bytes              picture
//! ```
//!
//! Every arrow is one function call, and no module knows its right-hand neighbour.
//! [`tracker::Tracker::update`] is those calls in order: start reading there.
//!
//! The mathematics is that of the *course notes*: Gordon Wetzstein, “3-DOF Orientation Tracking
//! with IMUs”. Every formula names its equation number; where the notes are followed in spirit
//! but not to the letter, the comment says what differs and why. Two lectures, a post and a paper
//! stand beside the notes; `docs/equations.md` says where each of their equations lives,
//! `docs/errata.md` what is wrong in print, and `docs/conventions.md` how they differ. The paper's
//! own conventions (north-east-down, scalar last) stay inside [`virtual_gyro`]; [`frames`] leads out.
//!
//! # Conventions
//!
//! * **World**: right-handed, y up. **Body**: right-handed, fixed to the board; with the board
//!   level the accelerometer reads (0, +9.81, 0) m/s², because it measures the force that holds
//!   the board up. A level board at the starting heading has the identity as its orientation.
//! * An orientation q takes vectors **from body to world**: u_world = q u_body q⁻¹ (eq. 19).
//!   Wherever a quaternion is spelled out the order is w, x, y, z.
//! * Rates, forces, fields, angles, times and lengths have a type that names their unit ([`units`]).
//!   Bare numbers are what has no unit (weights, gains, factors, quaternions, directions) and a few
//!   that name theirs (`max_dps`, `microtesla_per_count`).
//! * The estimators are generic over the scalar: `f32` on the board, `f64` in tests. They never
//!   panic and never return anything but a finite unit quaternion, whatever they are fed.
//!
//! ```
//! use vrduino::sensor::{AccelRange, GyroRange, Ranges, RawSample};
//! use vrduino::tracker::{Health, Tracker};
//!
//! let ranges = Ranges { gyro: GyroRange::Dps2000, accel: AccelRange::G16 };
//! let mut tracker = Tracker::new(ranges);
//! // A board lying level and still: 1 g on the y axis, 2048 counts per g.
//! let raw = RawSample { gyro: [0; 3], accel: [0, 2048, 0], temperature: 0, fresh: true };
//! let mut last = String::new();
//! for _ in 0..1000 {
//!     tracker.update(&raw, None, &Health::default(), &mut |line| last = line.to_string());
//! }
//! assert_eq!(last, "QC 1.000 0.000 0.000 0.000\n");
//! ```

#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

/// Its vectors and unit quaternions are in this crate's interface: whoever calls it needs the very
/// version that it was built with.
pub use nalgebra;

/// The Rust in the README compiles and runs as the documentation's does.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;

/// Quantities with units: a rate is never mistaken for an angle, nor degrees for radians.
pub mod units;

/// The documents' frames, layouts and products, each into the conventions above and back.
pub mod frames;

/// Raw counts to physical units, by the numbers of the data sheet.
pub mod sensor;

/// Finding the sensor on its bus, setting it up, and proving that it took the settings.
pub mod imu;

/// When to read the sensor, and when what was read was measured.
pub mod sampling;

/// Is the board still? If so, what does the gyro read when nothing turns?
pub mod calibration;

/// The estimators of the course notes, one per file.
pub mod orientation;

/// The notes' filter and the default estimator in integers, for a core without a floating-point unit: what the
/// tracker runs.
pub mod fixed;

/// The default estimator: tilt, bias and heading, level with the best published filter.
pub mod fusion;

/// A gyro made of an accelerometer and a magnetometer.
pub mod virtual_gyro;

/// Numbers as people write them.
pub mod decimal;

/// Lines and frames for the host, to the byte, and how a host reads them.
pub mod wire;

/// Keys from the host.
pub mod command;

/// The path of a sample, from counts to lines, called once per sample.
pub mod tracker;

/// What a viewer makes of the quaternion: a view matrix for each eye, and a projection.
pub mod view;
