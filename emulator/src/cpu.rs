//! The processor: a Cortex-M4 without FPU or MPU, executed by `rsemu` behind this module's own interface.
//!
//! `rsemu` is young (0.0.x), so nothing outside this folder knows it. Around it this module adds what the engine does
//! not have: the band of cycle counts ([`timing`]), names for faults, and the repair of ITSTATE.

mod counters;

pub mod debug;

mod fault;

pub mod flash_cache;

mod memory;

pub mod op;

mod state;

pub mod timing;

use std::sync::Arc;

use rsemu::core::space::{AddressSpace, MemAttrs};
use rsemu::core::value::Width;
use rsemu::cpu::arm::v7m::sys::Exception;
use rsemu::cpu::arm::v7m::{ArmV7m, Config, Regs};

use memory::Map;
pub use memory::{PeripheralBus, Ram};

use crate::witness::Trap;
use counters::Owed;
use op::{Access, Class, Op};
use timing::{Cycles, Timing};

/// Where the 64 KiB of SRAM begin; they end at 0x2000_8000 (K20 manual, "Memory map").
pub const RAM_BASE: u32 = 0x1FFF_8000;

/// Bytes of SRAM.
pub const RAM_SIZE: u32 = 64 * 1024;

/// Bytes of program flash, from address 0.
pub const FLASH_SIZE: u32 = 256 * 1024;

/// xPSR: ITSTATE, in its two places, and the number of the exception being handled.
const IT_STATE: u32 = 0x0600_FC00;
const EXCEPTION: u32 = 0x1FF;

/// The program counter of a processor that has locked up (ARMv7-M, B1.5.15).
const LOCKED_UP: u32 = 0xFFFF_FFFE;

/// By which end of the band of cycle counts time passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Pace {
    /// No wait states, every range at its least.
    #[default]
    Least,
    /// The flash's wait states, every range at its greatest.
    Greatest,
}

impl Pace {
    /// The end of the band that this pace goes by.
    pub fn of(self, cycles: Cycles) -> u64 {
        match self {
            Pace::Least => cycles.least,
            Pace::Greatest => cycles.greatest,
        }
    }
}

/// A fault that the processor took, by its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// The rule that was broken.
    pub trap: Trap,
    /// How, in words.
    pub what: String,
}

/// What one step did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Step {
    /// How long it took.
    pub cycles: Cycles,
    /// The access to memory that the instruction made.
    pub access: Option<Access>,
    /// Whether the program took another stack.
    pub moved_stack: bool,
}

/// The processor with its memories.
#[derive(Debug)]
pub struct Cpu {
    core: ArmV7m,
    space: Arc<AddressSpace>,
    map: Map,
    /// The registers after the last step, and before it.
    registers: Regs,
    before: Regs,
    /// Instructions of the flash by halfword, decoded when first met.
    code: Vec<Op>,
    /// The same of the RAM, forgotten where the program stores something.
    code_in_ram: Vec<Op>,
    timing: Timing,
    pace: Pace,
    owed: Owed,
    /// Cycles for which the counters need no look: SysTick cannot expire within them.
    calm: u64,
    /// SysTick or DWT_CYCCNT counts.
    counting: bool,
    asleep: bool,
    /// Fault status bits that earlier faults have left.
    faults_seen: u32,
    /// What the last step has broken.
    fault: Option<Fault>,
}

impl Cpu {
    /// A processor about to leave reset, with `flash` at address 0.
    pub fn new(flash: &[u8], ram: &Ram, peripherals: Arc<dyn PeripheralBus>, pace: Pace) -> Cpu {
        let (space, map) = Map::new(flash, ram, peripherals);
        Cpu {
            core: Cpu::core(&space),
            space,
            map,
            registers: Regs::new(),
            before: Regs::new(),
            code: vec![Op::UNMET; FLASH_SIZE as usize / 2],
            code_in_ram: vec![Op::UNMET; RAM_SIZE as usize / 2],
            timing: Timing::default(),
            pace,
            owed: Owed::default(),
            calm: 0,
            counting: false,
            asleep: false,
            faults_seen: 0,
            fault: None,
        }
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
        self.registers = Regs::new();
        self.timing = Timing::default();
        self.owed = Owed::default();
        self.calm = 0;
        self.counting = false;
        self.asleep = false;
        self.faults_seen = 0;
    }

    /// Executes one instruction, exception entry or idle cycle. `ratio` is the core clock over the flash clock.
    pub fn step(&mut self, ratio: u32) -> Step {
        self.before = self.registers;
        let (pc, xpsr) = (self.before.r[15], self.before.xpsr);
        let op = self.op_at(pc);
        let access = op
            .access(pc, &self.before.r)
            .filter(|_| condition_holds(xpsr));
        let private = access.filter(|access| access.address >> 28 == 0xE);
        if private.is_some() {
            self.settle();
        }
        let charged = self.core.step();
        self.registers = self.core.regs();
        if self.asleep {
            self.asleep = self.core.is_asleep();
            if self.asleep {
                // DWT_CYCCNT's clock is gated in WFI; the engine counts on.
                self.owed.cycle_counter -= charged as i64;
            }
            return Step {
                cycles: Cycles::exactly(charged),
                access: None,
                moved_stack: false,
            };
        }
        if xpsr & IT_STATE != 0 {
            self.keep_it_state();
        }
        if private.is_some_and(|access| access.store) {
            self.look_at_counters();
        }
        let next = self.registers.r[15];
        let changed = (self.registers.xpsr ^ xpsr) & EXCEPTION != 0 || next == LOCKED_UP;
        let cycles = if changed {
            self.fault = self.processor_fault(&op, access);
            // Entry, return and tail-chaining have their own cost (DDI 0439, 3.9).
            Cycles::exactly(charged)
        } else {
            let branched = next != pc.wrapping_add(u32::from(op.length));
            self.timing.of(&op, pc, access, branched, ratio)
        };
        if self.counting {
            self.owe(self.pace.of(cycles), charged);
        }
        if let Some(access) = access.filter(|access| access.store) {
            self.forget_code(&op, access);
        }
        if op.class == Class::Sleep {
            self.asleep = self.core.is_asleep();
        }
        if let Some(access) = access
            && self.fault.is_none()
        {
            self.fault = fault::of_access(access);
        }
        Step {
            cycles,
            access,
            moved_stack: op.moves_stack,
        }
    }

    /// Takes the rule of the processor that the last step has broken.
    pub fn take_fault(&mut self) -> Option<Fault> {
        self.fault.take()
    }

    fn op_at(&mut self, pc: u32) -> Op {
        let in_ram = pc.wrapping_sub(RAM_BASE) as usize / 2;
        let met = self.code.get(pc as usize / 2);
        let Some(&met) = met.or_else(|| self.code_in_ram.get(in_ram)) else {
            return self.decode(pc);
        };
        if met.length != 0 {
            return met;
        }
        let op = self.decode(pc);
        match self.code.get_mut(pc as usize / 2) {
            Some(place) => *place = op,
            None => self.code_in_ram[in_ram] = op,
        }
        op
    }

    /// The program has stored something: what was decoded there may be another instruction now.
    fn forget_code(&mut self, op: &Op, access: Access) {
        let Some(first) = access.address.checked_sub(RAM_BASE) else {
            return;
        };
        let bytes = match op.class {
            Class::Multiple(registers) => 4 * usize::from(registers),
            _ => usize::from(access.bytes),
        };
        // An instruction of two halfwords may begin before.
        let first = (first as usize / 2).saturating_sub(1);
        let places = self.code_in_ram.iter_mut().skip(first);
        places
            .take(bytes.div_ceil(2) + 2)
            .for_each(|place| *place = Op::UNMET);
    }

    fn decode(&self, pc: u32) -> Op {
        let halfword = |address| self.halfword(address).unwrap_or(0);
        Op::decode(halfword(pc), halfword(pc.wrapping_add(2)))
    }

    /// Which rule was broken, if the processor has just taken a fault.
    fn processor_fault(&mut self, op: &Op, access: Option<Access>) -> Option<Fault> {
        const FAULTS: std::ops::RangeInclusive<u32> = 3..=6;
        let (before, after) = (&self.before, &self.registers);
        let (old, new) = (before.xpsr & EXCEPTION, after.xpsr & EXCEPTION);
        if after.r[15] == LOCKED_UP {
            return (before.r[15] != LOCKED_UP).then(|| Fault {
                trap: Trap::Lockup,
                what: format!("a fault in exception {old}, which no handler can take"),
            });
        }
        // A return from one handler to another pops its frame.
        let returned = old != 0 && after.r[13] > before.r[13];
        if !FAULTS.contains(&new) || returned {
            return None;
        }
        let (cfsr, hfsr, bfar) = self.core.with_sys(|sys| (sys.cfsr, sys.hfsr, sys.bfar));
        let fresh = cfsr & !self.faults_seen;
        self.faults_seen = cfsr;
        let status = (if fresh == 0 { cfsr } else { fresh }, hfsr, bfar);
        Some(fault::name(self.before.r[15], op.floating, access, status))
    }

    /// Puts the rest of an IT block into the frame of an exception that interrupted it.
    ///
    /// The architecture stacks ITSTATE with the xPSR (DDI 0403, B1.5.6); rsemu 0.0.7 leaves it out, so
    /// that after the return the rest of the block would be executed whatever its condition.
    fn keep_it_state(&self) {
        let before = &self.before;
        const SVCALL: u32 = 11;
        let exception = self.registers.xpsr & EXCEPTION;
        // An entry pushes a frame; a return inside an IT block pops one. A supervisor call has
        // advanced the state, and stands last in its block by the architecture's advice.
        if exception == before.xpsr & EXCEPTION
            || exception == SVCALL
            || self.registers.r[13] > before.r[13]
        {
            return;
        }
        let on_process_stack = self.registers.r[14] & 4 != 0;
        let frame = if on_process_stack {
            self.registers.psp
        } else {
            self.registers.msp
        };
        let stacked = u64::from(frame.wrapping_add(28));
        let attributes = MemAttrs::DEFAULT;
        if let Ok(xpsr) = self.space.read(stacked, Width::U32, attributes) {
            let restored = xpsr | u64::from(before.xpsr & IT_STATE);
            // A stack outside memory has already become a fault of its own.
            let _ = self.space.write(stacked, Width::U32, restored, attributes);
        }
    }

    /// Whether the core sleeps in WFI or WFE.
    pub fn is_asleep(&self) -> bool {
        self.asleep
    }

    /// Whether a fault within a fault has stopped the core for good.
    pub fn is_locked_up(&self) -> bool {
        self.registers.r[15] == LOCKED_UP
    }

    /// Whether the program asked for a system reset (AIRCR.SYSRESETREQ).
    pub fn wants_reset(&self) -> bool {
        self.core.reset_requested()
    }

    /// Enables interrupt `irq` as a write to the NVIC would.
    pub fn enable_irq(&self, irq: u16) {
        let exception = Exception(irq + 16);
        self.core.with_sys(|sys| sys.set_enable(exception, true));
    }

    /// Drives interrupt input `irq`.
    pub fn set_irq(&self, irq: u16, asserted: bool) {
        self.core.set_irq(irq, asserted);
    }

    /// The program counter.
    pub fn pc(&self) -> u32 {
        self.registers.r[15]
    }

    /// Continues at `address`, awake: how a test makes the program hang or panic where it likes.
    pub fn set_pc(&mut self, address: u32) {
        self.core.set_pc(address);
        self.registers = self.core.regs();
    }

    /// The sixteen registers and xPSR.
    pub fn registers(&self) -> (&op::Registers, u32) {
        (&self.registers.r, self.registers.xpsr)
    }

    /// The same before the last step.
    pub fn registers_before(&self) -> (&op::Registers, u32) {
        (&self.before.r, self.before.xpsr)
    }

    /// The main stack pointer.
    pub fn stack_pointer(&self) -> u32 {
        self.registers.msp
    }

    /// Number of the exception being handled; 0 in thread mode, 3 in HardFault, 16 + n in interrupt n.
    pub fn exception(&self) -> u16 {
        (self.registers.xpsr & EXCEPTION) as u16
    }

    /// Reads a 16-bit halfword as a debugger would, without side effects.
    pub fn halfword(&self, address: u32) -> Option<u16> {
        self.space
            .read(u64::from(address), Width::U16, MemAttrs::DEBUG)
            .ok()
            .map(|v| v as u16)
    }
}

/// Whether the instruction under this xPSR is executed: outside an IT block, or with its condition fulfilled
/// (ARMv7-M, A7.3).
fn condition_holds(xpsr: u32) -> bool {
    if xpsr & IT_STATE == 0 {
        return true;
    }
    let flag = |bit: u32| xpsr >> bit & 1 != 0;
    let (n, z, c, v) = (flag(31), flag(30), flag(29), flag(28));
    // The condition is the upper half of ITSTATE, whose bits 7 to 2 are xPSR bits 15 to 10.
    let condition = xpsr >> 12 & 0xF;
    let holds = match condition >> 1 {
        0 => z,
        1 => c,
        2 => n,
        3 => v,
        4 => c && !z,
        5 => n == v,
        6 => n == v && !z,
        _ => return true,
    };
    holds != (condition & 1 != 0)
}
