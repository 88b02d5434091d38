//! What is known of each endpoint: its banks, its toggles, and whether it is stalled.

use super::buffers::{ENDPOINTS, descriptor};

/// One endpoint towards the host.
#[derive(Clone, Copy, Default)]
pub struct Transmit {
    pub size: usize,
    pub bank: usize,
    pub data1: bool,
    pub busy: bool,
    pub stalled: bool,
}

/// One endpoint from the host.
#[derive(Clone, Copy, Default)]
pub struct Receive {
    pub size: usize,
    /// The bank that is read next.
    pub bank: usize,
    /// How many banks hold a packet.
    pub filled: u8,
    /// The toggle each bank is given with: neighbours differ.
    pub data1: [bool; 2],
    pub stalled: bool,
}

#[derive(Clone, Copy, Default)]
pub struct Endpoints {
    pub transmit: [Transmit; ENDPOINTS],
    pub receive: [Receive; ENDPOINTS],
}

impl Endpoints {
    /// Makes the next packet of a data endpoint DATA0, in both directions.
    pub fn restart_toggles(&mut self, number: usize) {
        let transmit = &mut self.transmit[number];
        transmit.data1 = false;
        descriptor(number, true, transmit.bank).set_toggle(false);
        let receive = &mut self.receive[number];
        let next = (receive.bank + usize::from(receive.filled)) & 1;
        receive.data1[next] = false;
        receive.data1[next ^ 1] = true;
        for bank in [0, 1] {
            descriptor(number, false, bank).set_toggle(receive.data1[bank]);
        }
    }
}
