//! What filters in C and C++ take, which no default command here can build: for comparison, and not part of a run.
//!
//! Counted once on an emulated Cortex-M4 without floating-point unit, confirmed in a second emulator: gcc 12 at -O2 with
//! libgcc's floating point, on the same kind of input (1 kHz, counts at ±2000 °/s, 100 to 300 °/s, noise), the way from
//! counts to units included. No test here checks them.

/// One of them.
#[derive(Debug, Clone, Copy)]
pub struct Published {
    /// What it is.
    pub label: &'static str,
    /// Instructions an update.
    pub instructions: u32,
}

/// The cheapest first.
#[rustfmt::skip] // one filter per line
pub const PUBLISHED: [Published; 6] = [
    Published { label: "Mahony, 6 axes, the original C, f32", instructions: 3_743 },
    Published { label: "x-io Fusion, 6 axes, C, f32", instructions: 4_828 },
    Published { label: "Madgwick, 6 axes, the original C, f32", instructions: 6_117 },
    Published { label: "Madgwick, 9 axes, the original C, f32", instructions: 12_889 },
    Published { label: "course filter, textbook, C++, f64", instructions: 25_488 },
    Published { label: "VQF, C++, f32", instructions: 53_954 },
];
