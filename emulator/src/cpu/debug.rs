//! What a debugger sees and changes, without a side effect of its looking.

use rsemu::core::space::MemAttrs;

use super::Cpu;

/// The registers that a debugger shows of an ARMv7-M processor, in its order: r0 to r12, sp, lr, pc, xPSR, msp, psp.
pub type DebugRegisters = [u32; 19];

/// Of [`DebugRegisters`]: the program counter.
pub const PC: usize = 15;

impl Cpu {
    /// The registers.
    pub fn debug_registers(&self) -> DebugRegisters {
        let regs = self.core.regs();
        let mut registers = [0; 19];
        registers[..16].copy_from_slice(&regs.r);
        registers[16..].copy_from_slice(&[regs.xpsr, regs.msp, regs.psp]);
        registers
    }

    /// Changes the registers. sp goes before the stack pointer that it stands for.
    pub fn set_debug_registers(&mut self, registers: &DebugRegisters) {
        let mut regs = self.core.regs();
        let process_stack = regs.r[13] == regs.psp && regs.r[13] != regs.msp;
        let sp_changed = registers[13] != regs.r[13];
        regs.r.copy_from_slice(&registers[..16]);
        regs.r[PC] &= !1;
        [regs.xpsr, regs.msp, regs.psp] = [registers[16], registers[17], registers[18]];
        if sp_changed && process_stack {
            regs.psp = registers[13];
        } else if sp_changed {
            regs.msp = registers[13];
        }
        self.core.set_regs(regs);
        self.registers = self.core.regs();
    }

    /// A byte of flash, SRAM or FlexRAM, or of the processor's own registers; `None` anywhere else.
    pub fn peek(&self, address: u32) -> Option<u8> {
        if address >> 28 == 0xE {
            let word = self
                .core
                .with_sys(|sys| sys.read_word(address & !3, true))?;
            return Some(word.to_le_bytes()[(address & 3) as usize]);
        }
        let mut byte = [0];
        self.space
            .read_bytes(u64::from(address), &mut byte, MemAttrs::DEBUG)
            .ok()?;
        Some(byte[0])
    }

    /// Writes the processor's own word register at `address`; whether there is one.
    pub fn poke_private(&mut self, address: u32, value: u32) -> bool {
        self.settle();
        let written = self.core.with_sys(|sys| sys.write_word(address, value));
        self.look_at_counters();
        written
    }
}
