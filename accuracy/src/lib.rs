//! The estimators on recorded motions with an optical reference, by the metric of the BROAD benchmark
//! (D. Laidig et al., “BROAD: A Benchmark for Robust Inertial Orientation Estimation”, Data 6(7),
//! 2021).
//!
//! ```text
//! file ──► trial ──► variant ──► estimators ──► score ──► report
//! .imub    samples   slower,     orientations   degrees   tables, q32, pictures
//!                    biased, …
//! ```

/// A recorded motion with its reference.
pub mod trial;

/// The same motion as a worse sensor would have recorded it.
pub mod variant;

/// What is judged: ours and, where they are built in, the filters others publish.
pub mod estimators;

/// Errors in degrees.
pub mod score;

/// Everything run on everything.
pub mod evaluation;

/// Tables, result files and pictures.
pub mod report;
