//! USB full-speed device controller (K20 manual, chapter "Universal Serial Bus OTG Controller"): its registers and what
//! the bus does to them.
//!
//! The host's side of the wire calls [`UsbController::transact`] ([`transactions`](self)); what the controller answers
//! depends only on its registers and on the buffer descriptor table in RAM. Host mode and OTG are not modelled.

mod ownership;

mod table;

mod transactions;

use std::collections::VecDeque;

use crate::cpu::Ram;
use crate::journal::{Happening, Journal};
use crate::witness::{Trap, Witness};
use ownership::Ownership;
use table::Place;

const OTGCTL: u32 = 0x1C;
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
const OBSERVE: u32 = 0x104;
const CONTROL: u32 = 0x108;
const USBTRC0: u32 = 0x10C;

/// ISTAT flags.
mod istat {
    pub const STALL: u8 = 1 << 7;
    pub const RESUME: u8 = 1 << 5;
    pub const SLEEP: u8 = 1 << 4;
    pub const TOKDNE: u8 = 1 << 3;
    pub const SOFTOK: u8 = 1 << 2;
    pub const ERROR: u8 = 1 << 1;
    pub const USBRST: u8 = 1 << 0;
}

/// ERRSTAT: the packet does not fit its buffer.
const DMAERR: u8 = 1 << 5;
/// ERRSTAT: the packet's checksum is wrong.
const CRC16: u8 = 1 << 2;

/// CTL.
mod ctl {
    pub const TXSUSPENDTOKENBUSY: u8 = 1 << 5;
    pub const HOSTMODEEN: u8 = 1 << 3;
    pub const RESUME: u8 = 1 << 2;
    pub const ODDRST: u8 = 1 << 1;
    pub const USBENSOFEN: u8 = 1 << 0;
}

/// ENDPTn.
mod endpt {
    pub const EPCTLDIS: u8 = 1 << 4;
    pub const EPRXEN: u8 = 1 << 3;
    pub const EPTXEN: u8 = 1 << 2;
    pub const EPSTALL: u8 = 1 << 1;
    pub const EPHSHK: u8 = 1 << 0;
}

const OTGCTL_DPHIGH: u8 = 1 << 7;
const OTGCTL_OTGEN: u8 = 1 << 2;
const USBCTRL_SUSP: u8 = 1 << 7;
const CONTROL_DPPULLUPNONOTG: u8 = 1 << 4;
const USBTRC0_USBRESET: u8 = 1 << 7;
const USBTRC0_USBRESMEN: u8 = 1 << 5;
const USBTRC0_RESUME_INT: u8 = 1 << 0;

/// Completed tokens that wait for the program (STAT is a window into a FIFO of four).
const COMPLETED: usize = 4;

/// The controller.
#[derive(Debug, Clone)]
pub struct UsbController {
    otgctl: u8,
    istat: u8,
    inten: u8,
    errstat: u8,
    erren: u8,
    /// STAT as it was last: it keeps its value when the FIFO is empty.
    stat: u8,
    ctl: u8,
    addr: u8,
    bdt_page: [u8; 3],
    frame: u16,
    endpoints: [u8; 16],
    usbctrl: u8,
    observe: u8,
    control: u8,
    usbtrc0: u8,
    completed: VecDeque<Place>,
    /// Which of its two buffers each endpoint uses next: `[endpoint][transmit]`.
    odd: [[bool; 2]; 16],
    ownership: Ownership,
    /// The address of a SET_ADDRESS whose status stage is still to come.
    address_to_come: Option<u8>,
    /// The pull-up was released since the host last looked.
    let_go: bool,
    /// A packet of another endpoint than 0 has gone to the host since somebody last asked.
    gone: bool,
    /// What happens on the bus, for those who watch; the time is the chip's to add.
    pub journal: Journal,
}

impl UsbController {
    /// The state after reset.
    pub fn new() -> UsbController {
        UsbController {
            otgctl: 0,
            istat: 0,
            inten: 0,
            errstat: 0,
            erren: 0,
            stat: 0,
            ctl: 0,
            addr: 0,
            bdt_page: [0; 3],
            frame: 0,
            endpoints: [0; 16],
            usbctrl: 0xC0,
            observe: 0x50,
            control: 0,
            usbtrc0: 0,
            completed: VecDeque::new(),
            odd: [[false; 2]; 16],
            ownership: Ownership::default(),
            address_to_come: None,
            let_go: false,
            gone: false,
            journal: Journal::default(),
        }
    }

    /// A reset of the chip or of the module: the pull-up is released.
    pub fn reset(&mut self) {
        let journal = std::mem::take(&mut self.journal);
        *self = UsbController {
            journal,
            let_go: true,
            ..UsbController::new()
        };
    }

    /// Whether the pull-up was released, for however short, since this was last asked.
    pub fn take_let_go(&mut self) -> bool {
        std::mem::take(&mut self.let_go)
    }

    /// Whether the device shows itself on the bus by pulling D+ up.
    pub fn pulled_up(&self) -> bool {
        if self.otgctl & OTGCTL_OTGEN != 0 {
            self.otgctl & OTGCTL_DPHIGH != 0
        } else {
            self.control & CONTROL_DPPULLUPNONOTG != 0
        }
    }

    /// Whether the controller asks for its interrupt.
    pub fn interrupt(&self) -> bool {
        self.istat & self.inten != 0 || self.usbtrc0 & USBTRC0_RESUME_INT != 0
    }

    /// Whether the device drives resume signalling, to wake its host.
    pub fn drives_resume(&self) -> bool {
        self.ctl & ctl::USBENSOFEN != 0 && self.ctl & ctl::RESUME != 0
    }

    /// The address the program has given itself.
    pub fn address(&self) -> u8 {
        self.addr & 0x7F
    }

    /// Whether the controller takes part in the bus: enabled, and its transceiver not suspended.
    fn is_listening(&self) -> bool {
        self.ctl & ctl::USBENSOFEN != 0 && self.usbctrl & USBCTRL_SUSP == 0
    }

    /// Whether descriptors may be changed whoever owns them: no token is processed meanwhile.
    fn is_quiet(&self) -> bool {
        self.ctl & (ctl::TXSUSPENDTOKENBUSY | ctl::ODDRST) != 0
            || self.ctl & ctl::USBENSOFEN == 0
            || self.istat & istat::USBRST != 0
    }

    /// The host resets the bus.
    pub fn bus_reset(&mut self) {
        self.journal.note(0, || Happening::UsbReset);
        self.address_to_come = None;
        self.ownership.forget();
        if self.is_listening() {
            self.istat |= istat::USBRST;
        } else if self.usbtrc0 & USBTRC0_USBRESMEN != 0 {
            self.usbtrc0 |= USBTRC0_RESUME_INT;
        }
    }

    /// A frame begins; the descriptors of all endpoints are looked at for changes that were none of the program's
    /// business.
    pub fn start_of_frame(&mut self, frame: u16, ram: &Ram, witness: &mut Witness) {
        self.journal.note(0, || Happening::UsbFrame(frame & 0x7FF));
        if !self.is_listening() {
            return;
        }
        self.frame = frame & 0x7FF;
        self.istat |= istat::SOFTOK;
        if self.is_quiet() {
            return;
        }
        for endpoint in 0..16 {
            for transmit in [false, true] {
                self.look_at_owners(endpoint, transmit, ram, witness);
            }
        }
        let endpoints = self.endpoints;
        let isochronous = |number: u8| endpoints[usize::from(number)] & endpt::EPHSHK == 0;
        self.ownership.find_shared_buffers(isochronous, witness);
    }

    /// The bus has been idle for 3 ms.
    pub fn idle(&mut self) {
        if self.is_listening() {
            self.istat |= istat::SLEEP;
        }
    }

    /// The host ends the bus's suspension: D− has been high for 2.5 µs.
    pub fn resume_signalled(&mut self) {
        if self.is_listening() {
            self.istat |= istat::RESUME;
        } else if self.usbtrc0 & USBTRC0_USBRESMEN != 0 {
            self.usbtrc0 |= USBTRC0_RESUME_INT;
        }
    }

    fn error(&mut self, which: u8) {
        self.errstat |= which;
        if self.errstat & self.erren != 0 {
            self.istat |= istat::ERROR;
        }
    }

    /// Reads an 8-bit register.
    pub fn read(&mut self, offset: u32) -> u32 {
        u32::from(match offset {
            0x00 => 0x04,
            0x04 => 0xFB,
            0x08 => 0x33,
            0x0C => 0x01,
            OTGCTL => self.otgctl,
            ISTAT => self.istat,
            INTEN => self.inten,
            ERRSTAT => self.errstat,
            ERREN => self.erren,
            STAT => {
                if let Some(place) = self.completed.front() {
                    self.ownership.told(*place);
                    self.stat = place.as_stat();
                }
                self.stat
            }
            CTL => self.ctl,
            ADDR => self.addr,
            BDTPAGE1 => self.bdt_page[0],
            BDTPAGE2 => self.bdt_page[1],
            BDTPAGE3 => self.bdt_page[2],
            FRMNUML => self.frame as u8,
            FRMNUMH => (self.frame >> 8) as u8,
            USBCTRL => self.usbctrl,
            OBSERVE => self.observe,
            CONTROL => self.control,
            USBTRC0 => self.usbtrc0,
            ENDPT0..0x100 if offset & 3 == 0 => self.endpoints[(offset - ENDPT0) as usize / 4],
            _ => 0,
        })
    }

    /// Writes an 8-bit register.
    pub fn write(&mut self, offset: u32, value: u8, witness: &mut Witness) {
        let was_pulled_up = self.pulled_up();
        self.store(offset, value, witness);
        self.let_go |= was_pulled_up && !self.pulled_up();
    }

    fn store(&mut self, offset: u32, value: u8, witness: &mut Witness) {
        match offset {
            OTGCTL => self.otgctl = value,
            ISTAT => self.clear_flags(value),
            INTEN => self.inten = value,
            ERRSTAT => self.errstat &= !value,
            ERREN => self.erren = value,
            CTL => self.write_control(value, witness),
            ADDR => self.write_address(value, witness),
            BDTPAGE1 => {
                if value & 1 != 0 {
                    witness.saw(
                        Trap::UsbTableAlignment,
                        format!("BDTPAGE1 = {value:#04x}: address bit 8 of the table is set, and the controller ignores it"),
                    );
                }
                self.bdt_page[0] = value & 0xFE;
            }
            BDTPAGE2 => self.bdt_page[1] = value,
            BDTPAGE3 => self.bdt_page[2] = value,
            USBCTRL => self.usbctrl = value & 0xC0,
            OBSERVE => self.observe = value,
            CONTROL => self.control = value & CONTROL_DPPULLUPNONOTG,
            USBTRC0 if value & USBTRC0_USBRESET != 0 => self.reset(),
            // The resume flag is the controller's; disabling the interrupt clears it.
            USBTRC0 if value & USBTRC0_USBRESMEN == 0 => self.usbtrc0 = value & 0x7E,
            USBTRC0 => self.usbtrc0 = value & 0x7E | self.usbtrc0 & USBTRC0_RESUME_INT,
            ENDPT0..0x100 if offset & 3 == 0 => {
                let number = (offset - ENDPT0) as usize / 4;
                let before = self.endpoints[number];
                self.endpoints[number] = value;
                // While it was off or stalled its descriptors were the program's.
                let enabled = value & !before & (endpt::EPRXEN | endpt::EPTXEN) != 0;
                if enabled || before & !value & endpt::EPSTALL != 0 {
                    self.ownership.forget_endpoint(number as u8);
                }
            }
            _ => {}
        }
    }

    fn clear_flags(&mut self, flags: u8) {
        let was_quiet = self.is_quiet();
        self.istat &= !flags;
        if flags & istat::TOKDNE != 0 {
            if let Some(place) = self.completed.pop_front() {
                self.ownership.told(place);
            }
            if let Some(next) = self.completed.front() {
                self.stat = next.as_stat();
                self.istat |= istat::TOKDNE;
            }
        }
        if was_quiet && !self.is_quiet() {
            self.ownership.forget();
        }
    }

    fn write_control(&mut self, value: u8, witness: &mut Witness) {
        if value & ctl::HOSTMODEEN != 0 {
            witness.saw(
                Trap::UsbHostMode,
                "CTL[HOSTMODEEN] was set; the emulator models the device's side only",
            );
        }
        let was_quiet = self.is_quiet();
        let enabled = value & !self.ctl & ctl::USBENSOFEN != 0;
        self.ctl = value;
        if value & ctl::ODDRST != 0 || enabled {
            self.odd = [[false; 2]; 16];
        }
        if was_quiet && !self.is_quiet() {
            self.ownership.forget();
        }
    }

    fn write_address(&mut self, value: u8, witness: &mut Witness) {
        if let Some(address) = self
            .address_to_come
            .filter(|_| value & 0x7F != self.address())
        {
            witness.saw(
                Trap::UsbAddressEarly,
                format!(
                    "ADDR = {value} was written before the status stage of SET_ADDRESS {address} had ended; the host \
                     asks for that status at address {}",
                    self.address()
                ),
            );
        }
        self.addr = value;
    }
}

impl Default for UsbController {
    fn default() -> UsbController {
        UsbController::new()
    }
}
