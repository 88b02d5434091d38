//! The response to self-test, from the factory's codes (application note AN-MPU-9250A-03, section 3.2).

use super::part::SelfTest;

/// Bits 7 to 5 of GYRO_CONFIG and ACCEL_CONFIG actuate x, y, z.
fn actuated(config: u8, axis: usize) -> bool {
    config >> (7 - axis) & 1 != 0
}

/// What a code stands for at ±250 °/s or ±2 g: 2620 × 1.01^(code − 1) counts.
fn factory_counts(code: u8) -> f64 {
    2620.0 * 1.01f64.powi(i32::from(code) - 1)
}

/// What actuation adds to the axes, in the sensor's unit. `counts_per_unit` is the sensitivity at the smallest range.
pub fn response(part: &SelfTest, config: u8, counts_per_unit: f64) -> [f64; 3] {
    if config & 0xE0 == 0 {
        return [0.0; 3];
    }
    std::array::from_fn(|axis| {
        if actuated(config, axis) {
            factory_counts(part.codes[axis]) * part.ratio[axis] / counts_per_unit
        } else {
            0.0
        }
    })
}
