//! The filter in integers: as the readable one in double precision, and closed against anything.

#[path = "random/mod.rs"]
mod random;

#[path = "fixed/arithmetic.rs"]
mod arithmetic;

#[path = "fixed/reference.rs"]
mod reference;

#[path = "fixed/worst.rs"]
mod worst;
