//! Ctrl-C: what is going on is brought to an end, not cut off.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

/// The exit code of a program that a signal has ended (128 + SIGINT).
const CUT_OFF: i32 = 130;

/// Some programs signal the process and its group, which is once for the user.
const ONCE: Duration = Duration::from_millis(500);

/// Whether the user wants it to end. The default is one that never comes.
#[derive(Clone, Debug, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// From now on Ctrl-C, and being asked to end by the system, are noticed here. Once in a program.
    /// Asked again, it ends at once.
    pub fn listen() -> Self {
        let flag = Arc::new(AtomicBool::new(false));
        let handler = Arc::clone(&flag);
        let first = OnceLock::new();
        // Where it cannot be noticed it ends the program, as usual.
        let _ = ctrlc::set_handler(move || {
            handler.store(true, Ordering::Relaxed);
            if first.get_or_init(Instant::now).elapsed() > ONCE {
                give_terminal_back();
                process::exit(CUT_OFF);
            }
        });
        Self(flag)
    }

    /// Whether it has come.
    pub fn has_come(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// As it was before keys came one by one.
fn give_terminal_back() {
    #[cfg(feature = "tui")]
    if ratatui::crossterm::terminal::is_raw_mode_enabled().is_ok_and(|is_raw| is_raw) {
        ratatui::restore();
    }
}
