//! The processor: a Cortex-M4 without FPU or MPU, executed by `rsemu` behind this module's own interface.
//!
//! `rsemu` is young (0.0.x), so nothing outside this file knows it.

use std::sync::Arc;

use rsemu::core::error::BusError;
use rsemu::core::space::{
    AccessConstraints, AddressSpace, Mapping, MappingId, MemAttrs, MemOps, RamStore, Region,
    RomStore, RomWrite,
};
use rsemu::core::value::{Endian, Width};
use rsemu::cpu::arm::v7m::{ArmV7m, Config};

/// Where the 64 KiB of SRAM begin; they end at 0x2000_8000 (K20 manual, "Memory map").
pub const RAM_BASE: u32 = 0x1FFF_8000;

/// Bytes of SRAM.
pub const RAM_SIZE: u32 = 64 * 1024;

/// Bytes of program flash, from address 0.
pub const FLASH_SIZE: u32 = 256 * 1024;

const PERIPHERALS_BASE: u32 = 0x4000_0000;
const PERIPHERALS_SIZE: u32 = 0x0010_0000;
/// FlexNVM and FlexRAM, which the flash module answers for.
const FLEX_REGIONS: [(&str, u32, u64); 2] = [
    ("flexnvm", 0x1000_0000, 32 * 1024),
    ("flexram", 0x1400_0000, 2 * 1024),
];

/// xPSR: ITSTATE, in its two places, and the number of the exception being handled.
const IT_STATE: u32 = 0x0600_FC00;
const EXCEPTION: u32 = 0x1FF;

/// What answers the processor's accesses to the peripheral bridges and to the flash module's memories.
pub trait PeripheralBus: Send + Sync + std::fmt::Debug {
    /// Reads `width` bytes; `None` is a bus error.
    fn read(&self, address: u32, width: u8) -> Option<u32>;
    /// Writes `width` bytes; `false` is a bus error.
    fn write(&self, address: u32, width: u8, value: u32) -> bool;
}

/// The chip's SRAM, which outlives every reset and which USB reads and writes on its own.
#[derive(Debug, Clone)]
pub struct Ram(Arc<RamStore>);

impl Ram {
    /// SRAM as it is after power-on: not zero, so that firmware which relies on zeroed memory is found out.
    pub fn new() -> Ram {
        let store = RamStore::new(u64::from(RAM_SIZE));
        // The pattern differs from byte to byte; any fixed one will do.
        for offset in 0..u64::from(RAM_SIZE) {
            let _ = store.write_u8(offset, (offset as u8).wrapping_mul(167) ^ 0xA5);
        }
        Ram(Arc::new(store))
    }

    /// Reads the 32-bit word at `address`; `None` outside the SRAM.
    pub fn word(&self, address: u32) -> Option<u32> {
        let offset = u64::from(address.checked_sub(RAM_BASE)?);
        self.0
            .read_value(offset, Width::U32, Endian::Little)
            .ok()
            .map(|v| v as u32)
    }

    /// Writes the 32-bit word at `address`; `false` outside the SRAM.
    pub fn set_word(&self, address: u32, value: u32) -> bool {
        address.checked_sub(RAM_BASE).is_some_and(|offset| {
            self.0
                .write_value(
                    u64::from(offset),
                    Width::U32,
                    u64::from(value),
                    Endian::Little,
                )
                .is_ok()
        })
    }

    /// Reads bytes from `address` on; `None` if any lies outside the SRAM. No bytes may be anywhere.
    pub fn bytes(&self, address: u32, length: usize) -> Option<Vec<u8>> {
        let mut bytes = vec![0; length];
        if length > 0 {
            let offset = u64::from(address.checked_sub(RAM_BASE)?);
            self.0.read_at(offset, &mut bytes).ok()?;
        }
        Some(bytes)
    }

    /// Writes bytes from `address` on; `false` if any would lie outside the SRAM.
    pub fn set_bytes(&self, address: u32, bytes: &[u8]) -> bool {
        bytes.is_empty()
            || address
                .checked_sub(RAM_BASE)
                .is_some_and(|offset| self.0.write_at(u64::from(offset), bytes).is_ok())
    }
}

impl Default for Ram {
    fn default() -> Ram {
        Ram::new()
    }
}

/// The processor with its memories.
#[derive(Debug)]
pub struct Cpu {
    core: ArmV7m,
    space: Arc<AddressSpace>,
    flash: MappingId,
    peripherals: Arc<dyn PeripheralBus>,
}

impl Cpu {
    /// A processor about to leave reset, with `flash` at address 0.
    pub fn new(flash: &[u8], ram: &Ram, peripherals: Arc<dyn PeripheralBus>) -> Cpu {
        let space = AddressSpace::new("K20", 32);
        let bridge = |name: &str, base: u32, size: u64| {
            let bridge = Bridge(Arc::clone(&peripherals), base);
            Region::io(name, size, Arc::new(bridge))
        };
        let flash = {
            let mut map = space.topology();
            let mut place = |region: Region, base: u32| {
                map.map(region, u64::from(base))
                    .expect("the chip's regions do not overlap")
            };
            place(Region::ram("sram", Arc::clone(&ram.0)), RAM_BASE);
            place(
                bridge("peripherals", PERIPHERALS_BASE, u64::from(PERIPHERALS_SIZE)),
                PERIPHERALS_BASE,
            );
            for (name, base, size) in FLEX_REGIONS {
                place(bridge(name, base, size), base);
            }
            place(readable(flash), 0)
        };
        let space = Arc::new(space);
        Cpu {
            core: Cpu::core(&space),
            space,
            flash,
            peripherals,
        }
    }

    /// Shows the processor new contents of its flash, or hides them while a command works on the flash: every access
    /// then goes to the flash module.
    pub fn show_flash(&self, contents: Option<&[u8]>) {
        let region = match contents {
            Some(contents) => readable(contents),
            None => {
                let bridge = Bridge(Arc::clone(&self.peripherals), 0);
                Region::io("flash at work", u64::from(FLASH_SIZE), Arc::new(bridge))
            }
        };
        self.space
            .topology()
            .replace(self.flash, Mapping::new(region, 0))
            .expect("the region is as large as the one before");
    }

    fn core(space: &Arc<AddressSpace>) -> ArmV7m {
        // MK20DX256: sixteen interrupt priorities, no memory protection unit.
        let mut config = Config::CORTEX_M4.with_priority_bits(4);
        config.ext.mpu = false;
        let core = ArmV7m::new(config);
        core.attach_space(Arc::clone(space));
        core
    }

    /// A system reset: everything in the core returns to its reset state; memories keep their contents.
    pub fn reset(&mut self) {
        self.core = Cpu::core(&self.space);
    }

    /// Executes one instruction, exception entry or idle cycle; returns the processor cycles it took.
    pub fn step(&self) -> u64 {
        let before = self.core.xpsr();
        if before & IT_STATE == 0 {
            return self.core.step();
        }
        let stack = self.core.reg(13);
        let cycles = self.core.step();
        self.keep_it_state(before, stack);
        cycles
    }

    /// Puts the rest of an IT block into the frame of an exception that interrupted it.
    ///
    /// The architecture stacks ITSTATE with the xPSR (DDI 0403, B1.5.6); rsemu 0.0.7 leaves it out, so
    /// that after the return the rest of the block would be executed whatever its condition.
    fn keep_it_state(&self, before: u32, stack: u32) {
        const SVCALL: u32 = 11;
        let exception = u32::from(self.core.current_exception().0);
        // An entry pushes a frame; a return inside an IT block pops one. A supervisor call has
        // advanced the state, and stands last in its block by the architecture's advice.
        if exception == before & EXCEPTION || exception == SVCALL || self.core.reg(13) > stack {
            return;
        }
        let on_process_stack = self.core.reg(14) & 4 != 0;
        let frame = if on_process_stack {
            self.core.psp()
        } else {
            self.core.msp()
        };
        let stacked = u64::from(frame.wrapping_add(28));
        let attributes = MemAttrs::DEFAULT;
        if let Ok(xpsr) = self.space.read(stacked, Width::U32, attributes) {
            let restored = xpsr | u64::from(before & IT_STATE);
            // A stack outside memory has already become a fault of its own.
            let _ = self.space.write(stacked, Width::U32, restored, attributes);
        }
    }

    /// Whether the core sleeps in WFI or WFE.
    pub fn is_asleep(&self) -> bool {
        self.core.is_asleep()
    }

    /// Whether a fault within a fault has stopped the core for good.
    pub fn is_locked_up(&self) -> bool {
        self.core.is_locked_up()
    }

    /// Whether the program asked for a system reset (AIRCR.SYSRESETREQ).
    pub fn wants_reset(&self) -> bool {
        self.core.reset_requested()
    }

    /// Enables interrupt `irq` as a write to the NVIC would.
    pub fn enable_irq(&self, irq: u16) {
        let exception = rsemu::cpu::arm::v7m::sys::Exception(irq + 16);
        self.core.with_sys(|sys| sys.set_enable(exception, true));
    }

    /// Drives interrupt input `irq`.
    pub fn set_irq(&self, irq: u16, asserted: bool) {
        self.core.set_irq(irq, asserted);
    }

    /// Cycles until SysTick would pend its exception; `None` if it never will.
    pub fn cycles_to_systick(&self) -> Option<u64> {
        self.core.with_sys(|sys| {
            let (enabled, interrupt) = (sys.syst_csr & 1 != 0, sys.syst_csr & 2 != 0);
            (enabled && interrupt && sys.syst_rvr != 0).then(|| match sys.syst_cvr {
                0 => u64::from(sys.syst_rvr) + 1,
                count => u64::from(count),
            })
        })
    }

    /// Lets `cycles` pass in sleep: SysTick counts on, DWT_CYCCNT does not (its clock is gated by WFI).
    pub fn sleep(&self, cycles: u64) {
        const SYSTICK: rsemu::cpu::arm::v7m::sys::Exception =
            rsemu::cpu::arm::v7m::sys::Exception::SYSTICK;
        self.core.with_sys(|sys| {
            if sys.tick_systick(cycles) && sys.syst_csr & 2 != 0 {
                sys.set_pending(SYSTICK, true);
            }
        });
    }

    /// The program counter.
    pub fn pc(&self) -> u32 {
        self.core.pc()
    }

    /// Continues at `address`: how a test makes the program hang or panic where it likes.
    pub fn set_pc(&self, address: u32) {
        self.core.set_pc(address);
    }

    /// Register `number`, 0 to 15.
    pub fn register(&self, number: u8) -> u32 {
        self.core.reg(number)
    }

    /// The main stack pointer.
    pub fn stack_pointer(&self) -> u32 {
        self.core.msp()
    }

    /// Number of the exception being handled; 0 in thread mode, 3 in HardFault, 16 + n in interrupt n.
    pub fn exception(&self) -> u16 {
        self.core.current_exception().0
    }

    /// Reads a 16-bit halfword as a debugger would, without side effects.
    pub fn halfword(&self, address: u32) -> Option<u16> {
        self.space
            .read(u64::from(address), Width::U16, MemAttrs::DEBUG)
            .ok()
            .map(|v| v as u16)
    }
}

/// Flash that can be read and executed, but not stored to.
fn readable(contents: &[u8]) -> Region {
    Region::rom(
        "flash",
        Arc::new(RomStore::from_slice(contents)),
        RomWrite::Fault,
    )
}

/// Adapts [`PeripheralBus`] to the engine's idea of a memory-mapped device at an address.
#[derive(Debug)]
struct Bridge(Arc<dyn PeripheralBus>, u32);

impl MemOps for Bridge {
    fn read(&self, offset: u64, dst: &mut [u8], attrs: MemAttrs) -> Result<(), BusError> {
        if attrs.debug {
            dst.fill(0);
            return Ok(());
        }
        let value = self
            .0
            .read(self.1 + offset as u32, dst.len() as u8)
            .ok_or(BusError::BadAccess)?;
        dst.copy_from_slice(&value.to_le_bytes()[..dst.len()]);
        Ok(())
    }

    fn write(&self, offset: u64, src: &[u8], attrs: MemAttrs) -> Result<(), BusError> {
        if attrs.debug {
            return Ok(());
        }
        let mut bytes = [0; 4];
        bytes[..src.len()].copy_from_slice(src);
        let accepted = self.0.write(
            self.1 + offset as u32,
            src.len() as u8,
            u32::from_le_bytes(bytes),
        );
        if accepted {
            Ok(())
        } else {
            Err(BusError::BadAccess)
        }
    }

    fn constraints(&self) -> AccessConstraints {
        AccessConstraints::IO
            .with_widths(Width::U8, Width::U32)
            .with_natural_alignment(self.1 == PERIPHERALS_BASE)
    }
}
