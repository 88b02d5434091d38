//! Switches the watchdog off, in time (K20 manual, WDOG).

// SAFETY: the start-up code calls this once, before memory is initialised; it uses none.
#[unsafe(no_mangle)]
extern "C" fn __pre_init() {
    const UNLOCK: *mut u16 = 0x4005_200E as *mut u16;
    const STCTRLH: *mut u16 = 0x4005_2000 as *mut u16;
    // SAFETY: a register of the chip.
    unsafe { UNLOCK.write_volatile(0xC520) };
    // SAFETY: as above.
    unsafe { UNLOCK.write_volatile(0xD928) };
    // SAFETY: as above.
    unsafe { STCTRLH.write_volatile(0x01D2) };
}
