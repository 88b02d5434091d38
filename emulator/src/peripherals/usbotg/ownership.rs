//! Whose buffers are whose: finds descriptors that the program changes while the controller owns them, and memory that
//! was given away twice.
//!
//! The program's stores to RAM are not seen one by one; the controller compares each descriptor with what it found there
//! the last time. Whenever the program may change descriptors whoever owns them (no token is processed), what was known
//! is forgotten.

use super::table::{Descriptor, Place};
use crate::witness::{Trap, Witness};

const PLACES: usize = 64;

/// What the controller knows of its descriptors.
#[derive(Debug, Clone)]
pub(super) struct Ownership {
    /// Descriptors that were the controller's when it last looked.
    owned: [Option<(Place, Descriptor)>; PLACES],
    /// Descriptors whose completed token STAT has not shown yet.
    untold: [bool; PLACES],
}

impl Default for Ownership {
    fn default() -> Ownership {
        Ownership {
            owned: [None; PLACES],
            untold: [false; PLACES],
        }
    }
}

impl Ownership {
    /// Nothing is known any more.
    pub fn forget(&mut self) {
        *self = Ownership::default();
    }

    /// Nothing is known any more of `endpoint`.
    pub fn forget_endpoint(&mut self, endpoint: u8) {
        let first = usize::from(endpoint) << 2;
        self.owned[first..first + 4].fill(None);
        self.untold[first..first + 4].fill(false);
    }

    /// The controller has given the descriptor back; its token waits in STAT.
    pub fn gave_back(&mut self, place: Place) {
        self.owned[place.index()] = None;
        self.untold[place.index()] = true;
    }

    /// STAT has shown the token, so the buffer is the program's to give again.
    pub fn told(&mut self, place: Place) {
        self.untold[place.index()] = false;
    }

    /// Compares the descriptor at `place` with what it was.
    pub fn look(&mut self, place: Place, found: Descriptor, witness: &mut Witness) {
        let known = &mut self.owned[place.index()];
        match *known {
            Some((_, before)) if !found.is_owned() => {
                witness.saw(
                    Trap::UsbDescriptorOwned,
                    format!(
                        "{place} was taken back while the controller owned it: {:#010x} became {:#010x}",
                        before.status, found.status
                    ),
                );
            }
            Some((_, before)) if before != found => {
                witness.saw(
                    Trap::UsbDescriptorOwned,
                    format!(
                        "{place} was changed while the controller owned it: {:#010x} at {:#010x} became {:#010x} at \
                         {:#010x}",
                        before.status, before.buffer, found.status, found.buffer
                    ),
                );
            }
            _ => {}
        }
        // One that stalls is not used up, and taking it back is how the stall ends.
        *known = (found.is_owned() && !found.stalls()).then_some((place, found));
        if found.is_owned() && std::mem::take(&mut self.untold[place.index()]) {
            witness.saw(
                Trap::UsbBufferTwice,
                format!(
                    "{place} was given to the controller again before STAT had shown the token that it completed"
                ),
            );
        }
    }

    /// Looks for memory that two owned descriptors could write, or one write and the other send. `exempt` are endpoints
    /// that may: isochronous ones lose nothing but a sample (Teensyduino's audio receives into one buffer).
    pub fn find_shared_buffers(&mut self, exempt: impl Fn(u8) -> bool, witness: &mut Witness) {
        let spans = |&(place, descriptor): &(Place, Descriptor)| {
            let from = u64::from(descriptor.buffer);
            (place, from, from + descriptor.count() as u64)
        };
        let mut owned: Vec<_> = self.owned.iter().flatten().map(spans).collect();
        owned.retain(|&(place, from, to)| to > from && !exempt(place.endpoint));
        for (n, &(first, from, to)) in owned.iter().enumerate() {
            let shared = owned[n + 1..].iter().find(|&&(second, start, end)| {
                !(first.transmit && second.transmit) && from < end && start < to
            });
            if let Some((second, start, _)) = shared {
                witness.saw(
                    Trap::UsbBufferTwice,
                    format!(
                        "the controller owns {first} at {from:#010x} and {second} at {start:#010x}, which overlap"
                    ),
                );
                // Once is enough.
                self.forget();
                return;
            }
        }
    }
}
