//! One host's import: its transfers by sequence number, from SUBMIT to RET_SUBMIT or UNLINK.

use std::collections::{BTreeMap, BTreeSet};

use super::protocol::{self, CONGESTED, Command, Malformed, Submit};
use crate::host::{Failure, Host, Outcome, Request, Ticket, Transfer};

/// The statuses of a transfer, as Linux numbers its errors.
mod status {
    pub const OK: i32 = 0;
    pub const ENOENT: i32 = -2;
    pub const EINVAL: i32 = -22;
    pub const EPIPE: i32 = -32;
    pub const ETIME: i32 = -62;
    pub const EPROTO: i32 = -71;
    pub const EOVERFLOW: i32 = -75;
    pub const ECONNRESET: i32 = -104;
    pub const ESHUTDOWN: i32 = -108;
    pub const EREMOTEIO: i32 = -121;
}

/// Transfers that may be pending at once; cdc_acm has some thirty.
const PENDING: usize = 1024;
/// Sequence numbers that are remembered after their transfer has ended.
const REMEMBERED: usize = 4096;

/// A transfer that has no answer yet.
#[derive(Debug, Clone)]
struct Pending {
    number: u32,
    is_in: bool,
    /// Bytes asked for or sent.
    length: usize,
    short_not_ok: bool,
}

/// The import.
#[derive(Debug, Clone, Default)]
pub(super) struct Session {
    pending: BTreeMap<Ticket, Pending>,
    /// Numbers whose transfer was answered.
    answered: BTreeSet<u32>,
    /// Numbers that were unlinked before they came.
    refused: BTreeSet<u32>,
}

impl Session {
    /// Answers what has ended, and carries out what was received, as long as the other side reads its answers.
    pub fn go_on(
        &mut self,
        received: &mut Vec<u8>,
        to_send: &mut Vec<u8>,
        host: &mut Host,
    ) -> Result<(), Malformed> {
        to_send.extend(self.answer(host.take_ended()));
        while to_send.len() < CONGESTED {
            let Some(command) = protocol::take_command(received)? else {
                break;
            };
            to_send.extend(self.command(command, host)?);
        }
        Ok(())
    }

    /// Carries `command` out; returns what is to be sent at once.
    fn command(&mut self, command: Command, host: &mut Host) -> Result<Vec<u8>, Malformed> {
        match command {
            Command::Submit(submit) => self.submit(submit, host),
            Command::Unlink { number, victim } => {
                let status = self.unlink(victim, host)?;
                Ok(protocol::unlinked(number, status))
            }
        }
    }

    fn submit(&mut self, submit: Submit, host: &mut Host) -> Result<Vec<u8>, Malformed> {
        if self.refused.remove(&submit.number) {
            // Its unlinking was answered already; an answer to this would be one too many.
            return Ok(Vec::new());
        }
        if self.pending.len() >= PENDING {
            return Err(Malformed(format!("more than {PENDING} transfers at once")));
        }
        if self.ticket(submit.number).is_some() {
            return Err(Malformed(format!(
                "a second transfer with number {}",
                submit.number
            )));
        }
        let pending = Pending {
            number: submit.number,
            is_in: submit.is_in,
            length: submit.length,
            short_not_ok: submit.short_not_ok,
        };
        let Some(transfer) = transfer(submit) else {
            self.remember(pending.number);
            return Ok(protocol::submitted(pending.number, status::EINVAL, 0, &[]));
        };
        self.pending.insert(host.submit(transfer), pending);
        Ok(Vec::new())
    }

    fn ticket(&self, number: u32) -> Option<Ticket> {
        self.pending
            .iter()
            .find_map(|(&ticket, pending)| (pending.number == number).then_some(ticket))
    }

    /// Gives the transfer `victim` up; returns the status to answer with.
    fn unlink(&mut self, victim: u32, host: &mut Host) -> Result<i32, Malformed> {
        if let Some(ticket) = self.ticket(victim) {
            self.pending.remove(&ticket);
            // One that has ended by now is given up all the same: its RET_SUBMIT has not been sent.
            host.cancel(ticket);
            self.remember(victim);
            return Ok(status::ECONNRESET);
        }
        let forgotten = self.answered.len() >= REMEMBERED
            && self.answered.first().is_some_and(|&oldest| victim < oldest);
        if forgotten || self.answered.contains(&victim) {
            return Ok(status::OK);
        }
        // Linux can send an UNLINK before the SUBMIT that it is for.
        if self.refused.len() >= PENDING {
            return Err(Malformed(format!(
                "more than {PENDING} transfers unlinked that never came"
            )));
        }
        self.refused.insert(victim);
        Ok(status::ECONNRESET)
    }

    /// Answers the transfers that have ended.
    fn answer(&mut self, ended: Vec<(Ticket, Outcome)>) -> Vec<u8> {
        let mut replies = Vec::new();
        for (ticket, outcome) in ended {
            if let Some(pending) = self.pending.remove(&ticket) {
                self.remember(pending.number);
                replies.extend(pending.reply(outcome));
            }
        }
        replies
    }

    fn remember(&mut self, number: u32) {
        self.answered.insert(number);
        if self.answered.len() > REMEMBERED {
            self.answered.pop_first();
        }
    }
}

impl Pending {
    fn reply(&self, outcome: Outcome) -> Vec<u8> {
        let (status, data) = match outcome {
            Outcome::Done(_) if !self.is_in => {
                return protocol::submitted(self.number, status::OK, self.length, &[]);
            }
            Outcome::Done(data) if self.short_not_ok && data.len() < self.length => {
                (status::EREMOTEIO, data)
            }
            Outcome::Done(data) => (status::OK, data),
            Outcome::Stalled => (status::EPIPE, Vec::new()),
            Outcome::Failed(why) => (status_of(why), Vec::new()),
        };
        protocol::submitted(self.number, status, data.len(), &data)
    }
}

fn status_of(failure: Failure) -> i32 {
    match failure {
        Failure::NoAnswer | Failure::OutOfPlace => status::EPROTO,
        Failure::NotReady => status::ETIME,
        Failure::TooMuch => status::EOVERFLOW,
        Failure::NoEndpoint => status::ENOENT,
        Failure::Gone => status::ESHUTDOWN,
    }
}

/// The transfer as the bus takes it; `None` if it cannot be one. Isochronous ones are not taken.
fn transfer(submit: Submit) -> Option<Transfer> {
    let (number, length) = (submit.endpoint, submit.length);
    if submit.isochronous {
        return None;
    }
    if number > 0 {
        return Some(if submit.is_in {
            Transfer::In { number, length }
        } else {
            Transfer::Out {
                number,
                data: submit.data,
                closed: submit.zero_packet,
            }
        });
    }
    let request = Request {
        setup: submit.setup,
        data: submit.data,
    };
    // The data stage is as long as wLength says, and goes where bmRequestType says.
    let fits = match request.length() {
        0 => length == 0,
        stage => stage == length && request.reads() == submit.is_in,
    };
    fits.then_some(Transfer::Control(request))
}
