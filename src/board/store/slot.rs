//! One of the places a record is kept in, with what tells whether it is whole.
//!
//! Little-endian:
//!
//! | offset | bytes | what |
//! |---|---|---|
//! | 0 | 4 | CRC-32 (as in Ethernet and ZIP) of all that follows, to the end of the content |
//! | 4 | 4 | number: the higher, the newer |
//! | 8 | 4 | length of the content |
//! | 12 | up to 244 | the content |

use vrduino::calibration::record::crc32;

/// Bytes of a slot.
pub const LENGTH: usize = 256;
/// Bytes that fit into one.
pub const CAPACITY: usize = LENGTH - HEADER;

const HEADER: usize = 12;
const WORDS: usize = LENGTH / 4;

/// What is, or shall be, in a slot.
pub struct Slot([u8; LENGTH]);

impl Slot {
    /// A slot with `content`, as far as it fits.
    pub fn new(number: u32, content: &[u8]) -> Slot {
        let mut bytes = [0; LENGTH];
        let length = content.len().min(CAPACITY);
        bytes[4..8].copy_from_slice(&number.to_le_bytes());
        bytes[8..12].copy_from_slice(&(length as u32).to_le_bytes());
        bytes[HEADER..HEADER + length].copy_from_slice(&content[..length]);
        let checksum = crc32(&bytes[4..HEADER + length]);
        bytes[..4].copy_from_slice(&checksum.to_le_bytes());
        Slot(bytes)
    }

    /// The slot whose `n`-th word `word` tells.
    pub fn read(word: impl Fn(usize) -> u32) -> Slot {
        let mut bytes = [0; LENGTH];
        for (n, four) in bytes.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            *four = word(n).to_le_bytes();
        }
        Slot(bytes)
    }

    /// The `n`-th word.
    pub fn word(&self, n: usize) -> u32 {
        let bytes = self.0.as_chunks::<4>().0;
        u32::from_le_bytes(bytes[n % WORDS])
    }

    /// How many words there are something in.
    pub fn words(&self) -> usize {
        (HEADER + self.content().map_or(0, <[u8]>::len)).div_ceil(4)
    }

    /// Its number, if it is whole.
    pub fn number(&self) -> Option<u32> {
        self.content().map(|_| self.word(1))
    }

    /// The content, if it is whole.
    pub fn content(&self) -> Option<&[u8]> {
        let end = HEADER
            + usize::try_from(self.word(2))
                .ok()
                .filter(|&n| n <= CAPACITY)?;
        (crc32(&self.0[4..end]) == self.word(0)).then_some(&self.0[HEADER..end])
    }

    /// Whether nothing was ever written here.
    pub fn is_blank(&self) -> bool {
        self.0.iter().all(|&byte| byte == 0xFF)
    }
}
