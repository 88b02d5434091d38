//! Bytes from I2C0 to memory without the core: eDMA channel 0, asked by I2C0 through the multiplexer (K20 manual,
//! chapters "Direct Memory Access Multiplexer" and "Direct Memory Access Controller").

use core::cell::UnsafeCell;

use mk20dx_hal::pac;
use vrduino::sensor::RawSample;

/// The only channel in use; its interrupt is DMA0.
const CHANNEL: usize = 0;
/// DMAMUX_CHCFG: enabled, asked by I2C0 (source 22).
const ASKED_BY_I2C0: u8 = 1 << 7 | 22;
/// TCD_CSR: interrupt at the end of the major loop, and no further requests from then on.
const INTERRUPT_AND_END: u16 = 1 << 1 | 1 << 3;

/// Room for the longest transfer, in whole words.
pub const CAPACITY: usize = 16;

/// Where received bytes go, in words so that four are read at once.
#[repr(C, align(4))]
struct Received(UnsafeCell<[u32; CAPACITY / 4]>);

// SAFETY: it is accessed by the controller, and through `Dma`, of which there is one.
unsafe impl Sync for Received {}

static RECEIVED: Received = Received(UnsafeCell::new([0; CAPACITY / 4]));

/// The channel.
pub struct Dma {
    registers: pac::Dma,
}

impl Dma {
    /// Clocks controller and multiplexer, and sets up what is the same for every transfer: byte after byte from I2C0_D
    /// to consecutive places.
    pub fn new(registers: pac::Dma, multiplexer: pac::Dmamux, sim: &pac::Sim) -> Dma {
        sim.scgc6().modify(|_, w| w.dmamux().enabled());
        sim.scgc7().modify(|_, w| w.dma().enabled());
        let descriptor = registers.tcd(CHANNEL);
        // SAFETY: the module is always there, and only the address of its register is taken.
        let data = unsafe { &*pac::I2c0::PTR }.d().as_ptr() as u32;
        // SAFETY: a register that is one byte wide; reading it starts the next byte, nothing else.
        descriptor.saddr().write(|w| unsafe { w.bits(data) });
        // SAFETY: the source stays where it is.
        descriptor.soff().write(|w| unsafe { w.bits(0) });
        // SAFETY: bytes on both sides, no modulo.
        descriptor.attr().write(|w| unsafe { w.bits(0) });
        // SAFETY: one byte for each request.
        descriptor.nbytes_mlno().write(|w| unsafe { w.bits(1) });
        // SAFETY: no adjustment of the source at the end.
        descriptor.slast().write(|w| unsafe { w.bits(0) });
        // SAFETY: the next byte goes behind the one before.
        descriptor.doff().write(|w| unsafe { w.bits(1) });
        // SAFETY: nor of the destination, which is set anew for each transfer.
        descriptor.dlastsga().write(|w| unsafe { w.bits(0) });
        // SAFETY: neither linked nor scattered.
        descriptor
            .csr()
            .write(|w| unsafe { w.bits(INTERRUPT_AND_END) });
        // SAFETY: a source of this chip; the channel does not listen yet.
        multiplexer
            .chcfg(CHANNEL)
            .write(|w| unsafe { w.bits(ASKED_BY_I2C0) });
        Dma { registers }
    }

    /// The next `count` bytes, 1 to 16 with those before them, go to the places from `from` on.
    #[inline(always)]
    pub fn receive(&mut self, from: usize, count: usize) {
        let from = from.min(CAPACITY - 1);
        let count = count.clamp(1, CAPACITY - from) as u16;
        let descriptor = self.registers.tcd(CHANNEL);
        let to = RECEIVED.0.get() as u32 + from as u32;
        // SAFETY: `count` places from here on lie within RECEIVED.
        descriptor.daddr().write(|w| unsafe { w.bits(to) });
        // SAFETY: at least 1, and not linked.
        descriptor
            .biter_elinkno()
            .write(|w| unsafe { w.bits(count) });
        // SAFETY: the same as BITER, as the controller asks.
        descriptor
            .citer_elinkno()
            .write(|w| unsafe { w.bits(count) });
        // SAFETY: the number of a channel that is set up.
        self.registers
            .serq()
            .write(|w| unsafe { w.bits(CHANNEL as u8) });
    }

    /// Ends a transfer that has come to nothing.
    pub fn stop(&mut self) {
        // SAFETY: the number of a channel.
        self.registers
            .cerq()
            .write(|w| unsafe { w.bits(CHANNEL as u8) });
        self.clear_interrupt();
    }

    /// To be called in the interrupt.
    #[inline(always)]
    pub fn clear_interrupt(&mut self) {
        // SAFETY: the number of a channel.
        self.registers
            .cint()
            .write(|w| unsafe { w.bits(CHANNEL as u8) });
    }

    /// Puts a byte where the controller would.
    #[inline(always)]
    pub fn put(&mut self, at: usize, byte: u8) {
        let place = RECEIVED.0.get().cast::<u8>();
        // SAFETY: within RECEIVED.
        let place = unsafe { place.add(at.min(CAPACITY - 1)) };
        // SAFETY: the other user of RECEIVED, the controller, is not at this place.
        unsafe { place.write_volatile(byte) }
    }

    /// What has come in, once the transfer is over.
    #[inline(always)]
    pub fn bytes(&self) -> Bytes {
        // SAFETY: aligned and initialised; volatile, since the controller has written it.
        Bytes(unsafe { RECEIVED.0.get().read_volatile() })
    }
}

/// Received bytes, in words, which are copied four times as fast.
pub struct Bytes([u32; CAPACITY / 4]);

impl Bytes {
    /// As a sample: the bytes of a burst, and one more.
    #[inline(always)]
    pub fn sample(&self) -> RawSample {
        let [burst @ .., _] = self.array();
        RawSample::from_burst(&burst)
    }

    /// One by one.
    #[inline(always)]
    pub fn array(&self) -> [u8; CAPACITY] {
        let [
            [b0, b1, b2, b3],
            [b4, b5, b6, b7],
            [b8, b9, b10, b11],
            [b12, b13, b14, b15],
        ] = self.0.map(u32::to_le_bytes);
        // Spelt out: a loop is compiled to one.
        [
            b0, b1, b2, b3, b4, b5, b6, b7, b8, b9, b10, b11, b12, b13, b14, b15,
        ]
    }
}
