//! A stock Linux kernel as the board's host: Debian's, unchanged, in an emulated PC without KVM. It attaches the
//! emulated device over USB/IP and uses it; `linux/init.sh` is what the guest does.
//!
//! Needs qemu-system-x86_64, a static busybox, and a kernel with its modules (Debian: `apt install qemu-system-x86
//! busybox-static linux-image-amd64`); without them the tests show as ignored, with the reason. The guest's console is
//! kept as `linux-console.txt` in cargo's temporary directory for tests (`target/tmp`).

#[path = "linux/archive.rs"]
mod archive;

#[path = "linux/guest.rs"]
mod guest;

#[path = "linux/run.rs"]
mod run;

use std::sync::OnceLock;

use libtest_mimic::{Arguments, Completion, Failed, Trial};

use guest::Guest;

/// What `init.sh` checks, in its words.
const CHECKS: [&str; 11] = [
    "the kernel attaches the board and cdc_acm binds to it",
    "the kernel reads identity and strings",
    "the stream arrives",
    "each opening is seen through DTR, and answered with a banner",
    "line codings are accepted",
    "keys reach the board under traffic",
    "the port opens and closes under traffic",
    "the board can be detached",
    "and attached once more",
    "and unplugged and replugged while it streams",
    "the kernel finds nothing to object to",
];

/// The guest's console, or why there is none. The guest is booted once, by whichever check comes first.
fn console(guest: &Guest) -> &'static Result<String, String> {
    static CONSOLE: OnceLock<Result<String, String>> = OnceLock::new();
    CONSOLE.get_or_init(|| run::console_of(guest))
}

fn run(check: &str) -> Result<Completion, Failed> {
    let guest = match Guest::find() {
        Ok(guest) => guest,
        Err(missing) => return Ok(Completion::ignored_with(missing)),
    };
    let console = console(&guest).as_ref()?;
    if console.contains(&format!("CHECK ok {check}")) {
        Ok(Completion::Completed)
    } else {
        Err(console.into())
    }
}

fn main() {
    let mut arguments = Arguments::from_args();
    // All checks wait for the same guest.
    arguments.test_threads = Some(1);
    let trials = CHECKS
        .iter()
        .map(|&check| Trial::ignorable_test(check, move || run(check)))
        .collect();
    libtest_mimic::run(&arguments, trials).exit();
}
