//! The memory that the USB controller shares with the program: two buffers for each direction of each
//! endpoint, and the buffer descriptor table that says whose they are (K20 manual, 43.3.4 and 43.3.5).
//!
//! A descriptor whose OWN bit is set belongs to the controller, which clears the bit when the
//! transaction is over.

use core::sync::atomic::{AtomicU32, Ordering};

/// Endpoint 0 and the three of a serial port.
pub const ENDPOINTS: usize = 4;
/// Largest packet of a bulk or control endpoint at full speed.
pub const PACKET: usize = 64;

/// Bits of a descriptor.
const OWN: u32 = 1 << 7;
const DATA1: u32 = 1 << 6;
const DTS: u32 = 1 << 3;

/// Token identifier of a SETUP, as the controller writes it back.
const SETUP: u32 = 0xD;

/// A buffer descriptor. Atomics, because the controller changes it behind the program's back.
pub struct Descriptor {
    status: AtomicU32,
    address: AtomicU32,
}

/// Indexed by endpoint, direction (1 is towards the host), bank. The controller takes the upper 23 bits
/// of its address only (43.3.4).
#[repr(C, align(512))]
struct Table([[[Descriptor; 2]; 2]; ENDPOINTS]);

static TABLE: Table = Table(
    [const {
        [const {
            [const {
                Descriptor {
                    status: AtomicU32::new(0),
                    address: AtomicU32::new(0),
                }
            }; 2]
        }; 2]
    }; ENDPOINTS],
);

/// In words, which are filled four times as fast as bytes.
struct Buffer([AtomicU32; PACKET / 4]);

static BUFFERS: [[[Buffer; 2]; 2]; ENDPOINTS] =
    [const { [const { [const { Buffer([const { AtomicU32::new(0) }; PACKET / 4]) }; 2] }; 2] };
        ENDPOINTS];

impl Descriptor {
    /// Gives the buffer to the controller: `length` bytes with toggle `data1`.
    pub fn give(&self, length: usize, data1: bool) {
        let toggle = if data1 { DATA1 } else { 0 };
        // Release: the buffer's bytes are in place before the controller may look at them.
        self.status.store(
            (length as u32) << 16 | OWN | toggle | DTS,
            Ordering::Release,
        );
    }

    /// Takes the buffer back; only while the controller is not at it.
    pub fn withdraw(&self) {
        self.status.store(0, Ordering::Release);
    }

    /// Whether the controller still has the buffer.
    pub fn is_given(&self) -> bool {
        self.status.load(Ordering::Acquire) & OWN != 0
    }

    /// Bytes that came in, or that were given.
    pub fn length(&self) -> usize {
        (self.status.load(Ordering::Acquire) >> 16 & 0x3FF) as usize
    }

    /// Whether the packet that came in is a SETUP.
    pub fn holds_setup(&self) -> bool {
        self.status.load(Ordering::Acquire) >> 2 & 0xF == SETUP
    }

    /// Changes the toggle of a buffer that was given.
    pub fn set_toggle(&self, data1: bool) {
        if self.is_given() {
            self.give(self.length(), data1);
        }
    }
}

/// The descriptor of `bank`; indices wrap, so none can be out of range.
pub fn descriptor(endpoint: usize, transmit: bool, bank: usize) -> &'static Descriptor {
    &TABLE.0[endpoint % ENDPOINTS][usize::from(transmit)][bank & 1]
}

fn words(endpoint: usize, transmit: bool, bank: usize) -> &'static [AtomicU32; PACKET / 4] {
    &BUFFERS[endpoint % ENDPOINTS][usize::from(transmit)][bank & 1].0
}

/// Puts a packet for the host into `bank`; what is longer than a packet is cut off.
#[inline(always)]
pub fn fill(endpoint: usize, bank: usize, data: &[u8]) {
    let places = words(endpoint, true, bank);
    let (whole, rest) = data.as_chunks::<4>();
    for (place, bytes) in places.iter().zip(whole) {
        place.store(u32::from_le_bytes(*bytes), Ordering::Relaxed);
    }
    if let Some(place) = places.get(whole.len()) {
        let last = rest
            .iter()
            .rfold(0, |word, &byte| word << 8 | u32::from(byte));
        place.store(last, Ordering::Relaxed);
    }
}

/// The bytes of a packet from the host, or what is behind it.
pub fn received(endpoint: usize, bank: usize) -> impl Iterator<Item = u8> {
    words(endpoint, false, bank)
        .iter()
        .flat_map(|word| word.load(Ordering::Relaxed).to_le_bytes())
}

/// Tells every descriptor where its buffer is; returns the table's address.
pub fn connect() -> u32 {
    for number in 0..ENDPOINTS {
        for (transmit, bank) in [(false, 0), (false, 1), (true, 0), (true, 1)] {
            let at = words(number, transmit, bank).as_ptr() as u32;
            descriptor(number, transmit, bank)
                .address
                .store(at, Ordering::Relaxed);
        }
    }
    &raw const TABLE as u32
}
