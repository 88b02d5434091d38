//! How the host and a device get to know each other: enumeration, and another attempt where it fails.

use super::bus::{Bus, Event};
use super::enumeration::{Enumeration, Next, Profile};
use super::transfer::{Outcome, Ticket, Transfer};
use crate::time::{MILLISECOND, Ticks};
use crate::witness::{Trap, Witness};

/// A PC tries again a few times; here after this time, as often as it takes.
const NEXT_ATTEMPT: Ticks = 500 * MILLISECOND;

/// Brings a device up to the address state, with all that it says about itself.
#[derive(Debug, Clone, Default)]
pub(super) struct Introduction {
    running: Option<(Enumeration, Option<Ticket>)>,
}

impl Introduction {
    /// Gives it up.
    pub fn stop(&mut self) {
        self.running = None;
    }

    /// Takes part in what happens on the bus; the profile once it is complete.
    pub fn handle(
        &mut self,
        event: &Event,
        now: Ticks,
        bus: &mut Bus,
        witness: &mut Witness,
    ) -> Option<Profile> {
        match event {
            Event::Attached => {
                self.running = Some((Enumeration::new(), None));
                bus.reset();
            }
            Event::Detached => self.running = None,
            Event::Reset => self.ask(bus),
            Event::Ended(ticket, outcome) => {
                let (_, asked) = self.running.as_ref()?;
                if *asked == Some(*ticket) {
                    return self.answered(outcome.clone(), now, bus, witness);
                }
            }
        }
        None
    }

    fn ask(&mut self, bus: &mut Bus) {
        if let Some((enumeration, asked)) = &mut self.running {
            let request = enumeration.request().map(Transfer::Control);
            *asked = request.map(|request| bus.submit(request));
        }
    }

    fn answered(
        &mut self,
        outcome: Outcome,
        now: Ticks,
        bus: &mut Bus,
        witness: &mut Witness,
    ) -> Option<Profile> {
        let (enumeration, asked) = self.running.as_mut()?;
        *asked = None;
        match enumeration.ended(outcome) {
            Ok(Next::Go) => self.ask(bus),
            Ok(Next::ResetBus) => bus.reset(),
            Ok(Next::Done) => return self.running.take().map(|(done, _)| done.found()),
            Err(why) => {
                witness.saw(Trap::UsbEnumeration, format!("enumeration failed: {why}"));
                self.running = None;
                bus.settle_again(now + NEXT_ATTEMPT);
            }
        }
        None
    }
}
