//! Events of the controller that come in every frame and that `usb-device` has no use for.

use core::sync::atomic::Ordering;

use super::bus::{AWAKE, Bus, TO_HOST, flag, registers};

impl Bus {
    /// Interrupts at the start of every frame, or no longer.
    pub fn follow_frames(&self, on: bool) {
        self.frames.store(on, Ordering::Relaxed);
        // A suspended bus has no frames; it is told when it wakes up.
        if registers().inten().read().bits() & flag::TOKEN != 0 {
            self.interrupts(self.awake());
        }
    }

    /// Whether a frame has begun, on a bus in use whose frames are followed.
    #[inline(always)]
    pub fn take_frame(&self) -> bool {
        if !self.frames.load(Ordering::Relaxed) {
            return false;
        }
        let enabled = registers().inten().read().bits();
        let flags = registers().istat().read().bits();
        let begun = enabled & flag::TOKEN != 0 && flags & flag::START_OF_FRAME != 0;
        if begun {
            self.clear(flag::START_OF_FRAME);
        }
        begun
    }

    /// Whether nothing has happened.
    pub fn is_quiet(&self) -> bool {
        registers().istat().read().bits() & (AWAKE | flag::RESUME) == 0
    }

    /// Whether nothing has happened but that a packet of a data endpoint has gone to the host, which then is taken
    /// note of.
    #[inline(always)]
    pub fn take_sent(&self) -> bool {
        let flags = registers().istat().read().bits();
        if flags & (AWAKE | flag::RESUME) != flag::TOKEN {
            return false;
        }
        let status = registers().stat().read().bits();
        let data_endpoint = usize::from(status >> 4) != 0;
        if !data_endpoint || status & TO_HOST == 0 {
            return false;
        }
        self.sent(status);
        self.clear(flag::TOKEN);
        true
    }

    /// The packet that STAT shows has gone to the host.
    pub(super) fn sent(&self, status: u8) {
        let (number, bank) = (usize::from(status >> 4), usize::from(status >> 2 & 1));
        self.with(|state| {
            if let Some(endpoint) = state.transmit.get_mut(number) {
                endpoint.busy = false;
                endpoint.data1 = !endpoint.data1;
                endpoint.bank = bank ^ 1;
            }
        });
    }
}
