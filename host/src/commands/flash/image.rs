//! What is written, judged before it is.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use vrduino_emulator::firmware::{self, BuildOptions};
use vrduino_emulator::image::{FLASH_SIZE, Image};

use crate::failure::{Failure, Kind};

/// An image that was judged, as the loader takes it.
pub struct Prepared {
    /// The file that is written.
    pub hex: PathBuf,
    /// What it is and how large.
    pub summary: String,
}

/// Builds the firmware, or takes this file.
///
/// # Errors
///
/// It cannot be built or read, or it would not start, or it would lock the board.
pub fn prepare(file: Option<&Path>) -> Result<Prepared, Failure> {
    let named = match file {
        Some(file) => file.to_owned(),
        None => firmware::build(BuildOptions { quiet: false })
            .map_err(|error| Failure::new(Kind::Computer, error.to_string()))?,
    };
    let image = Image::open(&named).map_err(|error| {
        let sentence = format!("nothing was flashed: {error}");
        Failure::new(Kind::File, sentence)
    })?;
    let hex = if is_elf(&named) {
        convert(&image, &named, file.is_none())?
    } else {
        named
    };
    let used = image.flash_used();
    let percent = 100.0 * used as f64 / FLASH_SIZE as f64;
    let summary = format!(
        "{}, {used} bytes, {percent:.0} % of the flash",
        hex.display()
    );
    Ok(Prepared { hex, summary })
}

fn is_elf(path: &Path) -> bool {
    let mut magic = [0; 4];
    fs::File::open(path)
        .and_then(|mut file| file.read_exact(&mut magic))
        .is_ok_and(|()| magic == *b"\x7fELF")
}

/// Our own goes where `cargo image` puts it; any other into a folder where nobody keeps what is his, which
/// the file beside the ELF may be.
fn convert(image: &Image, elf: &Path, is_ours: bool) -> Result<PathBuf, Failure> {
    let target =
        firmware::target_dir().map_err(|error| Failure::new(Kind::Computer, error.to_string()))?;
    let folder = if is_ours {
        target
    } else {
        target.join("flash")
    };
    let name = Path::new(elf.file_stem().unwrap_or("vrduino".as_ref()));
    let hex = folder.join(name).with_added_extension("hex");
    // Whoever reads it meanwhile, as another that flashes, finds all of one image.
    let begun = hex.with_added_extension(std::process::id().to_string());
    let written = fs::create_dir_all(&folder)
        .and_then(|()| fs::write(&begun, image.to_hex()))
        .and_then(|()| fs::rename(&begun, &hex))
        .inspect_err(|_| drop(fs::remove_file(&begun)));
    written.map_err(|error| {
        let sentence = format!(
            "{} cannot be written: {error}; is the disk full?",
            hex.display()
        );
        Failure::new(Kind::File, sentence)
    })?;
    Ok(hex)
}
