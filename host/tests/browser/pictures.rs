//! The pictures of the page in the README, from the running program.

use std::path::Path;

use libtest_mimic::Failed;

use super::chromium::Chromium;
use super::moving::START;
use super::program::Program;
use super::tab::Size;

/// The page is large enough to read and the file small enough to keep.
const LARGEST: usize = 200_000;

pub fn for_the_readme(chromium: &Chromium) -> Result<(), Failed> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/pictures");
    let program = Program::start(&["--emulate"])?;
    for (name, size, theme, mode) in [
        ("page.png", Size::DESK, "dark", "board"),
        ("page-stereo.png", Size::DESK, "light", "stereo"),
        ("page-phone.png", Size::PHONE, "dark", "board"),
    ] {
        let mut tab = chromium.open_as(&program.url, size, "")?;
        tab.theme(theme)?;
        tab.eval(&format!("document.getElementById('view-{mode}').click()"))?;
        // The charts are full, and the head is turned.
        tab.until("ten seconds have come", "vrduino.count > 10500", START)?;
        tab.until(
            "the head is turned",
            "Math.abs(vrduino.angles[0]) > 15 && Math.abs(vrduino.angles[0]) < 35",
            60,
        )?;
        let bytes = tab.picture_in(&folder, name)?;
        if bytes > LARGEST {
            return Err(format!("{name} has {bytes} bytes").into());
        }
        tab.close()?;
    }
    Ok(())
}
