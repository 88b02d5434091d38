//! What an update of a filter costs on the chip: each is run in the emulator and counted, beside a reference in double
//! precision on the host.
//!
//! | module | does |
//! |---|---|
//! | `subject` | the filters that are counted, and how they are found |
//! | `count` | runs one on the emulated chip |
//! | `reference` | what it should have come to |
//! | `firmware` | runs the whole tracker, from the sensor to USB |
//! | `published` | figures of others that are not measured here |
//! | `table`, `json` | for people, for programs |
//!
//! Counts are exact: the same image gives the same again. Nothing is timed by a clock.

pub mod subject;

pub mod count;

pub mod reference;

pub mod firmware;

pub mod published;

pub mod table;

pub mod json;

/// The core's clock in MHz, which makes microseconds of cycles.
pub const CORE_MHZ: f64 = 72.0;
