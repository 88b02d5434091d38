//! Estimators in integers, for a core without a floating-point unit: the same filters as in
//! [`orientation`](crate::orientation) and [`fusion`](crate::fusion), which define what is right, at a hundredth of
//! the cost.
//!
//! | file | what it is |
//! |---|---|
//! | `multiply` | the one operation all is made of, which a board can do its own way |
//! | `number` | numbers whose fraction bits are in their type |
//! | `vector`, `quaternion` | three and four of them |
//! | `gyro` | the angles of a sample, of which nothing is rounded off |
//! | `half_angle`, `arc`, `division` | small rotations, arcs and quotients without a library |
//! | `inclination` | how far from level, eq. 20–23 |
//! | `complementary` | the filter of eq. 24 |
//! | `turn` | turns about the vertical |
//! | `measurement`, `affine` | forces and fields, and how they are corrected |
//! | `fusion` | the estimator that is streamed by default |
//!
//! # Formats
//!
//! A product keeps the upper 32 of its 64 bits: Qa times Qb is Q(a + b − 32). So whatever is small and multiplies a
//! quaternion is Q32, and the quaternion stays Q30 without a shift.
//!
//! | quantity | format | range |
//! |---|---|---|
//! | orientation | Q62, its upper half Q30 | ±1 |
//! | gyro less bias, counts | Q15 | ±1½ · 2¹⁵ |
//! | tangent of half a sample's angle | Q32, and as much carried over | ±0.19 an axis |
//! | force, counts | Q16, Q11 in the world | ±2¹⁵ an axis |
//! | (1 − α)/2 | Q35 | 0 to ½; below 2⁻⁴ in 32 bits |
//! | tangent of half the levelling turn per tangent of the tilt | Q35 | 0 to 2⁻⁴ |
//!
//! On the common path, up to 45° of tilt error, α above 7/8 and up to 2.5° of half a sample's angle, no instruction
//! depends on the values. `cargo cost` counts them on the chip.

pub mod multiply;

pub mod number;

pub mod vector;

pub mod quaternion;

mod gyro;

mod half_angle;

mod arc;

mod division;

mod inclination;

pub mod complementary;

mod turn;

pub mod measurement;

pub mod affine;

pub mod fusion;
