//! Miscellaneous control module (K20 manual, chapter MCM): how the crossbar and the SRAM's arbiter are set up. Nothing
//! here is arbitrated, so the settings only keep their values.

const PLASC: u32 = 0x08;
const PLAMC: u32 = 0x0A;
const CR: u32 = 0x0C;

/// The module's registers.
#[derive(Debug, Clone, Default)]
pub struct MiscellaneousControl {
    control: u32,
}

impl MiscellaneousControl {
    /// Reads `width` bytes. Which masters and slaves the crossbar has is not modelled: its two registers read as all.
    pub fn read(&self, offset: u32, width: u8) -> u32 {
        let word = match offset & !3 {
            PLASC => 0xFF_00FF,
            CR => self.control,
            _ => 0,
        };
        let unused = 32 - 8 * u32::from(width.clamp(1, 4));
        word >> (8 * (offset & 3)) & u32::MAX >> unused
    }

    /// Writes the control register; the others can only be read.
    pub fn write(&mut self, offset: u32, value: u32) {
        if offset == CR {
            self.control = value;
        }
    }
}

const _: () = assert!(PLAMC == PLASC + 2, "both stand in one word");
