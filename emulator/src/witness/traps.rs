//! The catalogue of traps: each with its name and the rule it enforces.

/// Declares [`Trap`] from one readable list.
macro_rules! traps {
    ($($(#[$doc:meta])* $trap:ident $name:literal $rule:literal)*) => {
        /// A rule that a program can break, and that silicon does not forgive.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Trap {
            $($(#[$doc])* $trap,)*
        }

        impl Trap {
            /// Every trap, in the order of the path from reset to the stream.
            pub const ALL: &[Trap] = &[$(Trap::$trap),*];

            /// Its name, as messages and `--allow` have it.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Trap::$trap => $name,)*
                }
            }

            /// What the manual says, with its place.
            pub const fn rule(self) -> &'static str {
                match self {
                    $(Trap::$trap => $rule,)*
                }
            }
        }
    };
}

traps! {
    // Watchdog.
    /// Not unlocked in time after reset.
    WatchdogNotUnlocked "watchdog-not-unlocked"
        "the watchdog has to be unlocked within 256 bus cycles of reset, else it resets the chip (K20 manual 23.3.2)"
    /// Too long between the two unlock words.
    WatchdogUnlockSlow "watchdog-unlock-slow"
        "0xD928 has to follow 0xC520 within 20 bus cycles; keep interrupts off and both writes together (K20 manual 23.3.1)"
    /// Wrong unlock word.
    WatchdogUnlockSequence "watchdog-unlock-sequence"
        "the unlock sequence is 0xC520, then 0xD928; anything else resets the chip (K20 manual 23.3.1)"
    /// Unlocked and left alone.
    WatchdogNotConfigured "watchdog-not-configured"
        "after unlocking, at least one register has to be written within 256 bus cycles, else the chip is reset (K20 manual 23.3.2)"
    /// A configuration register written while it is locked.
    WatchdogLocked "watchdog-locked"
        "watchdog registers can be written once after each unlocking, within 256 bus cycles; other writes are lost (K20 manual 23.3.2)"
    /// Too long between the two refresh words.
    WatchdogRefreshSlow "watchdog-refresh-slow"
        "0xB480 has to follow 0xA602 within 20 bus cycles; keep interrupts off and both writes together (K20 manual 23.7.7)"
    /// Wrong refresh word.
    WatchdogRefreshSequence "watchdog-refresh-sequence"
        "the refresh sequence is 0xA602, then 0xB480; anything else resets the chip (K20 manual 23.7.7)"
    /// Refreshed before its window opened.
    WatchdogRefreshEarly "watchdog-refresh-early"
        "in window mode a refresh before WINH:WINL has passed resets the chip (K20 manual 23.7.6)"
    /// Not refreshed in time.
    WatchdogTimeout "watchdog-timeout"
        "an enabled watchdog has to be refreshed before TOVALH:TOVALL has passed, else it resets the chip (K20 manual, chapter Watchdog Timer)"

    // Clocks.
    /// The clock generator was asked for a mode it cannot enter from here.
    ClockTransition "clock-transition"
        "the MCG changes between neighbouring modes only: FEI, FEE, FBI and FBE among each other, then FBE - PBE - PEE (K20 manual, MCG mode state diagram)"
    /// PLL divider or multiplier changed under a running PLL.
    PllChanged "pll-changed"
        "PRDIV0 and VDIV0 must not change while the PLL is on (K20 manual, MCG_C5 and MCG_C6)"
    /// PLL reference out of range.
    PllReference "pll-reference"
        "the PLL's reference, crystal over PRDIV0, has to lie between 2 and 4 MHz (K20 data sheet, MCG specifications)"
    /// FLL reference out of range.
    FllReference "fll-reference"
        "the FLL's external reference, crystal over FRDIV, has to lie between 31.25 and 39.0625 kHz (K20 manual, MCG_C1[FRDIV])"
    /// Core clock too fast.
    CoreOverSpeed "core-over-speed"
        "the core runs at 72 MHz at most (K20 data sheet, device clock specifications)"
    /// Bus clock too fast.
    BusOverSpeed "bus-over-speed"
        "the bus clock is 50 MHz at most (K20 data sheet, device clock specifications); set OUTDIV2 before the faster clock"
    /// Flash clock too fast.
    FlashOverSpeed "flash-over-speed"
        "the flash clock is 25 MHz at most (K20 data sheet, device clock specifications); set OUTDIV4 before the faster clock"
    /// Clocks that do not divide each other.
    ClockRatio "clock-ratio"
        "bus and flash clock have to be whole divisions of the core clock; the flash clock no faster than the bus clock and no slower than an eighth of the core clock (K20 manual, clock definitions)"
    /// The USB module runs from something else than 48 MHz.
    UsbClock "usb-clock"
        "the USB module needs 48 MHz from the PLL or FLL through SIM_CLKDIV2 (K20 manual, USB FS OTG controller clocking)"

    // Memory and bridges.
    /// Access to a peripheral whose clock is off.
    ClockGated "clock-gated"
        "an access to a peripheral whose gate in SIM_SCGCn is closed ends in a bus error (K20 manual 5.6, clock gating)"
    /// Access to a place of the peripheral bridges where nothing is.
    UnmappedPeripheral "unmapped-peripheral"
        "the bridges' slots without a peripheral answer with a bus error (K20 manual 4.5, peripheral bridge memory maps)"
    /// Access with the wrong width.
    AccessWidth "access-width"
        "a register has to be accessed with its own width (K20 manual, the module's memory map)"
    /// Access where no memory is.
    UnmappedMemory "unmapped-memory"
        "this chip has 256 KiB of flash from 0, 2 KiB of FlexRAM from 0x14000000, 64 KiB of SRAM around 0x20000000 and its peripherals; all else is a bus error (K20 manual 4.2)"
    /// An unaligned access across the middle of the SRAM.
    SramBoundary "sram-boundary"
        "SRAM_L ends and SRAM_U begins at 0x20000000; an access that lies in both is a bus error (K20 manual 3.5.3.2)"
    /// A store to flash.
    FlashStore "flash-store"
        "program flash is written by FTFL commands; a store to it is a bus error (K20 manual, flash memory module)"
    /// Fetching an instruction from where none can be.
    ExecuteNever "execute-never"
        "peripherals and system space cannot be executed (ARMv7-M, B3.1)"

    // Processor.
    /// A floating-point instruction.
    FpuInstruction "fpu-instruction"
        "the MK20DX256's Cortex-M4 has no FPU: build for thumbv7em-none-eabi without target-cpu or target-feature (K20 manual 3.2)"
    /// An instruction the processor does not have.
    UndefinedInstruction "undefined-instruction"
        "the Cortex-M4 has no such instruction: UsageFault, UNDEFINSTR (ARMv7-M, B1.5.14)"
    /// A branch to an even address, or a broken exception return.
    InvalidState "invalid-state"
        "the processor has Thumb state only: targets of BX and vectors need bit 0 set (ARMv7-M, B1.5.14)"
    /// An unaligned access where none is possible.
    UnalignedAccess "unaligned-access"
        "LDM, STM, LDRD, STRD, exclusive and peripheral accesses have to be aligned (ARMv7-M, A3.2.1 and A3.5.7)"
    /// A division by zero with CCR.DIV_0_TRP set.
    DivideByZero "divide-by-zero"
        "with CCR.DIV_0_TRP set a division by zero is a UsageFault (ARMv7-M, B3.2.8)"
    /// A supervisor call that cannot be taken.
    SvcEscalated "svc-escalated"
        "an SVC with interrupts masked, or from a handler as urgent as its own, is a HardFault (ARMv7-M, B1.5.4)"
    /// A breakpoint without a debugger.
    Breakpoint "breakpoint"
        "without a debugger BKPT is a HardFault (ARMv7-M, C1.5)"
    /// The stack pointer has left the RAM or cannot be pushed to.
    StackOutside "stack-outside"
        "exception entry and return need their frame in memory (ARMv7-M, B1.5.14, STKERR and UNSTKERR)"
    /// The stack has grown into the program's variables.
    StackIntoData "stack-into-data"
        "nothing on this chip protects variables from the stack: the image's static data ends above the stack pointer"
    /// A fault that a fault handler could not take.
    Lockup "lockup"
        "a fault within HardFault or NMI locks the processor up, and the chip resets (ARMv7-M, B1.5.15)"
    /// An interrupt whose handler never removes its cause.
    InterruptStorm "interrupt-storm"
        "a level-sensitive interrupt is taken again until its flag is cleared (Cortex-M4 generic user guide 4.2.9)"

    // Flash commands.
    /// A command that the controller refuses.
    FlashCommand "flash-command"
        "a command with an unknown code, an unaligned or impossible address sets ACCERR and does nothing (K20 manual, FTFL command descriptions)"
    /// A command written while another one runs.
    FlashBusy "flash-busy"
        "command registers must not be written while CCIF is 0 (K20 manual, FTFL_FSTAT)"
    /// A command launched over the last one's error flags.
    FlashErrorFlags "flash-error-flags"
        "ACCERR and FPVIOL have to be cleared before the next command; until then CCIF cannot launch one (K20 manual, FTFL_FSTAT)"
    /// Erasing or programming a protected region.
    FlashProtected "flash-protected"
        "a command on a region that FPROT, FEPROT or FDPROT protects sets FPVIOL and does nothing (K20 manual, FTFL_FPROTn)"
    /// Programming what is not erased.
    FlashNotErased "flash-not-erased"
        "a longword has to be erased before it is programmed; cumulative programming is not allowed (K20 manual, FTFL Program Longword)"
    /// Code executed from, or data read of, a flash block that a command works on.
    FlashReadWhileWrite "flash-read-while-write"
        "a block must not be read while a command erases or programs it: run the command from RAM or the other block (K20 manual, FTFL, read while write)"
    /// The flash configuration field would lock the chip.
    FlashSecured "flash-secured"
        "the byte at 0x40C has to stay 0xDE or 0xFE: a secured chip cannot be reprogrammed by the Teensy's loader (K20 manual, flash security)"
    /// FlexRAM used as EEPROM while it is not.
    EepromNotReady "eeprom-not-ready"
        "FlexRAM is EEPROM only after Program Partition, and may be accessed only while EEERDY is 1 (K20 manual, FTFL_FCNFG)"

    // Sensor bus.
    /// A pin that is not connected to the module that uses it.
    I2cPinMux "i2c-pin-mux"
        "PTB2 and PTB3 reach I2C0 with MUX = 2 in their PORTB_PCRn (K20 manual 10.3.1, signal multiplexing)"
    /// Lines that nothing pulls up.
    I2cNoPullUp "i2c-no-pull-up"
        "SCL and SDA are open-drain: without a pull-up they never become high (I2C-bus specification, 3.1.1)"
    /// A START on a bus that is busy.
    I2cStartWhileBusy "i2c-start-while-busy"
        "setting MST while S[BUSY] is set loses arbitration (K20 manual, I2C, arbitration procedure)"
    /// A repeated START with a multiplier.
    I2cRepeatedStartMultiplier "i2c-repeated-start-multiplier"
        "with F[MULT] other than 0 a repeated START is not generated (erratum e6070)"
    /// D was read before the byte was there.
    I2cDataEarly "i2c-data-early"
        "D may be read only after TCF or IICIF says that the byte is complete (K20 manual, I2Cx_D)"
    /// D was written before the last byte had gone.
    I2cDataOverwritten "i2c-data-overwritten"
        "D may be written only after TCF or IICIF says that the last byte has gone (K20 manual, I2Cx_D)"
    /// D was written while the bus is not ours.
    I2cNotMaster "i2c-not-master"
        "a byte is sent only as a master with TX set, after START (K20 manual, I2Cx_C1)"
    /// The last byte read was acknowledged before STOP.
    I2cStopAfterAck "i2c-stop-after-ack"
        "a master receiver has to leave the last byte unacknowledged, else the target drives SDA and STOP may not come (I2C-bus specification 3.1.6)"
    /// DMA requests were switched on over a byte that is complete already.
    I2cDmaEarly "i2c-dma-early"
        "requests come from the transfer complete flag: whether one that already stands asks at once is not documented, so DMAEN is set while a byte is on its way (K20 manual, I2C, DMA support)"
    /// DMA was still on at the last byte.
    I2cDmaLastByte "i2c-dma-last-byte"
        "a master receiver has to leave DMA before the last byte ends, to set TXAK for it and to end the transfer (K20 manual, I2C, DMA support)"
    /// The bus runs faster than a device on it can.
    I2cTooFast "i2c-too-fast"
        "the MPU-9250's registers are accessed at 400 kHz at most (product specification, I2C timing)"

    // USB.
    /// The buffer descriptor table is not where the controller can find it.
    UsbTableAlignment "usb-table-alignment"
        "the buffer descriptor table has to be aligned to 512 bytes: BDTPAGE holds address bits 31 to 9 (K20 manual, USB, buffer descriptor table)"
    /// The buffer descriptor table is nowhere.
    UsbTableOutside "usb-table-outside"
        "the controller fetches buffer descriptors from the address in BDTPAGE3:BDTPAGE2:BDTPAGE1, which has to be in RAM (K20 manual, USB, buffer descriptor table)"
    /// A buffer is nowhere.
    UsbBufferOutside "usb-buffer-outside"
        "a descriptor's 32-bit buffer address and its byte count have to stay in RAM (K20 manual, USB, buffer descriptor fields)"
    /// A descriptor was changed under the controller's hands.
    UsbDescriptorOwned "usb-descriptor-owned"
        "while OWN is set the program must not change a descriptor, except where no token is processed: TXSUSPENDTOKENBUSY, ODDRST, EPSTALL, a bus reset (K20 manual, USB, buffer descriptor fields)"
    /// A buffer was given to the controller twice.
    UsbBufferTwice "usb-buffer-twice"
        "a buffer is the controller's or the program's: it may be given again only after STAT has shown its token, and to one descriptor (K20 manual, USB, buffer descriptor table and USBx_STAT)"
    /// A packet from the host does not fit.
    UsbBufferTooSmall "usb-buffer-too-small"
        "a packet larger than the descriptor's byte count is cut off and sets ERRSTAT[DMAERR] (K20 manual, USBx_ERRSTAT)"
    /// Not the toggle that is due.
    UsbToggle "usb-toggle"
        "a pipe's packets alternate between DATA0 and DATA1, from DATA0 on after SET_CONFIGURATION, SET_INTERFACE and CLEAR_FEATURE(ENDPOINT_HALT), from DATA1 on after a SETUP (USB 2.0, 8.6, 9.1.1.5 and 9.4.5)"
    /// A packet larger than its endpoint's.
    UsbPacketTooLong "usb-packet-too-long"
        "a packet must not be longer than wMaxPacketSize of its endpoint (USB 2.0, 5.8.3 and 8.4.4)"
    /// More data than was asked for.
    UsbTooMuchData "usb-too-much-data"
        "a device must not return more than wLength bytes, in packets of bMaxPacketSize0 at most (USB 2.0, 5.5.3 and 8.5.3)"
    /// A status stage that is none.
    UsbStatusStage "usb-status-stage"
        "the status stage of a request without data to the host is an empty DATA1 packet (USB 2.0, 8.5.3.1)"
    /// A SETUP that was never taken.
    UsbSetupLost "usb-setup-lost"
        "a device must always accept a SETUP: endpoint 0 needs both directions on, no EPSTALL, no EPCTLDIS, and a receive buffer that the controller owns (USB 2.0, 8.5.3; K20 manual, USBx_ENDPTn)"
    /// ADDR was written too early.
    UsbAddressEarly "usb-address-early"
        "the new address takes effect after the status stage of SET_ADDRESS, which still happens at the old one (USB 2.0, 9.4.6)"
    /// ADDR was written too late or not at all.
    UsbAddressLate "usb-address-late"
        "within 2 ms of the status stage of SET_ADDRESS the device has to answer at its new address (USB 2.0, 9.2.6.3)"
    /// Nothing but NAK.
    UsbRequestTimeout "usb-request-timeout"
        "no request may take longer than 5 s (USB 2.0, 9.2.6.1)"
    /// An endpoint that is not there.
    UsbNoAnswer "usb-no-answer"
        "every endpoint of the active configuration answers each token with data or a handshake: EPTXEN or EPRXEN and EPHSHK have to be set (USB 2.0, 8.4.6; K20 manual, USBx_ENDPTn)"
    /// A halt that ended by itself.
    UsbHaltLost "usb-halt-lost"
        "a halted endpoint answers with STALL until CLEAR_FEATURE(ENDPOINT_HALT), a new configuration or a reset (USB 2.0, 8.4.6 and 9.4.5)"
    /// A descriptor that no host accepts.
    UsbDescriptor "usb-descriptor"
        "lengths, addresses and packet sizes of descriptors are prescribed, and a full-speed device refuses the device qualifier (USB 2.0, 9.6)"
    /// A device that cannot be enumerated.
    UsbEnumeration "usb-enumeration"
        "a device has to answer the requests for its device and configuration descriptors and SET_ADDRESS (USB 2.0, 9.1.2)"
    /// The device woke its host without leave.
    UsbWakeUp "usb-wake-up"
        "a device may signal resume only after SET_FEATURE(DEVICE_REMOTE_WAKEUP) (USB 2.0, 7.1.7.7 and 9.4.9)"
    /// The controller as a host.
    UsbHostMode "usb-host-mode"
        "the board is a device on its only USB port, and host mode is not modelled"

    // Sensor.
    /// A register of the sensor that must be left alone.
    SensorReserved "sensor-reserved"
        "reserved registers and values of the MPU-9250 and its AK8963 must not be used (register map, section 3; AK8963 data sheet, 8.1)"
    /// A register of the sensor that can only be read.
    SensorReadOnly "sensor-read-only"
        "a write to a read-only register of the sensor is lost (register map, section 3; AK8963 data sheet, 8.2)"
    /// The sensor was spoken to while it starts.
    SensorNotReady "sensor-not-ready"
        "after H_RESET the sensor does not answer until it has started, 11 ms typically and 100 ms at most (product specification 3.4.2)"
    /// The sensor's FIFO was read when there is nothing to read.
    SensorFifo "sensor-fifo"
        "FIFO_R_W may be read only with FIFO_EN set and while FIFO_COUNT is not 0 (register map 4.33 and 4.37)"
    /// The sensor no longer listens.
    SensorLost "sensor-lost"
        "I2C_IF_DIS, I2C_MST_RST during a transfer and I2CDIS silence a chip until it loses power or is reset (register map 4.33; AK8963 data sheet, 8.3.10)"
    /// A mode of the magnetometer that cannot be entered like this.
    MagnetometerMode "magnetometer-mode"
        "the AK8963 changes its mode through power-down, with 100 µs there, and opens its fuse ROM in a mode of its own (AK8963 data sheet, 5.3.2, 6.3 and 6.4)"
    /// The magnetometer's data was read without its end.
    MagnetometerStale "magnetometer-stale"
        "a measurement is held until ST2 is read; without that the data no longer changes (AK8963 data sheet, 6.4.3.2)"
}

impl std::fmt::Display for Trap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl std::str::FromStr for Trap {
    type Err = String;

    fn from_str(text: &str) -> Result<Trap, String> {
        Trap::ALL
            .iter()
            .copied()
            .find(|trap| trap.name() == text)
            .ok_or_else(|| format!("no trap is called {text}; `cargo emulate --traps` lists them"))
    }
}
