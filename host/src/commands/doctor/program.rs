//! Which program answers.

use super::check::Report;
use super::watch::Seen;

/// What this program was built with.
const OURS: &str = concat!("vrduino ", env!("CARGO_PKG_VERSION"));

/// Whether it is the tracker's; what else it may be.
pub fn look(seen: &Seen, report: &mut Report) -> bool {
    if let Some(version) = &seen.status.version {
        if version == OURS {
            report.good(format!("its program is {version}"));
        } else {
            report.doubt(
                format!("its program is {version}, this one is {OURS}"),
                "flash the one that belongs to this (`vrduino flash`) if something is odd",
            );
        }
        return true;
    }
    let begins = |words: &[&str]| {
        seen.lines
            .iter()
            .any(|line| words.iter().any(|word| line.starts_with(word)))
    };
    if begins(&["error: ", "vrduino "]) {
        // Without its sensor it answers nothing.
        report.good("its program is the tracker's");
        return true;
    }
    let flash = "if this is the board, put the tracker on it with `vrduino flash`; if not, `vrduino list` shows the other ports";
    if begins(&["QC ", "EA ", "GYR", "ACC", "FLAT "]) || seen.orientations > 0 {
        report.doubt(
            "its program sends the course's lines and answers no `:version`: the course's own firmware, or another that speaks like it",
            "what needs no answers works with it (view, serve, record)\nput the tracker on it with `vrduino flash`: it sends the same lines, and more",
        );
    } else if let Some(line) = seen.lines.iter().find(|line| !line.trim().is_empty()) {
        let line: String = line.chars().take(60).collect();
        report.bad(
            format!("nothing of the tracker's runs there; it says `{line}`"),
            flash,
        );
    } else if seen.bytes > 0 {
        report.bad(
            "what it sends is no text and no frame of the tracker's",
            flash,
        );
    } else {
        report.bad(
            "it says nothing and answers nothing",
            format!("unplug it and plug it in again; if that does not help: {flash}"),
        );
    }
    false
}
