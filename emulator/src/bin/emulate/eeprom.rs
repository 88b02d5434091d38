//! The EEPROM's contents in a file, from one run to the next.

use std::fs;
use std::io;
use std::path::Path;

use vrduino_emulator::board::setup::Eeprom;

use super::Error;

/// What the file holds; where there is none yet, the chip was never partitioned.
pub fn read(path: &Path) -> Result<Eeprom, Error> {
    match fs::read(path) {
        Ok(bytes) => {
            Eeprom::new(bytes).map_err(|error| format!("{}: {error}", path.display()).into())
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Eeprom::default()),
        Err(error) => Err(format!("{} cannot be read: {error}", path.display()).into()),
    }
}

/// Writes the contents down.
pub fn write(path: &Path, eeprom: &Eeprom) -> Result<(), Error> {
    fs::write(path, eeprom.bytes())
        .map_err(|error| format!("{} cannot be written: {error}", path.display()).into())
}
