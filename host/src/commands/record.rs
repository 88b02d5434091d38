//! `vrduino record`.

use clap::Args;

use crate::cli::SourceArguments;
use crate::failure::{Failure, Kind};

/// What is asked for.
#[derive(Clone, Debug, Args)]
pub struct Arguments {
    /// Where from.
    #[command(flatten)]
    pub source: SourceArguments,
}

/// Does it.
///
/// # Errors
///
/// What keeps it from being done.
pub fn run(_arguments: &Arguments) -> Result<(), Failure> {
    Err(Failure::new(Kind::Computer, "not written yet"))
}
