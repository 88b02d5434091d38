//! The five documents measure the same head in different frames, write the same quaternion in
//! different orders, and multiply it from different sides. Each conversion here leads from one of
//! them to the conventions of this crate, and back; `docs/conventions.md` says which document needs
//! which.
//!
//! | file | between |
//! |---|---|
//! | `axes` | y-up, north-east-down, east-north-up, and the axes of the blog post's picture |
//! | `gravity` | what an accelerometer reads, and the pull of the earth |
//! | `layout` | a quaternion's scalar first, or last |
//! | `passive` | turning a vector, or the frame it is seen from |
//! | `product` | a step in the body's axes on the right, or in the world's on the left |
//! | `angles` | yaw, pitch and roll about different axes; angles up to half a turn or a whole one |
//! | `weight` | α as the share of the gyro, or of the correction |
//!
//! Degrees and radians are converted where a number gets its unit: [`crate::units`].

pub mod axes;

pub mod gravity;

pub mod layout;

pub mod passive;

pub mod product;

pub mod angles;

pub mod weight;
