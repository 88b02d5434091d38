//! The serial port: frames out, keys in, and nothing that ever waits for the host.
//!
//! The main program gives a frame, a line or a binary one, to the controller at once and as one packet, if that is
//! free; else the frame waits, and the USB interrupt gives it when the packet before has gone. A frame that finds no
//! room to wait is dropped and counted.

mod buffers;
mod bus;
mod descriptors;
mod endpoints;
mod outbox;
mod shortcuts;

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use cortex_m::peripheral::NVIC;
use heapless::spsc::{Consumer, Producer, Queue};
use mk20dx_hal::interrupt;
use mk20dx_hal::pac::{self, Interrupt};
use usb_device::bus::UsbBusAllocator;
use usb_device::device::{UsbDevice, UsbDeviceState};
use usbd_serial::CdcAcmClass;
use vrduino::command::{Command, Parser};

use super::breadcrumb::{self, Stage};
use super::loader;
use super::timer;
use bus::Bus;
use outbox::Outbox;

/// Keys that may wait for the main program.
const WAITING_KEYS: usize = 64;
/// A packet shorter than the endpoint's 64 bytes ends a transfer by itself.
const PACKET: usize = 63;
/// Below sampling (0x40).
const PRIORITY: u8 = 0x80;

/// Under a name that survives optimisation, so that the emulator can report it.
// SAFETY: no other item has this name.
#[unsafe(export_name = "vrduino_dropped_lines")]
static DROPPED_LINES: AtomicU32 = AtomicU32::new(0);
static OPENED: AtomicBool = AtomicBool::new(false);
/// When the last frame began, by the board's clock; only while frames are followed.
static FRAME: AtomicU32 = AtomicU32::new(0);
static LOADER_ASKED: AtomicBool = AtomicBool::new(false);

/// The interrupt's end of the port.
struct Shared(UnsafeCell<Option<&'static mut Port>>);

// SAFETY: it is accessed in the USB interrupt, and in `Usb::with_port` while that is masked.
unsafe impl Sync for Shared {}

static PORT: Shared = Shared(UnsafeCell::new(None));

/// Lines that found no room since start.
pub fn dropped_lines() -> u32 {
    DROPPED_LINES.load(Ordering::Relaxed)
}

/// When the host's last frame began, by the board's clock; only while frames are followed.
pub fn last_frame() -> u32 {
    FRAME.load(Ordering::Relaxed)
}

/// The main program's end of the serial port.
pub struct Usb {
    keys: Consumer<'static, u8>,
    parser: Parser,
}

impl Usb {
    /// Switches USB on; the host sees the board from here on.
    pub fn new(registers: pac::Usb0, sim: &pac::Sim) -> Usb {
        let keys = cortex_m::singleton!(: Queue<u8, { WAITING_KEYS + 1 }> = Queue::new())
            .expect("the board is taken once");
        let outbox =
            cortex_m::singleton!(: Outbox = Outbox::new()).expect("the board is taken once");
        let bus = Bus::new(registers, sim);
        let allocator = cortex_m::singleton!(: UsbBusAllocator<Bus> = UsbBusAllocator::new(bus))
            .expect("the board is taken once");
        let (keys_in, keys) = keys.split();
        let class = CdcAcmClass::new(allocator, 64);
        let device = descriptors::device(allocator, sim);
        let port = Port {
            device,
            class,
            waiting: outbox,
            keys: keys_in,
            open: false,
        };
        let port = cortex_m::singleton!(: Port = port).expect("the board is taken once");
        // SAFETY: the interrupt is not enabled yet.
        unsafe { *PORT.0.get() = Some(port) };
        super::enable_interrupt(Interrupt::USB0, PRIORITY);
        Usb {
            keys,
            parser: Parser::new(),
        }
    }

    /// Sends a frame of at most 255 bytes, in one packet if it has at most 63, or drops and counts it.
    pub fn send(&mut self, frame: &(impl AsRef<[u8]> + ?Sized)) {
        self.send_bytes(frame.as_ref());
    }

    #[inline(never)]
    fn send_bytes(&mut self, frame: &[u8]) {
        if self.with_port(|port| port.send(frame)) != Some(true) {
            DROPPED_LINES.store(dropped_lines().wrapping_add(1), Ordering::Relaxed);
        }
    }

    /// Takes down when each frame of the host begins, or no longer does.
    pub fn follow_frames(&mut self, on: bool) {
        self.with_port(|port| port.device.bus().follow_frames(on));
    }

    #[inline(always)]
    fn with_port<T>(&mut self, work: impl FnOnce(&mut Port) -> T) -> Option<T> {
        NVIC::mask(Interrupt::USB0);
        // From here on the interrupt does not come (ARMv7-M, B3.4.1).
        cortex_m::asm::dsb();
        cortex_m::asm::isb();
        // SAFETY: the interrupt is masked, and nobody else has a reference.
        let port = unsafe { &mut *PORT.0.get() };
        let result = port.as_mut().map(|port| work(port));
        // SAFETY: no critical section depends on it.
        unsafe { NVIC::unmask(Interrupt::USB0) };
        result
    }

    /// The next command the host has typed. To be asked until there is none, once a millisecond.
    pub fn command(&mut self) -> Option<Command> {
        if !self.keys.ready() {
            self.parser.idle();
            return None;
        }
        self.read_keys()
    }

    #[inline(never)]
    fn read_keys(&mut self) -> Option<Command> {
        let mut command = None;
        while command.is_none()
            && let Some(key) = self.keys.dequeue()
        {
            command = self.parser.push(key);
        }
        if !self.keys.ready() {
            // There is room again for what waits in the controller.
            NVIC::pend(Interrupt::USB0);
        }
        command
    }

    /// Whether the host has opened the port since this was last asked.
    #[inline(always)]
    pub fn was_opened(&mut self) -> bool {
        let opened = OPENED.load(Ordering::Relaxed);
        if opened {
            OPENED.store(false, Ordering::Relaxed);
        }
        opened
    }

    /// Whether the host has asked for the board's loader.
    #[inline(always)]
    pub fn loader_asked(&self) -> bool {
        LOADER_ASKED.load(Ordering::Relaxed)
    }
}

/// The interrupt's end.
struct Port {
    device: UsbDevice<'static, Bus>,
    class: CdcAcmClass<'static, Bus>,
    waiting: &'static mut Outbox,
    keys: Producer<'static, u8>,
    /// DTR, as it was last.
    open: bool,
}

impl Port {
    /// Gives the frame to the controller, or lets it wait; false if it can do neither.
    fn send(&mut self, frame: &[u8]) -> bool {
        let at_once = self.waiting.is_empty()
            && frame.len() <= PACKET
            && self.device.state() == UsbDeviceState::Configured;
        if at_once && self.class.write_packet(frame).is_ok() {
            return true;
        }
        let taken = self.waiting.push(frame);
        self.give_waiting();
        taken
    }

    fn service(&mut self) {
        if self.device.bus().take_frame() {
            FRAME.store(timer::now(), Ordering::Relaxed);
            if self.device.bus().is_quiet() {
                return;
            }
        }
        // Mostly, a packet has gone, which concerns nobody but the next.
        if !self.device.bus().take_sent() {
            self.service_all();
        }
        self.give_waiting();
    }

    #[inline(never)]
    fn service_all(&mut self) {
        while self.device.poll(&mut [&mut self.class]) {}
        if self.class.line_coding().data_rate() == loader::BAUD {
            LOADER_ASKED.store(true, Ordering::Relaxed);
        }
        self.take_keys();
        if self.device.state() == UsbDeviceState::Configured {
            self.notice_opening();
        } else {
            self.open = false;
            // The rest of a line makes no sense to the next host.
            self.waiting.drop_begun();
        }
    }

    /// What the host sends waits in the controller until there is room for all of it: nothing typed is lost, and the
    /// main program makes room once a millisecond.
    fn take_keys(&mut self) {
        let mut packet = [0; 64];
        while self.keys.capacity() - self.keys.len() >= packet.len() {
            let Ok(count) = self.class.read_packet(&mut packet) else {
                return;
            };
            for &key in packet.iter().take(count) {
                let _ = self.keys.enqueue(key);
            }
        }
    }

    /// Whoever opens the port wants to know what is, not what was.
    fn notice_opening(&mut self) {
        let open = self.class.dtr();
        if open && !self.open {
            self.waiting.clear();
            OPENED.store(true, Ordering::Relaxed);
        }
        self.open = open;
    }

    /// Gives what waits to the controller, as far as it takes it.
    fn give_waiting(&mut self) {
        if self.waiting.is_empty() || self.device.state() != UsbDeviceState::Configured {
            return;
        }
        let mut packet = [0; PACKET];
        loop {
            let count = self.waiting.peek(&mut packet);
            let Some(packet) = packet.get(..count).filter(|packet| !packet.is_empty()) else {
                return;
            };
            match self.class.write_packet(packet) {
                Ok(count) => self.waiting.take(count),
                // The packet before is still there; the interrupt that reports its end comes back here.
                Err(_) => return,
            }
        }
    }
}

#[cortex_m_rt::interrupt]
fn USB0() {
    breadcrumb::during(Stage::UsbInterrupt, || {
        // SAFETY: the main program has no reference while this interrupt is not masked.
        let port = unsafe { &mut *PORT.0.get() };
        if let Some(port) = port {
            port.service();
        }
    });
}
