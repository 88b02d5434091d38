//! Firmware that nobody here wrote: sketches on PJRC's own Teensyduino core run unmodified and print what they print on
//! a board.

#[path = "vendor/bench.rs"]
mod bench;

#[path = "vendor/toolchain.rs"]
mod toolchain;

#[path = "vendor/bring_up.rs"]
mod bring_up;

#[path = "vendor/flash.rs"]
mod flash;

#[path = "vendor/sketches.rs"]
mod sketches;

use std::process::ExitCode;
use std::sync::Arc;

use libtest_mimic::{Arguments, Completion, Trial};

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
                let missing = missing.clone();
                Trial::ignorable_test(name, move || Ok(Completion::ignored_with(missing)))
            }
        })
        .collect();
    libtest_mimic::run(&arguments, trials).exit_code()
}
