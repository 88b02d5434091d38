//! The device handed out to another host: this one only brings it up, and then carries that host's transfers.

use super::bus::{Bus, Event};
use super::enumeration::ADDRESS;
use super::transfer::{Outcome, Request, Ticket, Transfer};

/// How far the device is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Handover {
    /// Not there, or not known yet.
    Absent,
    /// Known, and suspended until somebody takes it.
    Offered,
    /// On its way to its new host: reset, then an address.
    Preparing,
    /// In the other host's hands.
    Taken,
}

/// The device's state and what its new host has to be told.
#[derive(Debug, Clone)]
pub(super) struct Export {
    pub handover: Handover,
    set_address: Option<Ticket>,
    ended: Vec<(Ticket, Outcome)>,
}

impl Export {
    /// Nothing to hand out yet.
    pub fn new() -> Export {
        Export {
            handover: Handover::Absent,
            set_address: None,
            ended: Vec::new(),
        }
    }

    /// The device is known; until it is taken the bus stays silent.
    pub fn offer(&mut self, bus: &mut Bus) {
        self.handover = Handover::Offered;
        bus.set_suspended(true);
    }

    /// Prepares the device for another host; whether there is one to give.
    pub fn take(&mut self, bus: &mut Bus) -> bool {
        let offered = self.handover == Handover::Offered;
        if offered {
            self.handover = Handover::Preparing;
            bus.reset();
        }
        offered
    }

    /// The other host has let go: the port is switched off, and whatever was pending is void.
    pub fn put_back(&mut self, bus: &mut Bus) {
        if matches!(self.handover, Handover::Preparing | Handover::Taken) {
            self.handover = Handover::Offered;
            self.ended.clear();
            bus.give_up_transfers();
            bus.set_suspended(true);
        }
    }

    /// Takes what has ended since the last call.
    pub fn take_ended(&mut self) -> Vec<(Ticket, Outcome)> {
        std::mem::take(&mut self.ended)
    }

    /// Takes part in what happens on the bus.
    pub fn handle(&mut self, event: Event, bus: &mut Bus) {
        match (event, self.handover) {
            (Event::Detached, _) => *self = Export::new(),
            (Event::Reset, Handover::Preparing) => {
                let request = Request::write(0x00, 5, u16::from(ADDRESS), 0, &[]);
                self.set_address = Some(bus.submit(Transfer::Control(request)));
            }
            (Event::Ended(ticket, outcome), Handover::Preparing)
                if self.set_address == Some(ticket) =>
            {
                self.handover = match outcome {
                    Outcome::Done(_) => Handover::Taken,
                    _ => Handover::Offered,
                };
            }
            (Event::Ended(ticket, outcome), Handover::Taken) => self.ended.push((ticket, outcome)),
            _ => {}
        }
    }
}
