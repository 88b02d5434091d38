//! A head that turns at 100 to 300 °/s about all three axes, as a sensor reports it a thousand times a second.
//!
//! Computed by the compiler, without a function that differs from machine to machine: the host has the very counts
//! that are in the chip's flash.

use crate::filter::{BIAS_PARTS, Counts, PERIOD_S};
use vrduino::sensor::RawSample;

/// How many samples there are.
pub const SAMPLES: usize = 3000;

/// How many of them a filter takes that does the same with each.
pub const FEW: usize = 1000;

/// How many samples there are from one of the magnetometer to the next: 100 a second.
pub const FIELD_EVERY: usize = 10;

/// Level at the start: y up.
pub static HEAD: [Counts; SAMPLES] = turning(false);

/// The same body with other names for its axes, for filters that start from the identity and have z up.
pub static HEAD_Z_UP: [Counts; SAMPLES] = turning(true);

/// Amplitude in °/s and period in samples of the rate about each axis.
const RATES: [(f64, usize); 3] = [(110.0, 730), (290.0, 1130), (160.0, 510)];

/// In counts a °/s.
const COUNTS_PER_DPS: f64 = 32768.0 / 2000.0;

/// In counts a g.
const COUNTS_PER_G: f64 = 16384.0;

/// To magnetic north and down, in counts: 20 µT and 43 µT.
const FIELD_COUNTS: [f64; 2] = [20.0 / 0.15, 43.0 / 0.15];

const RADIANS_PER_DEGREE: f64 = core::f64::consts::PI / 180.0;

const fn turning(z_up: bool) -> [Counts; SAMPLES] {
    let mut samples = [Counts {
        sample: RawSample {
            gyro: [0; 3],
            accel: [0; 3],
            temperature: 0,
            fresh: true,
        },
        field: [0; 3],
        field_is_new: false,
    }; SAMPLES];
    let mut q = [1.0, 0.0, 0.0, 0.0];
    let mut noise = 0x9E37_79B9;
    let mut field = [0; 3];
    let mut step = 0;
    while step < SAMPLES {
        let mut dps = [0.0; 3];
        let mut gyro = [0; 3];
        let mut accel = [0; 3];
        let mut axis = 0;
        while axis < 3 {
            let (amplitude, period) = RATES[axis];
            dps[axis] = amplitude * triangle(step, period);
            axis += 1;
        }
        q = turned(q, dps);
        let up = in_body(q, [0.0, 1.0, 0.0]);
        let north = in_body(q, [0.0, 0.0, -1.0]);
        let field_is_new = step % FIELD_EVERY == 0;
        axis = 0;
        while axis < 3 {
            let bias = BIAS_PARTS[axis] as f64 / 32768.0;
            gyro[axis] = rounded(dps[axis] * COUNTS_PER_DPS + bias + random(&mut noise, 3.0));
            accel[axis] = rounded(up[axis] * COUNTS_PER_G + random(&mut noise, 80.0));
            axis += 1;
        }
        if field_is_new {
            let body = [
                FIELD_COUNTS[0] * north[0] - FIELD_COUNTS[1] * up[0] + random(&mut noise, 4.0),
                FIELD_COUNTS[0] * north[1] - FIELD_COUNTS[1] * up[1] + random(&mut noise, 4.0),
                FIELD_COUNTS[0] * north[2] - FIELD_COUNTS[1] * up[2] + random(&mut noise, 4.0),
            ];
            // The magnetometer's own axes.
            field = [rounded(body[1]), rounded(body[0]), rounded(-body[2])];
        }
        samples[step] = Counts {
            sample: RawSample {
                gyro: if z_up { renamed(gyro) } else { gyro },
                accel: if z_up { renamed(accel) } else { accel },
                temperature: 0,
                fresh: true,
            },
            field: if z_up {
                // x, y, z of the body that is named anew, in axes that are the body's.
                renamed([field[1], field[0], -field[2]])
            } else {
                field
            },
            field_is_new,
        };
        step += 1;
    }
    samples
}

/// y, which is up, becomes z.
const fn renamed(v: [i16; 3]) -> [i16; 3] {
    [v[0], -v[2], v[1]]
}

/// There and back: 0 at the start, 1 after a quarter of the period, −1 after three.
const fn triangle(step: usize, period: usize) -> f64 {
    let phase = (step % period) as f64 / period as f64;
    if phase < 0.25 {
        4.0 * phase
    } else if phase < 0.75 {
        2.0 - 4.0 * phase
    } else {
        4.0 * phase - 4.0
    }
}

/// Half a sample's angle is below 0.003, so that its tangent is itself to 1e-8.
const fn turned(q: [f64; 4], dps: [f64; 3]) -> [f64; 4] {
    let half = 0.5 * RADIANS_PER_DEGREE * PERIOD_S;
    let [w, x, y, z] = q;
    let [a, b, c] = [dps[0] * half, dps[1] * half, dps[2] * half];
    let turned = [
        w - x * a - y * b - z * c,
        x + w * a + y * c - z * b,
        y + w * b + z * a - x * c,
        z + w * c + x * b - y * a,
    ];
    let [w, x, y, z] = turned;
    let shorter = 1.5 - 0.5 * (w * w + x * x + y * y + z * z);
    [w * shorter, x * shorter, y * shorter, z * shorter]
}

/// A direction of the world as the body sees it: q⁻¹ v q.
const fn in_body(q: [f64; 4], v: [f64; 3]) -> [f64; 3] {
    let [w, x, y, z] = [q[0], -q[1], -q[2], -q[3]];
    let inner = [
        y * v[2] - z * v[1] + w * v[0],
        z * v[0] - x * v[2] + w * v[1],
        x * v[1] - y * v[0] + w * v[2],
    ];
    [
        v[0] + 2.0 * (y * inner[2] - z * inner[1]),
        v[1] + 2.0 * (z * inner[0] - x * inner[2]),
        v[2] + 2.0 * (x * inner[1] - y * inner[0]),
    ]
}

/// From −`size` to `size`, more often in the middle (xorshift32).
const fn random(state: &mut u32, size: f64) -> f64 {
    let mut sum = 0.0;
    let mut term = 0;
    while term < 3 {
        *state ^= *state << 13;
        *state ^= *state >> 17;
        *state ^= *state << 5;
        sum += *state as f64 / 4_294_967_296.0 - 0.5;
        term += 1;
    }
    size * sum / 1.5
}

const fn rounded(value: f64) -> i16 {
    // A cast cuts off towards zero, and saturates.
    (if value < 0.0 {
        value - 0.5
    } else {
        value + 0.5
    }) as i16
}
