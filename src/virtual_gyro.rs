//! Orientation and angular velocity from an accelerometer and a magnetometer, without a gyro: B.
//! Delporte, L. Perroton, T. Grandpierre, J. Trichet, “Accelerometer and Magnetometer Based
//! Gyroscope Emulation on Smart Sensor for a Virtual Reality Application” (2012), the *paper* of
//! this module. Equation and section numbers here are the paper's.
//!
//! | file | paper | step |
//! |---|---|---|
//! | `fields` | section 3.1, eq. 1, 2 | the two fields, in the reference and in the device frame |
//! | `butterworth` | 3.2.1 | low-pass filter of first order |
//! | `cut_off` | 3.2.1 | its adaptive cut-off |
//! | `median`, `average` | 3.2.2, 3.2.3 | sliding windows |
//! | `gravity` | figure 4 | the three in a row: g_d, and B_d in phase with it |
//! | `angles` | 3.1, 3.3, 3.4, table 1 | first method: Tait-Bryan angles |
//! | `matrix` | 4.1, eq. 7 | second method: the rotation matrix M |
//! | `attitude_quaternion` | 3.6, 4.2, 4.3, table 2 | between angles, matrix and quaternion |
//! | `angular_velocity` | 3.5.5 | the rate, in the device and in the reference frame |
//! | `pipeline` | figures 3 and 6 | all of it, sample by sample |
//!
//! # Conventions
//!
//! They are the paper's, and not those of the rest of this library:
//!
//! * **Reference frame** (index r): x to magnetic north, y east, z **down**.
//! * **Device frame** (index d): right-handed, fixed to the device. Flat and facing north, the
//!   two frames are one.
//! * g_d points **down**: it is minus what the accelerometer reads at rest.
//! * Matrices (R, M) take vectors from reference to device, quaternions from device to reference.
//! * Quaternions are scalar-last (q₁ q₂ q₃ q₄), which is how nalgebra stores them in `coords`.
//! * φ, θ, ψ are roll about x, pitch about y, yaw about z.

pub mod fields;

pub mod butterworth;

pub mod cut_off;

pub mod median;

pub mod average;

pub mod gravity;

pub mod angles;

pub mod matrix;

pub mod attitude_quaternion;

pub mod angular_velocity;

pub mod pipeline;

pub use angles::{GimbalLock, TaitBryan};
pub use angular_velocity::AngularVelocity;
pub use fields::{Directions, Earth, Fields, NoAttitude};
pub use gravity::GravityExtraction;
pub use pipeline::{Estimate, Method, NoEstimate, Settings, VirtualGyro};
