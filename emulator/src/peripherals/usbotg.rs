//! USB full-speed device controller (K20 manual, chapter 43): registers, buffer descriptors in RAM, handshakes.
//!
//! The host's side of the wire calls [`UsbController::transact`]; what the controller answers depends only on its
//! registers and on the buffer descriptor table.

use std::collections::VecDeque;

use crate::cpu::Ram;
use crate::journal::{Happening, Journal};

const ISTAT: u32 = 0x80;
const INTEN: u32 = 0x84;
const ERRSTAT: u32 = 0x88;
const ERREN: u32 = 0x8C;
const STAT: u32 = 0x90;
const CTL: u32 = 0x94;
const ADDR: u32 = 0x98;
const BDTPAGE1: u32 = 0x9C;
const FRMNUML: u32 = 0xA0;
const FRMNUMH: u32 = 0xA4;
const BDTPAGE2: u32 = 0xB0;
const BDTPAGE3: u32 = 0xB4;
const ENDPT0: u32 = 0xC0;
const USBCTRL: u32 = 0x100;
const CONTROL: u32 = 0x108;
const USBTRC0: u32 = 0x10C;

/// ISTAT flags.
mod istat {
    pub const STALL: u8 = 1 << 7;
    pub const SLEEP: u8 = 1 << 4;
    pub const TOKDNE: u8 = 1 << 3;
    pub const SOFTOK: u8 = 1 << 2;
    pub const ERROR: u8 = 1 << 1;
    pub const USBRST: u8 = 1 << 0;
}

const TXSUSPENDTOKENBUSY: u8 = 1 << 5;
const ODDRST: u8 = 1 << 1;
const USBENSOFEN: u8 = 1 << 0;

const EPSTALL: u8 = 1 << 1;
const EPTXEN: u8 = 1 << 2;
const EPRXEN: u8 = 1 << 3;
const EPHSHK: u8 = 1 << 0;

/// Buffer descriptor bits (43.3.5).
const OWN: u32 = 1 << 7;
const DATA1: u32 = 1 << 6;
const KEEP: u32 = 1 << 5;
const DTS: u32 = 1 << 3;
const BDT_STALL: u32 = 1 << 2;

/// Packet identifiers as the controller writes them back.
const PID_OUT: u32 = 0x1;
const PID_IN: u32 = 0x9;
const PID_SETUP: u32 = 0xD;

/// A transaction the host begins.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Token {
    /// SETUP with its eight bytes, always DATA0.
    Setup([u8; 8]),
    /// OUT with its data and toggle.
    Out(Vec<u8>, bool),
    /// IN.
    In,
}

/// What the device answers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// Data, with its toggle; the host acknowledges it.
    Data(Vec<u8>, bool),
    /// Accepted.
    Ack,
    /// Not now.
    Nak,
    /// Never.
    Stall,
    /// Nothing at all.
    Silence,
}

/// The controller.
#[derive(Debug, Clone)]
pub struct UsbController {
    istat: u8,
    inten: u8,
    errstat: u8,
    erren: u8,
    ctl: u8,
    addr: u8,
    bdt_page: [u8; 3],
    frame: u16,
    endpoints: [u8; 16],
    usbctrl: u8,
    control: u8,
    usbtrc0: u8,
    /// Completed tokens as STAT shows them; the controller holds four (43.4.8).
    completed: VecDeque<u8>,
    /// Which of its two buffers each endpoint uses next: `[endpoint][transmit]`.
    odd: [[bool; 2]; 16],
    /// Mistakes of the program that a real bus would punish, in its words.
    pub complaints: Vec<String>,
    /// What happens on the bus, for those who watch; the time is the chip's to add.
    pub journal: Journal,
}

impl UsbController {
    /// The state after reset.
    pub fn new() -> UsbController {
        UsbController {
            istat: 0,
            inten: 0,
            errstat: 0,
            erren: 0,
            ctl: 0,
            addr: 0,
            bdt_page: [0; 3],
            frame: 0,
            endpoints: [0; 16],
            usbctrl: 0xC0,
            control: 0,
            usbtrc0: 0,
            completed: VecDeque::new(),
            odd: [[false; 2]; 16],
            complaints: Vec::new(),
            journal: Journal::default(),
        }
    }

    /// A reset of the chip or of the module; complaints are kept.
    pub fn reset(&mut self) {
        let complaints = std::mem::take(&mut self.complaints);
        let journal = std::mem::take(&mut self.journal);
        *self = UsbController {
            complaints,
            journal,
            ..UsbController::new()
        };
    }

    /// Whether the device shows itself on the bus by pulling D+ up.
    pub fn pulled_up(&self) -> bool {
        self.ctl & USBENSOFEN != 0 && self.control & 0x10 != 0 && self.usbctrl & 0x80 == 0
    }

    /// Whether the controller asks for its interrupt.
    pub fn interrupt(&self) -> bool {
        self.istat & self.inten != 0
    }

    /// The host resets the bus.
    pub fn bus_reset(&mut self) {
        self.istat |= istat::USBRST;
        self.journal.note(0, || Happening::UsbReset);
    }

    /// A frame begins.
    pub fn start_of_frame(&mut self, frame: u16) {
        self.journal.note(0, || Happening::UsbFrame(frame & 0x7FF));
        if self.ctl & USBENSOFEN != 0 {
            self.frame = frame & 0x7FF;
            self.istat |= istat::SOFTOK;
        }
    }

    /// The bus has been idle for 3 ms.
    pub fn idle(&mut self) {
        self.istat |= istat::SLEEP;
    }

    fn descriptor(&self, endpoint: u8, transmit: bool) -> u32 {
        let table = u32::from_be_bytes([
            self.bdt_page[2],
            self.bdt_page[1],
            self.bdt_page[0] & 0xFE,
            0,
        ]);
        let odd = self.odd[usize::from(endpoint)][usize::from(transmit)];
        table | u32::from(endpoint) << 5 | u32::from(transmit) << 4 | u32::from(odd) << 3
    }

    /// One transaction for `address` and `endpoint`.
    pub fn transact(&mut self, address: u8, endpoint: u8, token: &Token, ram: &Ram) -> Answer {
        let answer = self.answer(address, endpoint, token, ram);
        self.journal.note(0, || Happening::Usb {
            address,
            endpoint,
            token: token.clone(),
            answer: answer.clone(),
        });
        answer
    }

    fn answer(&mut self, address: u8, endpoint: u8, token: &Token, ram: &Ram) -> Answer {
        let Some(&enabled) = self.endpoints.get(usize::from(endpoint)) else {
            return Answer::Silence;
        };
        if self.ctl & USBENSOFEN == 0 || self.addr & 0x7F != address {
            return Answer::Silence;
        }
        let transmit = *token == Token::In;
        let needed = if transmit { EPTXEN } else { EPRXEN } | EPHSHK;
        if enabled & needed != needed {
            return Answer::Silence;
        }
        // A SETUP may be neither NAKed nor stalled (USB 2.0, 8.5.3): where the controller cannot take it, it is lost.
        let setup = matches!(token, Token::Setup(_));
        let refuse = |answer: Answer| if setup { Answer::Silence } else { answer };
        if enabled & EPSTALL != 0 {
            self.istat |= if setup { 0 } else { istat::STALL };
            return refuse(Answer::Stall);
        }
        if self.ctl & TXSUSPENDTOKENBUSY != 0 || self.completed.len() >= 4 {
            return refuse(Answer::Nak);
        }
        let at = self.descriptor(endpoint, transmit);
        let (Some(status), Some(buffer)) = (ram.word(at), ram.word(at + 4)) else {
            self.complaints.push(format!(
                "the buffer descriptor table at {at:#010x} is not in RAM"
            ));
            return Answer::Silence;
        };
        if status & OWN == 0 {
            return refuse(Answer::Nak);
        }
        if status & BDT_STALL != 0 {
            self.istat |= istat::STALL;
            return refuse(Answer::Stall);
        }
        let room = (status >> 16 & 0x3FF) as usize;
        let data1 = status & DATA1 != 0;
        match token {
            Token::In => {
                let Some(data) = ram.bytes(buffer, room) else {
                    self.complaints.push(format!(
                        "the transmit buffer at {buffer:#010x} is not in RAM"
                    ));
                    return Answer::Silence;
                };
                self.complete(endpoint, true, at, status, room, PID_IN, ram);
                Answer::Data(data, data1)
            }
            Token::Out(_, toggle) if status & DTS != 0 && *toggle != data1 => {
                // A repeated packet: acknowledged so that the host goes on, and dropped.
                Answer::Ack
            }
            Token::Out(data, _) => {
                self.receive(endpoint, at, status, buffer, room, data, PID_OUT, ram)
            }
            Token::Setup(data) => {
                let answer = self.receive(endpoint, at, status, buffer, room, data, PID_SETUP, ram);
                if answer == Answer::Ack {
                    self.ctl |= TXSUSPENDTOKENBUSY;
                }
                answer
            }
        }
    }

    #[expect(clippy::too_many_arguments, reason = "the parts of one packet")]
    fn receive(
        &mut self,
        endpoint: u8,
        at: u32,
        status: u32,
        buffer: u32,
        room: usize,
        data: &[u8],
        pid: u32,
        ram: &Ram,
    ) -> Answer {
        if data.len() > room || !ram.set_bytes(buffer, data) {
            self.complaints.push(format!(
                "{} bytes for endpoint {endpoint} do not fit the {room} bytes at {buffer:#010x}",
                data.len()
            ));
            self.errstat |= 1 << 5;
            self.istat |= istat::ERROR;
            return Answer::Silence;
        }
        self.complete(endpoint, false, at, status, data.len(), pid, ram);
        Answer::Ack
    }

    #[expect(clippy::too_many_arguments, reason = "the parts of one packet")]
    fn complete(
        &mut self,
        endpoint: u8,
        transmit: bool,
        at: u32,
        status: u32,
        length: usize,
        pid: u32,
        ram: &Ram,
    ) {
        let owner = if status & KEEP != 0 { OWN } else { 0 };
        let written = status & DATA1 | owner | pid << 2 | (length as u32) << 16;
        ram.set_word(at, written);
        let odd = &mut self.odd[usize::from(endpoint)][usize::from(transmit)];
        self.completed
            .push_back(endpoint << 4 | u8::from(transmit) << 3 | u8::from(*odd) << 2);
        *odd = !*odd;
        self.istat |= istat::TOKDNE;
    }

    /// Reads an 8-bit register.
    pub fn read(&self, offset: u32) -> u32 {
        u32::from(match offset {
            0x00 => 0x04,
            0x04 => 0xFB,
            0x08 => 0x33,
            0x0C => 0x01,
            ISTAT => self.istat,
            INTEN => self.inten,
            ERRSTAT => self.errstat,
            ERREN => self.erren,
            STAT => self.completed.front().copied().unwrap_or(0),
            CTL => self.ctl,
            ADDR => self.addr,
            BDTPAGE1 => self.bdt_page[0],
            BDTPAGE2 => self.bdt_page[1],
            BDTPAGE3 => self.bdt_page[2],
            FRMNUML => self.frame as u8,
            FRMNUMH => (self.frame >> 8) as u8,
            USBCTRL => self.usbctrl,
            CONTROL => self.control,
            USBTRC0 => self.usbtrc0 & 0x7F,
            ENDPT0..0x100 if offset & 3 == 0 => self.endpoints[(offset - ENDPT0) as usize / 4],
            _ => 0,
        })
    }

    /// Writes an 8-bit register.
    pub fn write(&mut self, offset: u32, value: u8) {
        match offset {
            ISTAT => {
                self.istat &= !value;
                if value & istat::TOKDNE != 0 {
                    self.completed.pop_front();
                    if !self.completed.is_empty() {
                        self.istat |= istat::TOKDNE;
                    }
                }
            }
            INTEN => self.inten = value,
            ERRSTAT => self.errstat &= !value,
            ERREN => self.erren = value,
            CTL => {
                if value & ODDRST != 0 {
                    self.odd = [[false; 2]; 16];
                }
                self.ctl = value;
            }
            ADDR => self.addr = value,
            BDTPAGE1 => self.bdt_page[0] = value,
            BDTPAGE2 => self.bdt_page[1] = value,
            BDTPAGE3 => self.bdt_page[2] = value,
            USBCTRL => self.usbctrl = value,
            CONTROL => self.control = value,
            USBTRC0 if value & 0x80 != 0 => self.reset(),
            USBTRC0 => self.usbtrc0 = value,
            ENDPT0..0x100 if offset & 3 == 0 => {
                self.endpoints[(offset - ENDPT0) as usize / 4] = value
            }
            _ => {}
        }
    }
}

impl Default for UsbController {
    fn default() -> UsbController {
        UsbController::new()
    }
}
