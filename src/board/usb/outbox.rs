//! What waits for the host: whole frames, one behind the other.

/// Bytes that may wait, a length for each frame among them. An INFO block with a verdict on the bias is twelve lines at
/// once. At the default rate it is a quarter of a second, so a host which comes back soon has missed little, and one
/// which comes back later gets little that is old.
const CAPACITY: usize = 1024;

/// The frames.
pub struct Outbox {
    bytes: [u8; CAPACITY],
    /// Where the first frame begins, and how many bytes there are from there on.
    start: usize,
    used: usize,
    /// How much of the first frame is gone.
    sent: usize,
}

impl Outbox {
    /// Nothing waits.
    pub const fn new() -> Outbox {
        Outbox {
            bytes: [0; CAPACITY],
            start: 0,
            used: 0,
            sent: 0,
        }
    }

    /// Whether nothing waits.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.used == 0
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        (self.used, self.sent) = (0, 0);
    }

    /// Takes a frame in, if there is room for it; false if not. An empty one is no frame.
    pub fn push(&mut self, frame: &[u8]) -> bool {
        let Ok(length @ 1..) = u8::try_from(frame.len()) else {
            return frame.is_empty();
        };
        if self.used + 1 + frame.len() > CAPACITY {
            return false;
        }
        for &byte in [length].iter().chain(frame) {
            let end = (self.start + self.used) % CAPACITY;
            self.bytes[end] = byte;
            self.used += 1;
        }
        true
    }

    /// Copies the next packet, of what is left of the first frame, and returns its length: 0 if nothing waits.
    pub fn peek(&self, packet: &mut [u8]) -> usize {
        if self.is_empty() {
            return 0;
        }
        let length = usize::from(self.bytes[self.start]);
        let places = self.start + 1 + self.sent..self.start + 1 + length;
        let mut count = 0;
        for (byte, place) in packet.iter_mut().zip(places) {
            *byte = self.bytes[place % CAPACITY];
            count += 1;
        }
        count
    }

    /// So many bytes of the first frame are gone.
    pub fn take(&mut self, count: usize) {
        if self.is_empty() {
            return;
        }
        let length = usize::from(self.bytes[self.start]);
        self.sent += count;
        if self.sent >= length {
            self.start = (self.start + 1 + length) % CAPACITY;
            self.used = self.used.saturating_sub(1 + length);
            self.sent = 0;
        }
    }

    /// Forgets the rest of a frame of which a part is gone.
    pub fn drop_begun(&mut self) {
        if self.sent > 0 {
            self.take(usize::MAX - self.sent);
        }
    }
}
