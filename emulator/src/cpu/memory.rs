//! The memories that the processor sees, and the door to the peripherals.

use std::sync::Arc;

use rsemu::core::error::BusError;
use rsemu::core::space::{
    AccessConstraints, AddressSpace, Mapping, MappingId, MemAttrs, MemOps, RamStore, Region,
    RomStore, RomWrite,
};
use rsemu::core::value::{Endian, Width};

use super::op::Op;
use super::{Cpu, FLASH_SIZE, RAM_BASE, RAM_SIZE};

const PERIPHERALS_BASE: u32 = 0x4000_0000;
const PERIPHERALS_SIZE: u32 = 0x0010_0000;
/// The miscellaneous control module, on the private peripheral bus.
const MCM_BASE: u32 = 0xE008_0000;
const MCM_SIZE: u32 = 0x1000;
const FLEXNVM_BASE: u32 = 0x1000_0000;
const FLEXNVM_SIZE: u32 = 32 * 1024;
const FLEXRAM_BASE: u32 = 0x1400_0000;
const FLEXRAM_SIZE: u32 = 2 * 1024;

/// What answers the processor's accesses to the peripheral bridges and to the flash module's memories.
pub trait PeripheralBus: Send + Sync + std::fmt::Debug {
    /// Reads `width` bytes; `None` is a bus error.
    fn read(&self, address: u32, width: u8) -> Option<u32>;
    /// Writes `width` bytes; `false` is a bus error.
    fn write(&self, address: u32, width: u8, value: u32) -> bool;
}

/// The chip's SRAM, which outlives every reset and which USB reads and writes on its own.
#[derive(Clone)]
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

impl Ram {
    /// Another SRAM with the same contents; a clone is another handle of the same one.
    pub fn copy(&self) -> Ram {
        let copy = Ram::new();
        let bytes = self.bytes(RAM_BASE, RAM_SIZE as usize).unwrap_or_default();
        copy.set_bytes(RAM_BASE, &bytes);
        copy
    }
}

/// Without its contents, and without the address it happens to have on this computer.
impl std::fmt::Debug for Ram {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Ram")
    }
}

impl Default for Ram {
    fn default() -> Ram {
        Ram::new()
    }
}

/// The chip's memory map (K20 manual, section 4.2), as far as it can change.
#[derive(Debug)]
pub(super) struct Map {
    flash: MappingId,
    peripherals: Arc<dyn PeripheralBus>,
}

impl Map {
    /// The map with `flash` at address 0.
    pub(super) fn new(
        flash: &[u8],
        ram: &Ram,
        peripherals: Arc<dyn PeripheralBus>,
    ) -> (Arc<AddressSpace>, Map) {
        let space = AddressSpace::new("K20", 32);
        let door = |name: &str, base: u32, size: u32| {
            let bridge = Bridge(Arc::clone(&peripherals), base);
            (base, Region::io(name, u64::from(size), Arc::new(bridge)))
        };
        let flash = {
            let mut map = space.topology();
            let mut place = |(base, region): (u32, Region)| {
                map.map(region, u64::from(base))
                    .expect("the chip's regions do not overlap")
            };
            place((RAM_BASE, Region::ram("sram", Arc::clone(&ram.0))));
            place(door("flexnvm", FLEXNVM_BASE, FLEXNVM_SIZE));
            place(door("flexram", FLEXRAM_BASE, FLEXRAM_SIZE));
            place(door("mcm", MCM_BASE, MCM_SIZE));
            place(door("peripherals", PERIPHERALS_BASE, PERIPHERALS_SIZE));
            place((0, readable(flash)))
        };
        (Arc::new(space), Map { flash, peripherals })
    }

    /// Puts new contents into the flash, or the flash module in its place.
    fn show_flash(&self, space: &AddressSpace, contents: Option<&[u8]>) {
        let region = match contents {
            Some(contents) => readable(contents),
            None => {
                let bridge = Bridge(Arc::clone(&self.peripherals), 0);
                Region::io("flash at work", u64::from(FLASH_SIZE), Arc::new(bridge))
            }
        };
        space
            .topology()
            .replace(self.flash, Mapping::new(region, 0))
            .expect("the region is as large as the one before");
    }
}

impl Cpu {
    /// Shows the processor new contents of its flash, or hides them while a command works on the flash: every access
    /// then goes to the flash module.
    pub fn show_flash(&mut self, contents: Option<&[u8]>) {
        self.map.show_flash(&self.space, contents);
        self.code.fill(Op::UNMET);
    }
}

/// Flash that can be read and executed, but not stored to.
fn readable(contents: &[u8]) -> Region {
    let store = Arc::new(RomStore::from_slice(contents));
    Region::rom("flash", store, RomWrite::Fault)
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
        if attrs.purpose.is_fetch() && self.1 != 0 {
            return Err(BusError::BadAccess);
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
