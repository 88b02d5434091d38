//! Table 1 as printed beside the attitudes it is about.

use crate::reference::*;
use std::f64::consts::{FRAC_PI_2, PI};
use vrduino::virtual_gyro::{GimbalLock, TaitBryan};

const DELTA: f64 = 0.9;
const H: f64 = FRAC_PI_2;

/// g_dNx, g_dNy, the signs and names of B_dNx and B_dNy, and the rows φ, θ, ψ.
struct Block {
    gravity: [f64; 2],
    magnetic: fn(f64, f64) -> [f64; 2],
    rows: &'static [Vector],
}

/// As printed; the functions take sin δ and cos δ.
const PRINTED: [Block; 8] = [
    Block {
        gravity: [1.0, 0.0],
        magnetic: |s, c| [s, c],
        rows: &[[-H, -H, 0.0], [0.0, -H, -H], [H, -H, PI], [PI, -H, H]],
    },
    Block {
        gravity: [1.0, 0.0],
        magnetic: |s, c| [s, -c],
        rows: &[[-H, -H, 0.0], [0.0, -H, H], [H, -H, PI], [PI, -H, -H]],
    },
    Block {
        gravity: [0.0, -1.0],
        magnetic: |s, c| [c, -s],
        rows: &[[-H, 0.0, 0.0], [H, PI, PI]],
    },
    Block {
        gravity: [0.0, -1.0],
        magnetic: |s, c| [-c, -s],
        rows: &[[-H, 0.0, PI], [H, PI, 0.0]],
    },
    Block {
        gravity: [-1.0, 0.0],
        magnetic: |s, c| [-s, -c],
        rows: &[[-H, H, 0.0], [0.0, H, H], [H, H, PI], [PI, H, -H]],
    },
    Block {
        gravity: [-1.0, 0.0],
        magnetic: |s, c| [-s, -c],
        rows: &[[-H, H, PI], [0.0, H, -H], [H, H, 0.0], [PI, H, H]],
    },
    Block {
        gravity: [0.0, -1.0],
        magnetic: |s, c| [-c, s],
        rows: &[[-H, PI, 0.0], [H, 0.0, PI]],
    },
    Block {
        gravity: [0.0, -1.0],
        magnetic: |s, c| [c, s],
        rows: &[[-H, PI, 0.0], [H, 0.0, PI]],
    },
];

/// The blocks with the corrections of docs/errata.md.
fn corrected() -> [Block; 8] {
    let mut table = PRINTED;
    table[1].rows = &[[-H, -H, PI], [0.0, -H, H], [H, -H, 0.0], [PI, -H, -H]];
    table[5].magnetic = |s, c| [-s, c];
    table[6].gravity = [0.0, 1.0];
    table[7].gravity = [0.0, 1.0];
    table[7].rows = &[[-H, PI, PI], [H, 0.0, 0.0]];
    table
}

/// Whether a device turned by these angles sees what the block says.
fn holds(block: &Block, angles: Vector) -> bool {
    let (s, c) = DELTA.sin_cos();
    let g = apply(&r(angles), [0.0, 0.0, 1.0]);
    let b = apply(&r(angles), [c, 0.0, s]);
    let [bx, by] = (block.magnetic)(s, c);
    let [gx, gy] = block.gravity;
    [g[0] - gx, g[1] - gy, b[0] - bx, b[1] - by]
        .iter()
        .all(|difference| difference.abs() < 1e-12)
}

fn right_rows(table: &[Block]) -> Vec<Vec<bool>> {
    let of = |block: &Block| block.rows.iter().map(|&row| holds(block, row)).collect();
    table.iter().map(of).collect()
}

#[test]
fn ten_of_the_24_printed_rows_are_wrong() {
    let wrong: Vec<usize> = right_rows(&PRINTED)
        .iter()
        .map(|rows| rows.iter().filter(|right| !**right).count())
        .collect();
    // Two of block 2, all of block 6 by its label, all of 7 and 8.
    assert_eq!(wrong, [0, 2, 0, 0, 0, 4, 2, 2]);
    assert_eq!(
        PRINTED.iter().map(|block| block.rows.len()).sum::<usize>(),
        24
    );
}

#[test]
fn all_rows_of_the_corrected_table_hold() {
    assert!(
        right_rows(&corrected())
            .iter()
            .flatten()
            .all(|right| *right)
    );
}

#[test]
fn the_method_finds_the_attitude_of_every_corrected_row() {
    for angles in corrected().iter().flat_map(|block| block.rows) {
        let attitude = r(*angles);
        for previous in [
            None,
            Some(TaitBryan::from_rad(angles[0], angles[1], angles[2])),
        ] {
            let seen = directions::<f64>(&attitude, DELTA);
            let found = rad(&TaitBryan::from_directions(
                &seen,
                GimbalLock::Resolve,
                previous,
            ));
            assert!(
                largest_difference(&r(found), &attitude) < 1e-12,
                "{angles:?}"
            );
            assert!(found[1].abs() <= FRAC_PI_2, "θ of eq. 4 stays in its range");
            // With a roll to keep, the row itself comes back.
            if angles[1].abs() == FRAC_PI_2 && previous.is_some() {
                assert_eq!(found[..2], angles[..2]);
                assert!(((found[2] - angles[2]) / 2.0).sin().abs() < 1e-12);
            }
        }
    }
}

#[test]
fn the_table_is_no_cover_of_the_singularities() {
    // At (.7, −π/2, .4) g_d lies along x_d, and B_dNy is in no block.
    let b = apply(&r([0.7, -FRAC_PI_2, 0.4]), [DELTA.cos(), 0.0, DELTA.sin()]);
    assert!((b[1] + 0.554).abs() < 1e-3);
    assert!((b[1].abs() - DELTA.cos()).abs() > 0.06);
    let sum = (-b[1]).atan2(-b[2]);
    assert!((sum - 1.1).abs() < 1e-12);
}

#[test]
fn gravity_along_y_is_no_singularity() {
    // Blocks 3, 4, 7 and 8. With atan2 nothing divides by zero there.
    for phi in [-FRAC_PI_2, FRAC_PI_2] {
        for psi in [-3.0, -1.0, 0.0, 0.6, 2.0] {
            let seen = directions::<f64>(&r([phi, 0.0, psi]), DELTA);
            let found = TaitBryan::from_directions(&seen, GimbalLock::Keep, None);
            assert!(apart(rad(&found), [phi, 0.0, psi]) < 1e-12);
        }
    }
}
