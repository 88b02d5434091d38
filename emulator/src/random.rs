//! Random numbers without a state: each is a function of its arguments alone, so that neither the order in which
//! they are asked for nor how often changes any of them.

use std::f64::consts::TAU;

/// Two independent numbers from the normal distribution (Box and Muller), a function of its
/// arguments alone.
pub fn normal_pair(seed: u64, index: u64, axis: u64) -> [f64; 2] {
    let key = mix(mix(mix(seed) ^ index) ^ axis);
    // 1 − u is never zero, so the logarithm is finite.
    let radius = (-2.0 * (1.0 - unit(mix(key))).ln()).sqrt();
    let (sin, cos) = (TAU * unit(mix(!key))).sin_cos();
    [radius * cos, radius * sin]
}

/// The step of the SplitMix64 generator (Steele, Lea, Flood 2014), used as a hash.
pub fn mix(value: u64) -> u64 {
    let z = value.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// 0 to just under 1, from the upper 53 bits.
pub fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}
