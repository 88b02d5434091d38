//! The virtual gyroscope (document 002) beside matrices, dot products and differences written out
//! here in double precision, and beside the printed forms where they are wrong.

mod matrices;

mod random;

#[path = "virtual_gyro/reference.rs"]
mod reference;

#[path = "virtual_gyro/filters.rs"]
mod filters;

#[path = "virtual_gyro/extraction.rs"]
mod extraction;

#[path = "virtual_gyro/angles.rs"]
mod angles;

#[path = "virtual_gyro/table1.rs"]
mod table1;

#[path = "virtual_gyro/matrix.rs"]
mod matrix;

#[path = "virtual_gyro/table2.rs"]
mod table2;

#[path = "virtual_gyro/quaternion.rs"]
mod quaternion;

#[path = "virtual_gyro/velocity.rs"]
mod velocity;

#[path = "virtual_gyro/corners.rs"]
mod corners;

#[path = "virtual_gyro/recordings.rs"]
mod recordings;
