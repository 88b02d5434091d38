//! The board under a debugger: instruction by instruction, with breakpoints.

use super::Board;
use super::passing::PERIPHERALS;
use crate::cpu::debug::DebugRegisters;
use crate::peripherals::rcm::Cause;
use crate::time::Ticks;

/// Where a debugger wants to stop.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Stops {
    /// Addresses of instructions.
    pub breakpoints: Vec<u32>,
    /// Ranges of memory.
    pub watchpoints: Vec<Watchpoint>,
}

/// A range of memory whose accesses stop the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Watchpoint {
    /// The first address.
    pub address: u32,
    /// Bytes.
    pub length: u32,
    /// Reading stops.
    pub reads: bool,
    /// Writing stops.
    pub writes: bool,
}

/// Why the program was stopped for the debugger.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Halt {
    /// One instruction was executed.
    Step,
    /// The next instruction has a breakpoint.
    Breakpoint,
    /// The last instruction has touched this watchpoint.
    Watchpoint(Watchpoint),
    /// The program stepped into a trap: [`Board::stop`].
    Trap,
}

/// The chip's 1 MiB of peripheral bridges (K20 manual, section 4.5).
const PERIPHERALS_SIZE: u32 = 0x10_0000;

fn is_peripheral(address: u32) -> bool {
    (PERIPHERALS..PERIPHERALS + PERIPHERALS_SIZE).contains(&address)
}

impl Board {
    /// Runs for `span`, or until something in `stops`. With `leaving` the first instruction is executed even if it has a
    /// breakpoint: the program has stopped there before.
    pub fn run_with(&mut self, span: Ticks, stops: &Stops, leaving: bool) -> Option<Halt> {
        let until = self.now.saturating_add(span);
        let mut first = leaving;
        while self.now < until && self.loader.is_none() {
            if self.stop.is_some() {
                return Some(Halt::Trap);
            }
            let awake = !self.cpu.is_asleep();
            if awake && !first && stops.breakpoints.contains(&self.cpu.pc()) {
                return Some(Halt::Breakpoint);
            }
            first = false;
            self.last_access = None;
            self.advance(until);
            if let Some(access) = self.last_access
                && let Some(&hit) = stops.watchpoints.iter().find(|watchpoint| {
                    let end = access.address + u32::from(access.bytes);
                    let wanted = if access.store {
                        watchpoint.writes
                    } else {
                        watchpoint.reads
                    };
                    wanted
                        && access.address < watchpoint.address.saturating_add(watchpoint.length)
                        && watchpoint.address < end
                })
            {
                return Some(Halt::Watchpoint(hit));
            }
        }
        self.stop.is_some().then_some(Halt::Trap)
    }

    /// Executes one instruction or exception entry, sleeping as long as `span` for it.
    pub fn step_instruction(&mut self, span: Ticks) -> Option<Halt> {
        let until = self.now.saturating_add(span);
        let executed = self.instructions;
        while self.now < until && self.stop.is_none() && self.loader.is_none() {
            self.advance(until);
            if self.instructions != executed {
                break;
            }
        }
        match self.stop {
            Some(_) => Some(Halt::Trap),
            None => (self.instructions != executed).then_some(Halt::Step),
        }
    }

    /// Executes every round of a polling loop from now on, so that a debugger sees each.
    pub fn do_not_skip(&mut self) {
        self.polling = None;
    }

    /// The registers.
    pub fn registers(&self) -> DebugRegisters {
        self.cpu.debug_registers()
    }

    /// Changes the registers.
    pub fn set_registers(&mut self, registers: &DebugRegisters) {
        self.cpu.set_debug_registers(registers);
    }

    /// Reads memory and registers of peripherals without a side effect, as far as there are any from `address` on.
    pub fn peek(&self, address: u32, length: usize) -> Vec<u8> {
        let addresses = (0..length as u32).map_while(|offset| address.checked_add(offset));
        if !is_peripheral(address) {
            return addresses.map_while(|at| self.cpu.peek(at)).collect();
        }
        // Registers want their own width; a copy of the chip bears the side effects.
        let fits = |width: &usize| {
            (address as usize).is_multiple_of(*width) && length.is_multiple_of(*width)
        };
        for width in [4, 2, 1].into_iter().filter(fits) {
            let mut chip = self.shared.chip().fork();
            let bytes: Vec<u8> = addresses
                .clone()
                .step_by(width)
                .map_while(|at| chip.read(at, width as u8))
                .flat_map(|value| value.to_le_bytes().into_iter().take(width))
                .collect();
            if !bytes.is_empty() {
                return bytes;
            }
        }
        Vec::new()
    }

    /// Writes SRAM, or registers as the processor would; whether all was written. Flash cannot be written.
    pub fn poke(&mut self, address: u32, bytes: &[u8]) -> bool {
        let word = || bytes.try_into().map(u32::from_le_bytes).ok();
        if is_peripheral(address) {
            let mut value = [0; 4];
            let width = bytes.len();
            if ![1, 2, 4].contains(&width) || !(address as usize).is_multiple_of(width) {
                return false;
            }
            value[..width].copy_from_slice(bytes);
            return self
                .chip()
                .write(address, width as u8, u32::from_le_bytes(value));
        }
        if address >> 28 == 0xE {
            return word().is_some_and(|value| self.cpu.poke_private(address, value));
        }
        self.shared.chip().ram.set_bytes(address, bytes)
    }

    /// Resets the chip for the debugger, and forgets why it had stopped.
    pub fn reset_for_debugger(&mut self) {
        self.stop = None;
        self.reset(Cause::Software, "the debugger asked for it");
        // The processor leaves reset.
        self.step_instruction(1);
    }
}
