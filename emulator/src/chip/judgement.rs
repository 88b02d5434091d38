//! Rules that lie between the modules: clocks that fit each other, and what the watchdog and the sensor have seen.

use super::Chip;
use crate::peripherals::rcm::Cause;
use crate::witness::Trap;

impl Chip {
    /// Tells the witness of clocks that are too fast, or do not fit each other.
    pub(super) fn judge_clocks(&mut self) {
        const CORE_LIMIT: u32 = 72_000_000;
        const BUS_LIMIT: u32 = 50_000_000;
        const FLASH_LIMIT: u32 = 25_000_000;
        self.clock_change = self.clocks.next_event(self.now);
        let (core, bus, flash) = self.sim.divide(self.clocks.output_hz(self.now));
        let limits = [
            (Trap::CoreOverSpeed, "core", core, CORE_LIMIT),
            (Trap::BusOverSpeed, "bus", bus, BUS_LIMIT),
            (Trap::FlashOverSpeed, "flash", flash, FLASH_LIMIT),
        ];
        for (trap, clock, hz, limit) in limits {
            if hz > limit {
                self.witness
                    .saw(trap, format!("the {clock} clock became {hz} Hz"));
            }
        }
        if !self.sim.ratios_are_whole() {
            self.witness.saw(
                Trap::ClockRatio,
                format!("core, bus and flash clock became {core}, {bus} and {flash} Hz"),
            );
        }
    }

    /// Passes on what the sensor has to complain of since the last time.
    pub(super) fn hear_the_sensor(&mut self) {
        let list = self.sensor.complaints.list();
        for (_, complaint) in list.iter().skip(self.complaints_heard) {
            if let Some(trap) = complaint.trap() {
                let section = complaint.section();
                self.witness.saw(trap, format!("{complaint} ({section})"));
            }
        }
        self.complaints_heard = list.len();
    }

    pub(super) fn judge_usb_clock(&mut self) {
        if self.usb.pulled_up() && !self.usb_clocked() {
            self.witness.saw(
                Trap::UsbClock,
                "the device was attached to the bus while its clock is not 48 MHz",
            );
        }
    }

    pub(super) fn watchdog_bites(&mut self, trap: Trap) {
        self.witness.saw(trap, "the watchdog resets the chip");
        self.reset_wanted
            .get_or_insert((Cause::Watchdog, trap.rule()));
    }
}
