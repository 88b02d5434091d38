//! `cargo cost`.
fn main() {}
