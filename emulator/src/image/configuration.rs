//! The flash configuration field: sixteen bytes at 0x400 that decide whether the chip stays open.
//!
//! The chip reads them at every reset, before the first instruction (K20 Sub-Family Reference
//! Manual, "Flash configuration field" and the FSEC and FOPT registers of the FTFL chapter):
//!
//! | address | name | accepted here |
//! |---|---|---|
//! | 0x400 to 0x407 | backdoor comparison key | all 0xFF: none |
//! | 0x408 to 0x40B | FPROT, protected flash regions | all 0xFF: none |
//! | 0x40C | FSEC: KEYEN 7:6, MEEN 5:4, FSLACC 3:2, SEC 1:0 | SEC = 0b10 (unsecured), MEEN ≠ 0b10 (mass erase allowed) |
//! | 0x40D | FOPT: NMI_DIS 2, EZPORT_DIS 1, LPBOOT 0 | reserved bits 7:3 all ones |
//! | 0x40E | FEPROT, protected EEPROM regions | 0xFF: none |
//! | 0x40F | FDPROT, protected data flash regions | 0xFF: none |
//!
//! Erased flash reads 0xFF, and FSEC = 0xFF means *secured*: an image that says nothing here closes
//! the chip's debug port. So the field must be in the image.

use super::ImageError;
use super::flash::Flash;

/// Address of the field.
pub const ADDRESS: u32 = 0x400;

/// Length of the field (bytes).
pub const LENGTH: usize = 16;

/// Checks the field of an image.
pub(super) fn check(flash: &Flash) -> Result<(), ImageError> {
    let field = flash
        .bytes::<LENGTH>(ADDRESS)
        .ok_or(ImageError::NoConfiguration)?;
    let [key @ .., p0, p1, p2, p3, fsec, fopt, feprot, fdprot] = field;
    let key: [u8; 8] = key;

    if fsec & 0b11 != 0b10 {
        return Err(ImageError::Secured { fsec });
    }
    if fsec >> 4 & 0b11 == 0b10 {
        return Err(ImageError::MassEraseDisabled { fsec });
    }
    let odd = |name, found: &[u8], consequence| {
        Err(ImageError::Configuration {
            name,
            found: found.to_vec(),
            consequence,
        })
    };
    if key != [0xFF; 8] {
        return odd(
            "backdoor key",
            &key,
            "a key was not meant, so code or data was linked over the field",
        );
    }
    if [p0, p1, p2, p3] != [0xFF; 4] {
        return odd(
            "FPROT",
            &[p0, p1, p2, p3],
            "regions of the flash could not be programmed again",
        );
    }
    if fopt >> 3 != 0b1_1111 {
        return odd(
            "FOPT",
            &[fopt],
            "reserved bits are not ones, so code or data was linked over the field",
        );
    }
    if feprot != 0xFF {
        return odd(
            "FEPROT",
            &[feprot],
            "regions of the EEPROM could not be written",
        );
    }
    if fdprot != 0xFF {
        return odd(
            "FDPROT",
            &[fdprot],
            "regions of the data flash could not be programmed again",
        );
    }
    Ok(())
}
