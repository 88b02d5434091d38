//! The peripheral bridges' slots: what answers at which address, its clock gate, and the width of its registers.

/// A 4 KiB slot of the peripheral bridges (K20 manual, section 4.5).
pub(super) struct Slot {
    pub page: u32,
    pub name: &'static str,
    /// Clock gate as (n, bit) of SIM_SCGCn; `None` is always clocked.
    pub gate: Option<(u32, u32)>,
    /// Bytes of an access; 0 where any width will do.
    pub width: u8,
}

const fn slot(page: u32, name: &'static str, gate: Option<(u32, u32)>, width: u8) -> Slot {
    Slot {
        page,
        name,
        gate,
        width,
    }
}

#[rustfmt::skip]
pub(super) const SLOTS: &[Slot] = &[
    slot(0x00, "AIPS0", None, 4),                slot(0x04, "AXBS", None, 4),
    slot(0x08, "DMA", Some((7, 1)), 0),          slot(0x09, "DMA TCD", Some((7, 1)), 0),
    slot(0x1F, "FMC", None, 4),                  slot(0x20, "FTFL", Some((6, 0)), 0),
    slot(0x21, "DMAMUX", Some((6, 1)), 1),       slot(0x24, "CAN0", Some((6, 4)), 4),
    slot(0x2C, "SPI0", Some((6, 12)), 0),        slot(0x2D, "SPI1", Some((6, 13)), 0),
    slot(0x2F, "I2S0", Some((6, 15)), 4),        slot(0x32, "CRC", Some((6, 18)), 0),
    slot(0x35, "USBDCD", Some((6, 21)), 4),      slot(0x36, "PDB", Some((6, 22)), 4),
    slot(0x37, "PIT", Some((6, 23)), 4),         slot(0x38, "FTM0", Some((6, 24)), 4),
    slot(0x39, "FTM1", Some((6, 25)), 4),        slot(0x3B, "ADC0", Some((6, 27)), 0),
    slot(0x3D, "RTC", Some((6, 29)), 4),         slot(0x3E, "RFVBAT", None, 4),
    slot(0x40, "LPTMR", Some((5, 0)), 4),        slot(0x41, "RFSYS", None, 0),
    slot(0x45, "TSI", Some((5, 5)), 0),          slot(0x47, "SIM", None, 4),
    slot(0x48, "SIM", None, 4),                  slot(0x49, "PORTA", Some((5, 9)), 4),
    slot(0x4A, "PORTB", Some((5, 10)), 4),       slot(0x4B, "PORTC", Some((5, 11)), 4),
    slot(0x4C, "PORTD", Some((5, 12)), 4),       slot(0x4D, "PORTE", Some((5, 13)), 4),
    slot(0x52, "WDOG", None, 2),                 slot(0x61, "EWM", Some((4, 1)), 1),
    slot(0x62, "CMT", Some((4, 2)), 1),          slot(0x64, "MCG", None, 1),
    slot(0x65, "OSC", None, 1),                  slot(0x66, "I2C0", Some((4, 6)), 1),
    slot(0x67, "I2C1", Some((4, 7)), 1),         slot(0x6A, "UART0", Some((4, 10)), 1),
    slot(0x6B, "UART1", Some((4, 11)), 1),       slot(0x6C, "UART2", Some((4, 12)), 1),
    slot(0x72, "USB0", Some((4, 18)), 1),        slot(0x73, "CMP", Some((4, 19)), 1),
    slot(0x74, "VREF", Some((4, 20)), 1),        slot(0x7C, "LLWU", None, 1),
    slot(0x7D, "PMC", None, 1),                  slot(0x7E, "SMC", None, 1),
    slot(0x7F, "RCM", None, 1),                  slot(0x80, "AIPS1", None, 4),
    slot(0xB8, "FTM2", Some((3, 24)), 4),        slot(0xBB, "ADC1", Some((3, 27)), 0),
    slot(0xCC, "DAC0", Some((2, 12)), 0),        slot(0xFF, "GPIO", None, 0),
];

/// The name of the peripheral at `address`, as the manual has it.
pub fn peripheral_at(address: u32) -> Option<&'static str> {
    let page = (address >> 12).checked_sub(0x4_0000)?;
    let slot = SLOTS.iter().find(|slot| slot.page == page)?;
    Some(slot.name)
}
