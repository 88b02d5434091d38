//! D+ and D−, and what is on the bus.

use vcd::Value;

use crate::journal::Happening;
use crate::time::{MILLISECOND, Ticks};
use crate::usb_transaction::{Answer, Token};

/// The bus from a moment on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct State {
    pub at: Ticks,
    pub dp: Value,
    pub dm: Value,
    pub text: String,
}

/// Ticks of a bit at 12 Mbit/s.
const BIT: Ticks = 12;
/// A token with its SYNC, PID and end of packet: 8 + 24 + 3 bits.
const TOKEN: Ticks = 35 * BIT;
/// A handshake: 8 + 8 + 3 bits.
const HANDSHAKE: Ticks = 19 * BIT;
/// SYNC, PID, CRC and end of a data packet, without bit stuffing.
const AROUND_DATA: Ticks = 35 * BIT;
/// From packet to packet (USB 2.0, 7.1.18: 2 to 7.5 bits).
const GAP: Ticks = 4 * BIT;
/// How long the host drives SE0 (USB 2.0, 7.1.7.5).
const RESET: Ticks = 10 * MILLISECOND;

fn packet(at: Ticks, text: String) -> State {
    State {
        at,
        dp: Value::X,
        dm: Value::X,
        text,
    }
}

/// J, the idle state at full speed.
fn idle(at: Ticks) -> State {
    State {
        at,
        dp: Value::V1,
        dm: Value::V0,
        text: "-".into(),
    }
}

/// The states that `happening`, which begins at `at`, stands for.
pub(super) fn states(at: Ticks, happening: &Happening) -> Vec<State> {
    match happening {
        Happening::UsbReset => vec![
            State {
                at,
                dp: Value::V0,
                dm: Value::V0,
                text: "SE0_reset".into(),
            },
            idle(at + RESET),
        ],
        Happening::UsbFrame(number) => {
            vec![packet(at, format!("SOF_{number}")), idle(at + TOKEN)]
        }
        Happening::Usb {
            endpoint,
            token,
            answer,
            ..
        } => {
            let data =
                |bytes: &[u8], toggle: &bool| format!("_DATA{}_{}", u8::from(*toggle), bytes.len());
            let length = |bytes: &[u8]| AROUND_DATA + 8 * BIT * bytes.len() as Ticks;
            let (mut text, mut end) = match token {
                Token::Setup(bytes) => {
                    let sent = length(bytes) + GAP;
                    (format!("SETUP_ep{endpoint}_DATA0_8"), at + TOKEN + sent)
                }
                Token::Out(bytes, toggle) => {
                    let text = format!("OUT_ep{endpoint}{}", data(bytes, toggle));
                    (text, at + TOKEN + GAP + length(bytes))
                }
                Token::In => (format!("IN_ep{endpoint}"), at + TOKEN),
            };
            end += match answer {
                Answer::Data(bytes, toggle) => {
                    text += &data(bytes, toggle);
                    GAP + length(bytes) + GAP + HANDSHAKE
                }
                Answer::Silence => 0,
                _ => GAP + HANDSHAKE,
            };
            text += match answer {
                Answer::Data(..) | Answer::Ack | Answer::Dropped => "_ACK",
                Answer::Nak => "_NAK",
                Answer::Stall => "_STALL",
                Answer::Silence => "_silence",
            };
            vec![packet(at, text), idle(end)]
        }
        _ => Vec::new(),
    }
}
