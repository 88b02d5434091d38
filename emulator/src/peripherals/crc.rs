//! Cyclic redundancy check (K20 manual, chapter "Cyclic Redundancy Check (CRC)"): 16 and 32 bits, any polynomial, with
//! the transpositions.

const CRC: u32 = 0x0;
const GPOLY: u32 = 0x4;
const CTRL: u32 = 0x8;

const FXOR: u32 = 1 << 26;
const WAS: u32 = 1 << 25;
const TCRC: u32 = 1 << 24;

/// The generator.
#[derive(Debug, Clone)]
pub struct CrcGenerator {
    sum: u32,
    polynomial: u32,
    control: u32,
}

impl CrcGenerator {
    /// The state after reset.
    pub fn new() -> CrcGenerator {
        CrcGenerator {
            sum: 0xFFFF_FFFF,
            polynomial: 0x1021,
            control: 0,
        }
    }

    /// Reads `width` bytes.
    pub fn read(&self, offset: u32, width: u8) -> u32 {
        let word = match offset & !3 {
            CRC => self.result(),
            GPOLY => self.polynomial,
            CTRL => self.control,
            _ => 0,
        };
        let mask = u32::MAX >> (32 - 8 * u32::from(width.clamp(1, 4)));
        word >> (8 * (offset & 3)) & mask
    }

    fn result(&self) -> u32 {
        let complement = if self.control & FXOR == 0 {
            0
        } else if self.control & TCRC != 0 {
            u32::MAX
        } else {
            0xFFFF
        };
        transposed(self.sum ^ complement, 4, self.control >> 28 & 3)
    }

    /// Writes `width` bytes: to CRC a seed, or data of that width.
    pub fn write(&mut self, offset: u32, width: u8, value: u32) {
        let shift = 8 * (offset & 3);
        let mask = (u32::MAX >> (32 - 8 * u32::from(width.clamp(1, 4)))) << shift;
        let merged = |old: u32| old & !mask | value << shift & mask;
        match offset & !3 {
            CRC if self.control & WAS != 0 => self.sum = merged(self.sum),
            CRC => {
                let data = transposed(value, width, self.control >> 30 & 3);
                for bit in (0..8 * u32::from(width)).rev() {
                    self.shift(data >> bit & 1);
                }
            }
            GPOLY => self.polynomial = merged(self.polynomial),
            CTRL => self.control = merged(self.control),
            _ => {}
        }
    }

    fn shift(&mut self, bit: u32) {
        let (top, mask) = if self.control & TCRC != 0 {
            (31, u32::MAX)
        } else {
            (15, 0xFFFF)
        };
        let feedback = (self.sum >> top & 1) ^ bit;
        let polynomial = if feedback != 0 { self.polynomial } else { 0 };
        self.sum = (self.sum << 1 ^ polynomial) & mask | self.sum & !mask;
    }
}

/// Transposition types: 1 the bits in each byte, 2 bits and bytes, 3 bytes only.
fn transposed(value: u32, width: u8, kind: u32) -> u32 {
    let unused = 32 - 8 * u32::from(width);
    let bytes = value.swap_bytes() >> unused;
    match kind {
        1 => (value.reverse_bits() >> unused).swap_bytes() >> unused,
        2 => value.reverse_bits() >> unused,
        3 => bytes,
        _ => value,
    }
}

impl Default for CrcGenerator {
    fn default() -> CrcGenerator {
        CrcGenerator::new()
    }
}
