//! The magnetometer measures every 10 ms by its own clock, and the board asks by another. So it is
//! asked for its status alone (one byte, 0.1 ms of the bus) from the time on when it may be ready,
//! once a sample, and for the measurement with the sample after it has said that it is.
//!
//! Most bursts of the IMU are followed by nothing, one in ten by a measurement, and about one or two
//! by a question. A measurement is up to 3 ms old when the next sample brings it, beside the 7 ms
//! that it takes; it would be overwritten after 10.

use crate::sensor::magnetometer::{self, RawField};
use core::fmt;

/// ST1 (0x02): the first register of either request.
pub const START: u8 = 0x02;

/// The longest answer: ST1, and HXL to ST2. ST2 must be among what is read, or the magnetometer
/// holds its data for ever.
pub const ANSWER_LEN: usize = 1 + magnetometer::BURST_LEN;

/// Samples from one measurement to the first question for the next. Two to come, so the magnetometer
/// may be a tenth too fast.
const PAUSE: u8 = 8;

/// Samples without a measurement after which it is given up: half a second.
pub const GIVEN_UP_AFTER: u16 = 500;

/// DRDY in ST1: there is a measurement that was not yet read.
const READY: u8 = 1 << 0;
/// DOR in ST1: the one before was never read.
const OVERRUN: u8 = 1 << 1;

/// What to ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// ST1 alone, which touches no data.
    Status,
    /// ST1 to ST2.
    Measurement,
}

impl Request {
    /// How many bytes to read from [`START`] on.
    pub const fn length(self) -> usize {
        match self {
            Self::Status => 1,
            Self::Measurement => ANSWER_LEN,
        }
    }
}

/// A measurement that is new.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Measured {
    /// What it says.
    pub field: RawField,
    /// Others before it were overwritten unread.
    pub overrun: bool,
}

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// It acknowledges no longer.
    Silent,
    /// It answers, and has nothing new.
    Frozen,
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Silent => "stopped answering",
            Self::Frozen => "no new measurements",
        })
    }
}

/// Decides what to ask with each sample.
#[derive(Clone, Debug)]
pub struct Polling {
    request: Request,
    /// Samples until the request.
    pause: u8,
    /// Samples since the last measurement.
    without: u16,
    /// The last request was not answered.
    refused: bool,
}

impl Polling {
    /// For a magnetometer that begins to measure.
    pub fn new() -> Self {
        Self {
            request: Request::Status,
            pause: 0,
            without: 0,
            refused: false,
        }
    }

    /// To be called once a sample: what to ask for behind it.
    pub fn sample(&mut self) -> Option<Request> {
        if self.without >= GIVEN_UP_AFTER {
            return None;
        }
        self.without += 1;
        self.pause = self.pause.saturating_sub(1);
        (self.pause == 0).then_some(self.request)
    }

    /// Takes the answer to the last request, of whose bytes only as many count as were asked for.
    pub fn answer(&mut self, bytes: &[u8; ANSWER_LEN]) -> Option<Measured> {
        self.refused = false;
        let [status, field @ ..] = bytes;
        let ready = status & READY != 0;
        let asked = self.request;
        self.request = match asked {
            Request::Status if ready => Request::Measurement,
            // Not ready although it was: it was reset between the two.
            Request::Status | Request::Measurement => Request::Status,
        };
        if asked == Request::Status || !ready {
            return None;
        }
        self.pause = PAUSE;
        self.without = 0;
        Some(Measured {
            field: RawField::from_burst(field),
            overrun: status & OVERRUN != 0,
        })
    }

    /// The last request failed; the same comes again. A measurement that was read in part is held by
    /// the magnetometer, and no other follows it, until one is read to its end.
    pub fn refuse(&mut self) {
        self.refused = true;
    }

    /// How the magnetometer was lost, from [`GIVEN_UP_AFTER`] samples without a measurement on.
    pub fn loss(&self) -> Option<Loss> {
        (self.without >= GIVEN_UP_AFTER).then_some(if self.refused {
            Loss::Silent
        } else {
            Loss::Frozen
        })
    }
}

impl Default for Polling {
    fn default() -> Self {
        Self::new()
    }
}
