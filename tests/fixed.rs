//! The filters in integers: as the readable ones in double precision, and closed against anything.

#[path = "random/mod.rs"]
mod random;

#[path = "fixed/arithmetic.rs"]
mod arithmetic;

#[path = "fixed/motion.rs"]
mod motion;

#[path = "fixed/reference.rs"]
mod reference;

#[path = "fixed/worst.rs"]
mod worst;

#[path = "fixed/affine.rs"]
mod affine;

#[path = "fixed/fusion.rs"]
mod fusion;

#[path = "fixed/fusion_worst.rs"]
mod fusion_worst;
