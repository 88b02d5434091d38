//! Firmware that nobody here wrote: sketches on PJRC's own Teensyduino core run unmodified and print what they print on
//! a board.

#[path = "vendor/bench.rs"]
mod bench;

#[path = "vendor/toolchain.rs"]
mod toolchain;

#[path = "vendor/flash.rs"]
mod flash;

#[path = "vendor/sketches.rs"]
mod sketches;

use std::process::ExitCode;
use std::sync::Arc;

use libtest_mimic::{Arguments, Trial};

use bench::Bench;
use toolchain::Toolchain;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let toolchain = Toolchain::find().map(Arc::new);
    let trials = sketches::ALL
        .iter()
        .map(|&(name, sketch, f_cpu, test)| match &toolchain {
            Ok(toolchain) => {
                let toolchain = Arc::clone(toolchain);
                Trial::test(name, move || {
                    test(&mut Bench::new(&toolchain.build(sketch, f_cpu)));
                    Ok(())
                })
            }
            Err(missing) => {
                // Asked for all the same (`--ignored`), it fails: a test that did not run has not passed.
                let failure = missing.clone();
                Trial::test(name, move || Err(failure.into()))
                    .with_kind(missing.clone())
                    .with_ignored_flag(true)
            }
        })
        .collect();
    libtest_mimic::run(&arguments, trials).exit_code()
}
