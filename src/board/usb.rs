//! The serial port: lines and frames out, keys in, and nothing that ever waits for the host.
//!
//! The main program puts whole lines and frames into a queue and takes keys out of another; the USB
//! interrupt does the rest. What finds the queue full is dropped and counted.

mod buffers;
mod bus;
mod descriptors;
mod endpoints;

use core::cell::RefCell;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use cortex_m::peripheral::NVIC;
use critical_section::Mutex;
use heapless::Vec;
use heapless::spsc::{Consumer, Producer, Queue};
use mk20dx_hal::interrupt;
use mk20dx_hal::pac::{self, Interrupt};
use usb_device::bus::UsbBusAllocator;
use usb_device::device::{UsbDevice, UsbDeviceState};
use usbd_serial::CdcAcmClass;
use vrduino::command::{Command, Parser};
use vrduino::wire::LINE_LEN;

use super::breadcrumb::{self, Stage};
use super::loader;
use bus::Bus;

/// Lines that may wait for the host: an INFO block with a verdict on the bias is twelve at once. At the
/// default rate these are 160 ms, so a host which comes back soon has missed nothing, and one which
/// comes back later gets little that is old.
const WAITING_LINES: usize = 16;
/// Keys that may wait for the main program.
const WAITING_KEYS: usize = 64;
/// A packet shorter than the endpoint's 64 bytes ends a transfer by itself.
const PACKET: usize = 63;
/// Below sampling (0x40).
const PRIORITY: u8 = 0x80;

/// A line or a frame.
type Whole = Vec<u8, LINE_LEN>;

static PORT: Mutex<RefCell<Option<&'static mut Port>>> = Mutex::new(RefCell::new(None));
/// Under a name that survives optimisation, so that the emulator can report it.
// SAFETY: no other item has this name.
#[unsafe(export_name = "vrduino_dropped_lines")]
static DROPPED_LINES: AtomicU32 = AtomicU32::new(0);
static OPENED: AtomicBool = AtomicBool::new(false);
static LOADER_ASKED: AtomicBool = AtomicBool::new(false);

/// Lines that found no room since start.
pub fn dropped_lines() -> u32 {
    DROPPED_LINES.load(Ordering::Relaxed)
}

/// The main program's end of the serial port.
pub struct Usb {
    lines: Producer<'static, Whole>,
    keys: Consumer<'static, u8>,
    parser: Parser,
}

impl Usb {
    /// Switches USB on; the host sees the board from here on.
    pub fn new(registers: pac::Usb0, sim: &pac::Sim) -> Usb {
        let lines = cortex_m::singleton!(: Queue<Whole, { WAITING_LINES + 1 }> = Queue::new())
            .expect("the board is taken once");
        let keys = cortex_m::singleton!(: Queue<u8, { WAITING_KEYS + 1 }> = Queue::new())
            .expect("the board is taken once");
        let bus = Bus::new(registers, sim);
        let allocator = cortex_m::singleton!(: UsbBusAllocator<Bus> = UsbBusAllocator::new(bus))
            .expect("the board is taken once");
        let ((lines, lines_out), (keys_in, keys)) = (lines.split(), keys.split());
        let class = CdcAcmClass::new(allocator, 64);
        let device = descriptors::device(allocator, sim);
        let port = Port {
            device,
            class,
            lines: lines_out,
            keys: keys_in,
            current: None,
            open: false,
        };
        let port = cortex_m::singleton!(: Port = port).expect("the board is taken once");
        critical_section::with(|cs| PORT.replace(cs, Some(port)));
        super::enable_interrupt(Interrupt::USB0, PRIORITY);
        Usb {
            lines,
            keys,
            parser: Parser::new(),
        }
    }

    /// Sends a line or a frame, or drops and counts it.
    pub fn send(&mut self, whole: &impl AsRef<[u8]>) {
        let queued =
            Whole::from_slice(whole.as_ref()).is_ok_and(|whole| self.lines.enqueue(whole).is_ok());
        if !queued {
            DROPPED_LINES.store(dropped_lines().wrapping_add(1), Ordering::Relaxed);
        }
        NVIC::pend(Interrupt::USB0);
    }

    /// The next command the host has typed. To be asked until there is none, once a millisecond.
    pub fn command(&mut self) -> Option<Command> {
        if self.keys.peek().is_none() {
            self.parser.idle();
        }
        while let Some(key) = self.keys.dequeue() {
            if let Some(command) = self.parser.push(key) {
                return Some(command);
            }
        }
        None
    }

    /// Whether the host has opened the port since this was last asked.
    pub fn was_opened(&mut self) -> bool {
        let opened = OPENED.load(Ordering::Relaxed);
        OPENED.store(false, Ordering::Relaxed);
        opened
    }

    /// Whether the host has asked for the board's loader.
    pub fn loader_asked(&self) -> bool {
        LOADER_ASKED.load(Ordering::Relaxed)
    }
}

/// The interrupt's end.
struct Port {
    device: UsbDevice<'static, Bus>,
    class: CdcAcmClass<'static, Bus>,
    lines: Consumer<'static, Whole>,
    keys: Producer<'static, u8>,
    /// The line on its way and how much of it is gone.
    current: Option<(Whole, usize)>,
    /// DTR, as it was last.
    open: bool,
}

impl Port {
    fn service(&mut self) {
        while self.device.poll(&mut [&mut self.class]) {}
        if self.class.line_coding().data_rate() == loader::BAUD {
            LOADER_ASKED.store(true, Ordering::Relaxed);
        }
        self.take_keys();
        if self.device.state() == UsbDeviceState::Configured {
            self.notice_opening();
            self.give_lines();
        } else {
            self.open = false;
            // The rest of a line makes no sense to the next host.
            self.current = None;
        }
    }

    /// What the host sends is always taken: a full receive buffer must not stop it from reading.
    fn take_keys(&mut self) {
        let mut packet = [0; 64];
        while let Ok(count) = self.class.read_packet(&mut packet) {
            for &key in packet.iter().take(count) {
                // Sixty-four keys in a millisecond are no person's; the excess is dropped.
                let _ = self.keys.enqueue(key);
            }
        }
    }

    /// Whoever opens the port wants to know what is, not what was.
    fn notice_opening(&mut self) {
        let open = self.class.dtr();
        if open && !self.open {
            while self.lines.dequeue().is_some() {}
            OPENED.store(true, Ordering::Relaxed);
        }
        self.open = open;
    }

    fn give_lines(&mut self) {
        loop {
            if self.current.is_none() {
                self.current = self.lines.dequeue().map(|line| (line, 0));
            }
            let Some((line, sent)) = &mut self.current else {
                return;
            };
            let rest = line.get(*sent..).unwrap_or_default();
            if rest.is_empty() {
                self.current = None;
                continue;
            }
            let packet = rest.get(..PACKET).unwrap_or(rest);
            match self.class.write_packet(packet) {
                Ok(count) => *sent += count,
                // The packet before is still there; the interrupt that reports its end comes back here.
                Err(_) => return,
            }
        }
    }
}

#[cortex_m_rt::interrupt]
fn USB0() {
    static mut SERVED: Option<&'static mut Port> = None;
    breadcrumb::during(Stage::UsbInterrupt, || {
        // Taken here at the first interrupt, so that serving it needs no critical section and sampling
        // is never held up.
        if SERVED.is_none() {
            *SERVED = critical_section::with(|cs| PORT.take(cs));
        }
        if let Some(port) = SERVED {
            port.service();
        }
    });
}
