//! A small serial port on the USB bus, right but for one mistake.
//!
//! It polls the controller and knows just enough requests to be enumerated; then it sends the same two bytes for ever.
//! Without a mistake nothing can be said against it (`usb-right`).

use crate::chip::*;
use crate::registers::*;

/// What is done wrong.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Mistake {
    /// Nothing.
    None,
    /// The table is aligned to 256 bytes.
    TableAlignment,
    /// The table is where no memory is.
    TableOutside,
    /// A transmit buffer ends behind the RAM.
    BufferOutside,
    /// A descriptor is changed after it was given.
    DescriptorOwned,
    /// Both banks of endpoint 0 receive into the same buffer.
    BufferTwice,
    /// Endpoint 0 receives into four bytes.
    BufferTooSmall,
    /// Every packet is DATA0.
    Toggle,
    /// 65 bytes in a packet.
    PacketTooLong,
    /// wLength is not looked at.
    TooMuchData,
    /// The status stage has a byte.
    StatusStage,
    /// No buffer for endpoint 0.
    SetupLost,
    /// ADDR is written as soon as the request is there.
    AddressEarly,
    /// ADDR is not written.
    AddressLate,
    /// SET_CONFIGURATION is never answered.
    RequestTimeout,
    /// The bulk endpoint is not switched on.
    NoAnswer,
    /// The interrupt endpoint stalls once, then sends.
    HaltLost,
    /// A bulk endpoint with packets of 65 bytes.
    Descriptor,
    /// The device descriptor is refused.
    Enumeration,
    /// Resume is signalled without leave.
    WakeUp,
    /// The controller becomes a host.
    HostMode,
}

/// The buffer descriptor table, and 64-byte buffers behind it; the linker puts nothing there.
const TABLE: u32 = 0x2000_4000;
const BUFFERS: u32 = 0x2000_4200;
const RAM_END: u32 = 0x2000_8000;

/// ISTAT and CTL.
const STALL: u8 = 1 << 7;
const TOKDNE: u8 = 1 << 3;
const USBRST: u8 = 1 << 0;
const ENABLE: u8 = 1 << 0;
const ODDRST: u8 = 1 << 1;

/// Descriptor bits.
const OWN: u32 = 1 << 7;
const DATA1: u32 = 1 << 6;
const DTS: u32 = 1 << 3;
const BDT_STALL: u32 = 1 << 2;

const DEVICE: [u8; 18] = [
    18, 1, 0x10, 1, 2, 0, 0, 64, 0xC0, 0x16, 0x83, 0x04, 0, 1, 0, 0, 0, 1,
];
const CONFIGURATION: [u8; 48] = [
    9, 2, 48, 0, 2, 1, 0, 0x80, 50, // configuration
    9, 4, 0, 0, 1, 2, 2, 0, 0, // communication
    7, 5, 0x81, 3, 8, 0, 10, // interrupt IN
    9, 4, 1, 0, 2, 10, 0, 0, 0, // data
    7, 5, 0x82, 2, 64, 0, 0, // bulk IN
    7, 5, 0x03, 2, 64, 0, 0, // bulk OUT
];

/// The device.
struct Device {
    mistake: Mistake,
    /// The bank that the controller sends from next, of endpoints 0 to 2.
    bank: [u32; 3],
    toggle: [bool; 3],
    busy: [bool; 3],
    /// What is left of an answer on endpoint 0.
    answer: &'static [u8],
    address: u8,
    configured: bool,
    stalled_once: bool,
}

/// Runs a device that makes `mistake`.
pub fn run(mistake: Mistake) {
    // 48 MHz for the core, the bus and USB, 24 MHz for the flash.
    write(SIM_CLKDIV1, 0x0001_0000u32);
    use_crystal();
    start_pll(8, 24);
    use_pll();
    write(SIM_CLKDIV2, 0u32);
    write(SIM_SOPT2, 1u32 << 18 | 1 << 16);
    write(SIM_SCGC4, 0xF010_0030u32 | 1 << 18);
    let table = match mistake {
        Mistake::TableAlignment => TABLE + 0x100,
        Mistake::TableOutside => 0x3000_0000,
        _ => TABLE,
    };
    let [_, page1, page2, page3] = table.to_le_bytes();
    write(USB0_BDTPAGE1, page1);
    write(USB0_BDTPAGE2, page2);
    write(USB0_BDTPAGE3, page3);
    write(USB0_USBCTRL, 0u8);
    let mode = match mistake {
        Mistake::WakeUp => 1 << 2,
        Mistake::HostMode => 1 << 3,
        _ => 0,
    };
    write(USB0_CTL, ENABLE | mode);
    write(USB0_CONTROL, 0x10u8);
    let mut device = Device {
        mistake,
        bank: [0; 3],
        toggle: [false; 3],
        busy: [false; 3],
        answer: &[],
        address: 0,
        configured: false,
        stalled_once: false,
    };
    loop {
        device.poll();
    }
}

fn place(endpoint: u32, transmit: bool, bank: u32) -> u32 {
    TABLE + (endpoint << 5 | u32::from(transmit) << 4 | bank << 3)
}

fn buffer(endpoint: u32, transmit: bool, bank: u32) -> u32 {
    BUFFERS + (endpoint << 2 | u32::from(transmit) << 1 | bank) * 128
}

/// Gives a descriptor to the controller: the address first, OWN last.
fn give(place: u32, buffer: u32, length: u32, bits: u32) {
    write(place + 4, buffer);
    write(place, length << 16 | OWN | DTS | bits);
}

impl Device {
    fn poll(&mut self) {
        let flags: u8 = read(USB0_ISTAT);
        if flags & USBRST != 0 {
            self.reset();
        } else if flags & STALL != 0 {
            write(USB0_ENDPT0, 0x0Du8);
            if self.configured {
                // The interrupt endpoint has refused once; that is all it takes.
                write(place(1, true, self.bank[1]), 0u32);
                self.busy[1] = false;
            }
            write(USB0_ISTAT, STALL);
        } else if flags & TOKDNE != 0 {
            self.token(u32::from(read::<u8>(USB0_STAT)));
            write(USB0_ISTAT, TOKDNE);
        } else if self.configured {
            self.send_something();
        }
    }

    fn reset(&mut self) {
        write(USB0_CTL, ENABLE | ODDRST);
        write(USB0_ADDR, 0u8);
        (self.bank, self.busy, self.configured) = ([0; 3], [false; 3], false);
        for n in 0..32 {
            write(TABLE + n * 4, 0u32);
        }
        if self.mistake != Mistake::SetupLost {
            self.receive(0, 0);
            self.receive(1, DATA1);
        }
        write(USB0_ENDPT0, 0x0Du8);
        write(USB0_ISTAT, 0xFFu8);
        write(USB0_CTL, ENABLE);
    }

    /// Gives a receive buffer of endpoint 0.
    fn receive(&self, bank: u32, bits: u32) {
        let room = if self.mistake == Mistake::BufferTooSmall {
            4
        } else {
            64
        };
        let shared = self.mistake == Mistake::BufferTwice;
        let at = buffer(0, false, if shared { 0 } else { bank });
        give(place(0, false, bank), at, room, bits);
    }

    fn token(&mut self, status: u32) {
        let (endpoint, bank) = (status >> 4, status >> 2 & 1);
        if status & 1 << 3 != 0 {
            let endpoint = endpoint as usize;
            self.bank[endpoint] = bank ^ 1;
            self.busy[endpoint] = false;
            self.toggle[endpoint] = !self.toggle[endpoint];
            if endpoint == 0 {
                self.sent();
            }
        } else if endpoint == 0 {
            let setup = read::<u32>(place(0, false, bank)) >> 2 & 0xF == 0xD;
            if setup {
                let from = buffer(0, false, bank);
                let request = [read::<u32>(from), read::<u32>(from + 4)];
                // No token is processed: both banks may be set up anew, for data and status as DATA1.
                write(place(0, true, self.bank[0]), 0u32);
                (self.busy[0], self.toggle[0], self.answer) = (false, true, &[]);
                self.receive(bank ^ 1, DATA1);
                self.receive(bank, 0);
                self.request(request);
                write(USB0_CTL, ENABLE);
            } else {
                self.receive(bank, 0);
            }
        }
    }

    /// A packet of endpoint 0 has gone.
    fn sent(&mut self) {
        if self.address != 0 && self.mistake != Mistake::AddressLate {
            write(USB0_ADDR, self.address);
        }
        self.address = 0;
        if !self.answer.is_empty() {
            self.send_answer();
        }
    }

    fn request(&mut self, [head, tail]: [u32; 2]) {
        let length = (tail >> 16) as usize;
        match (head & 0xFFFF, head >> 24) {
            (0x0680, 1) if self.mistake == Mistake::Enumeration => self.refuse(),
            (0x0680, 1) => self.reply(&DEVICE, length),
            (0x0680, 2) if self.mistake == Mistake::Descriptor => self.reply(&TOO_LONG, length),
            (0x0680, 2) => self.reply(&CONFIGURATION, length),
            (0x0500, _) => {
                self.address = (head >> 16) as u8;
                if self.mistake == Mistake::AddressEarly {
                    write(USB0_ADDR, self.address);
                }
                self.acknowledge();
            }
            (0x0900, _) => self.configure(),
            (0x2221, _) => self.acknowledge(),
            // The line coding comes in the data stage; its status can wait in the buffer.
            (0x2021, _) => self.acknowledge(),
            _ => self.refuse(),
        }
    }

    fn refuse(&self) {
        write(USB0_ENDPT0, 0x0Fu8);
    }

    fn acknowledge(&mut self) {
        if self.mistake == Mistake::StatusStage {
            self.send(0, 1, 0);
        } else {
            self.send(0, 0, 0);
        }
    }

    fn reply(&mut self, bytes: &'static [u8], length: usize) {
        let all = self.mistake == Mistake::TooMuchData;
        self.answer = if all {
            bytes
        } else {
            &bytes[..bytes.len().min(length)]
        };
        self.send_answer();
    }

    /// Sends what an answer has for one packet; none here is a multiple of 64 bytes.
    fn send_answer(&mut self) {
        let at = buffer(0, true, self.bank[0]);
        for (n, &byte) in self.answer.iter().enumerate() {
            write(at + n as u32, byte);
        }
        self.send(0, self.answer.len() as u32, 0);
        self.answer = &[];
    }

    fn send(&mut self, endpoint: usize, length: u32, bits: u32) {
        let (number, bank) = (endpoint as u32, self.bank[endpoint]);
        let toggle = self.toggle[endpoint] && !(endpoint == 2 && self.mistake == Mistake::Toggle);
        let outside = endpoint == 2 && self.mistake == Mistake::BufferOutside;
        let at = if outside {
            RAM_END - 1
        } else {
            buffer(number, true, bank)
        };
        self.busy[endpoint] = true;
        give(
            place(number, true, bank),
            at,
            length,
            bits | if toggle { DATA1 } else { 0 },
        );
    }

    fn configure(&mut self) {
        self.configured = true;
        (self.toggle[1], self.toggle[2]) = (false, false);
        write(USB0_ENDPT1, 0x15u8);
        if self.mistake != Mistake::NoAnswer {
            write(USB0_ENDPT2, 0x15u8);
        }
        give(place(3, false, 0), buffer(3, false, 0), 64, 0);
        write(USB0_ENDPT3, 0x19u8);
        if self.mistake == Mistake::RequestTimeout {
            write(USB0_CTL, ENABLE);
            sleep();
        }
        self.acknowledge();
    }

    fn send_something(&mut self) {
        if !self.busy[2] {
            let at = buffer(2, true, self.bank[2]);
            write(at, b'.');
            write(at + 1, b'\n');
            let long = self.mistake == Mistake::PacketTooLong;
            self.send(2, if long { 65 } else { 2 }, 0);
        }
        if !self.busy[1] && self.mistake == Mistake::HaltLost {
            let stall = if self.stalled_once { 0 } else { BDT_STALL };
            self.stalled_once = true;
            self.send(1, 8, stall);
        }
        if self.mistake == Mistake::DescriptorOwned {
            let status = read::<u32>(place(3, false, 0));
            write(place(3, false, 0), status ^ 1 << 16);
        }
    }
}

/// The configuration with an illegal bulk endpoint.
const TOO_LONG: [u8; 48] = {
    let mut bytes = CONFIGURATION;
    bytes[38] = 65;
    bytes
};
