//! Reading and writing the chip, right or wrong.

use crate::registers::*;

/// The flash configuration field: unsecured.
#[cfg(target_os = "none")]
#[used]
// SAFETY: the section holds these sixteen bytes and nothing else; `memory.x` checks its place and size.
#[unsafe(link_section = ".flashconfig")]
static FLASH_CONFIGURATION: [u8; 16] = [
    0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xDE, 0xF9, 0xFF, 0xFF,
];

/// Writes a register, or whatever else is at `address`.
#[inline(always)]
pub fn write<T>(address: u32, value: T) {
    // SAFETY: none is promised. An image holds nothing that a stray write could spoil, and doing what must not be done
    // is what it is for.
    unsafe { core::ptr::write_volatile(address as *mut T, value) }
}

/// Reads a register, or whatever else is at `address`.
#[inline(always)]
pub fn read<T>(address: u32) -> T {
    // SAFETY: as for `write`; every `T` used here is an integer, for which any bytes do.
    unsafe { core::ptr::read_volatile(address as *const T) }
}

/// Waits until `register` and `mask` give `value`; a chip that works gets there.
pub fn wait(register: u32, mask: u8, value: u8) {
    while read::<u8>(register) & mask != value {}
}

/// Does nothing any more.
pub fn idle() -> ! {
    loop {
        core::hint::spin_loop();
    }
}

/// Switches the watchdog off, in time.
#[inline(always)]
pub fn disable_watchdog() {
    write(WDOG_UNLOCK, 0xC520u16);
    write(WDOG_UNLOCK, 0xD928u16);
    write(WDOG_STCTRLH, 0x01D2u16);
}

/// Keeps the watchdog on, with a time-out of 100 ms of its 1 kHz oscillator.
#[inline(always)]
pub fn run_watchdog() {
    configure_watchdog(0x01D1);
}

/// The same with a window: no refresh in the first 50 ms.
#[inline(always)]
pub fn run_watchdog_with_window() {
    configure_watchdog(0x01D9);
}

#[inline(always)]
fn configure_watchdog(control: u16) {
    write(WDOG_UNLOCK, 0xC520u16);
    write(WDOG_UNLOCK, 0xD928u16);
    write(WDOG_TOVALH, 0u16);
    write(WDOG_TOVALL, 100u16);
    write(WDOG_PRESC, 0u16);
    write(WDOG_WINH, 0u16);
    write(WDOG_WINL, 50u16);
    write(WDOG_STCTRLH, control);
}

/// From FEI to FBE: the crystal drives the core.
pub fn use_crystal() {
    write(OSC_CR, 0x8Au8);
    write(MCG_C2, 0x24u8);
    write(MCG_C1, 0xA0u8);
    wait(MCG_S, 0x02, 0x02);
    wait(MCG_S, 0x10, 0x00);
    wait(MCG_S, 0x0C, 0x08);
}

/// From FBE to PBE with the PLL at 16 MHz / `divider` × `multiplier`, and waits until it has locked.
pub fn start_pll(divider: u8, multiplier: u8) {
    write(MCG_C5, divider - 1);
    write(MCG_C6, 0x40 | (multiplier - 24));
    wait(MCG_S, 0x20, 0x20);
    wait(MCG_S, 0x40, 0x40);
}

/// From PBE to PEE.
pub fn use_pll() {
    write(MCG_C1, 0x20u8);
    wait(MCG_S, 0x0C, 0x0C);
}

/// Clocks, pins and speed of the sensor bus: 20.97 MHz / 64, about 328 kHz.
pub fn start_i2c() {
    write(SIM_SCGC4, 0xF010_0030u32 | 1 << 6);
    write(SIM_SCGC5, 0x0004_0182u32 | 1 << 10);
    write(PORTB_PCR2, 0x0000_0200u32);
    write(PORTB_PCR3, 0x0000_0200u32);
    write(I2C0_F, 0x12u8);
    write(I2C0_C1, 0x80u8);
}

/// START, and the sensor's address for writing.
pub fn address_sensor() {
    write(I2C0_C1, 0xB0u8);
    write(I2C0_D, 0xD0u8);
    end_of_byte();
}

/// The sensor's address on the bus.
pub const SENSOR: u8 = 0x68;

/// The magnetometer's, behind the sensor.
pub const MAGNETOMETER: u8 = 0x0C;

/// Sends `byte` and waits until it has gone.
fn send(byte: u8) {
    write(I2C0_D, byte);
    end_of_byte();
}

/// STOP, and a moment for the bus to become free.
fn stop() {
    write(I2C0_C1, 0x80u8);
    wait(I2C0_S, 0x20, 0x00);
}

/// Lets the sensor start after power-on.
#[cfg(target_os = "none")]
pub fn wait_for_sensor() {
    pause(700_000);
}

/// Writes a register of the device at `address`.
pub fn write_sensor(address: u8, register: u8, value: u8) {
    write(I2C0_C1, 0xB0u8);
    send(address << 1);
    send(register);
    send(value);
    stop();
}

/// Reads a register of the device at `address`.
pub fn read_sensor(address: u8, register: u8) -> u8 {
    write(I2C0_C1, 0xB0u8);
    send(address << 1);
    send(register);
    write(I2C0_C1, 0xB4u8);
    send(address << 1 | 1);
    // Receive, and leave the only byte unacknowledged.
    write(I2C0_C1, 0xA8u8);
    read::<u8>(I2C0_D);
    end_of_byte();
    stop();
    read::<u8>(I2C0_D)
}

/// Waits for the end of a byte on the bus.
pub fn end_of_byte() {
    wait(I2C0_S, 0x02, 0x02);
    write(I2C0_S, 0x02u8);
}

/// Instructions that only assembly can ask for.
#[cfg(target_os = "none")]
mod assembly {
    use core::arch::asm;

    /// Passes some time: at least so many cycles.
    #[inline(always)]
    pub fn pause(cycles: u32) {
        for _ in 0..cycles / 2 {
            // SAFETY: does nothing.
            unsafe { asm!("nop") }
        }
    }

    /// Calls whatever is at `address`.
    pub fn call(address: u32) {
        // SAFETY: none is promised; the address is wrong on purpose.
        unsafe { asm!("blx {}", in(reg) address, clobber_abi("C")) }
    }

    /// Executes `vmov s0, r0`, given by its code since the assembler for this chip refuses it.
    pub fn fpu_instruction() {
        // SAFETY: the processor has no such register; it faults.
        unsafe { asm!(".inst.w 0xEE000A10") }
    }

    /// Sleeps, whatever happens.
    pub fn sleep() -> ! {
        loop {
            // SAFETY: waits for an interrupt.
            unsafe { asm!("wfi") }
        }
    }

    /// Executes UDF.
    pub fn undefined_instruction() {
        // SAFETY: the processor faults.
        unsafe { asm!("udf #0") }
    }

    /// Sets FAULTMASK.
    pub fn mask_faults() {
        // SAFETY: only keeps handlers from running.
        unsafe { asm!("cpsid f") }
    }

    /// Sets PRIMASK.
    pub fn mask_interrupts() {
        // SAFETY: only keeps handlers from running.
        unsafe { asm!("cpsid i") }
    }

    /// Executes SVC.
    pub fn supervisor_call() {
        // SAFETY: an exception like any other.
        unsafe { asm!("svc #0") }
    }

    /// Executes BKPT.
    pub fn breakpoint() {
        // SAFETY: the processor faults; 0 and 251 would call the board's loader.
        unsafe { asm!("bkpt #1") }
    }

    /// Loads two words at once.
    pub fn load_two_words(address: u32) {
        // SAFETY: reads memory only; the address is not aligned on purpose.
        unsafe { asm!("ldrd {0}, {1}, [{2}]", out(reg) _, out(reg) _, in(reg) address) }
    }

    /// Divides with the processor's own instruction.
    pub fn divide(dividend: u32, divisor: u32) {
        // SAFETY: a division by zero faults, as it is meant to.
        unsafe { asm!("udiv {0}, {1}, {2}", out(reg) _, in(reg) dividend, in(reg) divisor) }
    }

    /// Uses another main stack for a moment.
    pub fn use_stack(stack: u32) {
        // SAFETY: what is below `stack` is given away for it, and the old one comes back at the end.
        unsafe {
            asm!(
                "mrs {0}, msp",
                "msr msp, {1}",
                "push {{r0-r3}}",
                "pop {{r0-r3}}",
                "msr msp, {0}",
                out(reg) _,
                in(reg) stack
            )
        }
    }

    /// Moves the stack and takes an exception.
    pub fn svc_with_stack(stack: u32) {
        // SAFETY: none is promised; nothing can be pushed there.
        unsafe { asm!("mov sp, {}", "svc #0", in(reg) stack) }
    }
}

#[cfg(target_os = "none")]
pub use assembly::*;
