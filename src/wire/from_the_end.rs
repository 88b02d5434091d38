//! Text made from its end to its beginning: the order in which the digits of a number come.

/// At most `N` bytes of ASCII. What finds no more room in front is left out.
#[derive(Clone, Debug)]
pub struct FromTheEnd<const N: usize> {
    bytes: [u8; N],
    start: usize,
}

impl<const N: usize> FromTheEnd<N> {
    /// No text.
    pub fn new() -> Self {
        Self {
            bytes: [b' '; N],
            start: N,
        }
    }

    /// So far.
    pub fn text(&self) -> &[u8] {
        self.bytes.get(self.start..).unwrap_or_default()
    }

    /// One byte in front.
    #[inline(always)]
    pub fn put(&mut self, byte: u8) {
        let front = self.start.wrapping_sub(1);
        if let Some(place) = self.bytes.get_mut(front) {
            *place = byte;
            self.start = front;
        }
    }

    /// The last digit of a number in front; returns the others.
    #[inline(always)]
    fn put_last_digit(&mut self, value: u32) -> u32 {
        self.put(b'0' + (value % 10) as u8);
        value / 10
    }

    /// A number in front.
    #[inline(never)] // there are several in each line
    pub fn put_number(&mut self, value: u32) {
        let mut rest = self.put_last_digit(value);
        while rest > 0 {
            rest = self.put_last_digit(rest);
        }
    }

    /// A number with 30 fraction bits in front, rounded to so many decimals, at most 9: to the nearest,
    /// exactly, halves away from zero. Zero has no sign.
    #[inline(never)] // the same
    pub fn put_q30(&mut self, bits: i32, decimals: u32) {
        let decimals = decimals.min(9);
        // 32 bits times 30 bits, and half a step of the last decimal; steps have 31 bits.
        let product = u64::from(bits.unsigned_abs()) * u64::from(10_u32.pow(decimals));
        let steps = ((product + (1 << 29)) >> 30) as u32;
        let mut whole = steps;
        for _ in 0..decimals {
            whole = self.put_last_digit(whole);
        }
        self.put(b'.');
        self.put_number(whole);
        if bits < 0 && steps > 0 {
            self.put(b'-');
        }
    }
}
