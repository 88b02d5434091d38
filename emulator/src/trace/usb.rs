//! USB transactions in words.

use std::collections::BTreeMap;

use crate::usb_transaction::{Answer, Token};

/// Counts the NAKs of each endpoint until something else comes.
#[derive(Debug, Clone, Default)]
pub(super) struct Naks(BTreeMap<(u8, bool), u64>);

impl Naks {
    /// A line for the transaction, unless it is a NAK, which is counted for the next line of its endpoint.
    pub fn transaction(
        &mut self,
        address: u8,
        endpoint: u8,
        token: &Token,
        answer: &Answer,
    ) -> Option<String> {
        let pipe = (endpoint, *token == Token::In);
        if *answer == Answer::Nak {
            *self.0.entry(pipe).or_default() += 1;
            return None;
        }
        let mut text = match token {
            Token::Setup(setup) => format!("SETUP ep{endpoint} {}", request(setup)),
            Token::Out(bytes, toggle) => {
                format!("OUT ep{endpoint} {}", data(bytes, *toggle))
            }
            Token::In => format!("IN ep{endpoint}"),
        };
        match answer {
            Answer::Data(bytes, toggle) => text += &format!(" {} ACK", data(bytes, *toggle)),
            Answer::Ack => text += " ACK",
            Answer::Dropped => text += " ACK, taken for a repetition",
            Answer::Stall => text += " STALL",
            Answer::Silence => text += &format!(" no answer at address {address}"),
            Answer::Nak => {}
        }
        if let Some(naks) = self.0.remove(&pipe) {
            text += &format!(" (after {naks} NAKs)");
        }
        Some(text)
    }
}

/// A data packet with what of it can be read.
fn data(bytes: &[u8], toggle: bool) -> String {
    /// Characters that are shown.
    const SHOWN: usize = 24;
    let toggle = u8::from(toggle);
    let count = bytes.len();
    let mut text = format!("DATA{toggle} {count} bytes");
    let readable = |byte: &u8| byte.is_ascii_graphic() || b" \r\n\t".contains(byte);
    if count > 0 && bytes.iter().all(readable) {
        let start: String = bytes.iter().take(SHOWN).map(|&b| char::from(b)).collect();
        let more = if count > SHOWN { "…" } else { "" };
        text += &format!(" {:?}", start + more);
    } else if count > 0 {
        let start: Vec<String> = bytes
            .iter()
            .take(SHOWN)
            .map(|byte| format!("{byte:02x}"))
            .collect();
        let more = if count > SHOWN { " …" } else { "" };
        text += &format!(" [{}{more}]", start.join(" "));
    }
    text
}

/// A control request by its name (USB 2.0, table 9-4, and CDC PSTN 1.2, table 13).
fn request(setup: &[u8; 8]) -> String {
    let [kind, code, v0, v1, i0, i1, l0, l1] = *setup;
    let value = u16::from_le_bytes([v0, v1]);
    let index = u16::from_le_bytes([i0, i1]);
    let length = u16::from_le_bytes([l0, l1]);
    let name = match (kind & 0x60, code) {
        (0, 0) => "GET_STATUS",
        (0, 1) => "CLEAR_FEATURE",
        (0, 3) => "SET_FEATURE",
        (0, 5) => "SET_ADDRESS",
        (0, 6) => "GET_DESCRIPTOR",
        (0, 7) => "SET_DESCRIPTOR",
        (0, 8) => "GET_CONFIGURATION",
        (0, 9) => "SET_CONFIGURATION",
        (0, 10) => "GET_INTERFACE",
        (0, 11) => "SET_INTERFACE",
        (0x20, 0x20) => "SET_LINE_CODING",
        (0x20, 0x21) => "GET_LINE_CODING",
        (0x20, 0x22) => "SET_CONTROL_LINE_STATE",
        (0x20, 0x23) => "SEND_BREAK",
        _ => return format!("request {setup:02x?}"),
    };
    let what = match (name, v1) {
        ("GET_DESCRIPTOR", 1) => "device".to_owned(),
        ("GET_DESCRIPTOR", 2) => format!("configuration {v0}"),
        ("GET_DESCRIPTOR", 3) => format!("string {v0}"),
        ("GET_DESCRIPTOR", 6) => "device qualifier".to_owned(),
        _ => format!("{value:#x}"),
    };
    let place = if index == 0 || v1 == 3 {
        String::new()
    } else {
        format!(" index {index}")
    };
    format!("{name} {what}{place} length {length}")
}
