//! 12-bit digital-to-analog converter (K20 manual, chapter "12-bit Digital-to-Analog Converter (DAC)") without its
//! sixteen-word buffer: the first word is what comes out.

/// C0.
const C0: u32 = 0x21;
const DACEN: u8 = 1 << 7;
const DACRFS: u8 = 1 << 6;
const SR: u32 = 0x20;
const C2: u32 = 0x23;

/// The converter.
#[derive(Debug, Clone)]
pub struct Dac {
    registers: [u8; 0x24],
}

impl Dac {
    /// The state after reset.
    pub fn new() -> Dac {
        let mut registers = [0; 0x24];
        registers[SR as usize] = 0x02;
        registers[C2 as usize] = 0x0F;
        Dac { registers }
    }

    /// What comes out, as a fraction of the reference; and whether that is VDDA rather than the 1.2 V one.
    pub fn output(&self) -> Option<(f64, bool)> {
        let control = self.registers[C0 as usize];
        let code = u16::from_le_bytes([self.registers[0], self.registers[1] & 0xF]);
        (control & DACEN != 0).then_some(((f64::from(code) + 1.0) / 4096.0, control & DACRFS != 0))
    }

    /// Reads `width` bytes.
    pub fn read(&self, offset: u32, width: u8) -> u32 {
        let byte = |at: u32| u32::from(self.registers.get(at as usize).copied().unwrap_or(0));
        (0..u32::from(width))
            .map(|i| byte(offset + i) << (8 * i))
            .sum()
    }

    /// Writes `width` bytes.
    pub fn write(&mut self, offset: u32, width: u8, value: u32) {
        for (at, byte) in (offset..).zip(&value.to_le_bytes()[..usize::from(width.min(4))]) {
            if let Some(register) = self.registers.get_mut(at as usize).filter(|_| at != SR) {
                *register = *byte;
            }
        }
    }
}

impl Default for Dac {
    fn default() -> Dac {
        Dac::new()
    }
}
