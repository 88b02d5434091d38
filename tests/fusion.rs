//! The default estimator: tilt, bias and heading.

#[path = "matrices/mod.rs"]
mod matrices;
#[path = "random/mod.rs"]
mod random;
#[path = "fusion/world.rs"]
mod world;

#[path = "fusion/bad_input.rs"]
mod bad_input;
#[path = "fusion/bias.rs"]
mod bias;
#[path = "fusion/compass.rs"]
mod compass;
#[path = "fusion/reference.rs"]
mod reference;
