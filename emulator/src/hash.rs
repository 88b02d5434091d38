//! A hash that is the same on every machine and with every compiler: FNV-1a with 64 bits (Fowler, Noll, Vo).
//!
//! It tells whether two runs are the same; it is no protection against somebody who wants it to be equal.

use std::fmt;

/// Takes in bytes, or text by way of `write!`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fnv1a(u64);

impl Fnv1a {
    /// Nothing taken in yet.
    pub const fn new() -> Fnv1a {
        Fnv1a(0xCBF2_9CE4_8422_2325)
    }

    /// The hash of `bytes` alone.
    pub fn of(bytes: &[u8]) -> u64 {
        let mut hash = Fnv1a::new();
        hash.bytes(bytes);
        hash.value()
    }

    /// Takes in bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3);
        }
    }

    /// The hash of all that was taken in.
    pub const fn value(self) -> u64 {
        self.0
    }
}

impl Default for Fnv1a {
    fn default() -> Fnv1a {
        Fnv1a::new()
    }
}

impl fmt::Write for Fnv1a {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.bytes(text.as_bytes());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::Fnv1a;

    /// The published test vectors (http://www.isthe.com/chongo/tech/comp/fnv/).
    #[test]
    fn known_texts_have_their_published_hashes() {
        assert_eq!(Fnv1a::of(b""), 0xCBF2_9CE4_8422_2325);
        assert_eq!(Fnv1a::of(b"a"), 0xAF63_DC4C_8601_EC8C);
        assert_eq!(Fnv1a::of(b"foobar"), 0x8594_4171_F739_67E8);
    }
}
