//! What has to be known of an instruction before it is executed: how long it is, what it costs, what it reaches for.

use rsemu::cpu::arm::v7m::isa::{HintOp, Insn, MemOffset, decode, is_32bit};

/// Registers as the program sees them.
pub type Registers = [u32; 16];

/// How long an instruction takes, by its row in the Cortex-M4 TRM (DDI 0439, 3.3.1).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// One cycle: data processing, multiplies, system instructions.
    Single,
    /// A branch that may be taken: 1, or 1 + P.
    Branch,
    /// A table branch: 2 + P.
    TableBranch,
    /// A load of one register.
    Load,
    /// A store of one register with an immediate offset, which the write buffer hides.
    Store,
    /// A store of one register with a register offset.
    StoreIndexed,
    /// Several registers: one cycle and one for each.
    Multiple(u8),
    /// UDIV or SDIV: 2 to 12.
    Divide,
    /// WFI or WFE.
    Sleep,
}

/// Where an instruction reads or writes memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Nowhere,
    Register { base: u8, offset: i32 },
    Indexed { base: u8, index: u8, shift: u8 },
    Literal { offset: i32 },
}

/// An access to memory that is about to happen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Access {
    /// The lowest address.
    pub address: u32,
    /// Bytes of one transfer.
    pub bytes: u8,
    /// Whether it writes.
    pub store: bool,
}

/// A decoded instruction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Op {
    /// Its length, 2 or 4.
    pub length: u8,
    /// Its row in the table of timings.
    pub class: Class,
    /// The register a load writes; 16 for none.
    pub loads: u8,
    /// Whether it is a coprocessor instruction of the FPU that this chip does not have.
    pub floating: bool,
    /// Whether it writes a stack pointer with MSR: another stack begins.
    pub moves_stack: bool,
    place: Place,
    bytes: u8,
    store: bool,
}

const NO_REGISTER: u8 = 16;

impl Op {
    /// Stands for an instruction that was not decoded yet.
    pub const UNMET: Op = Op {
        length: 0,
        class: Class::Single,
        loads: NO_REGISTER,
        floating: false,
        moves_stack: false,
        place: Place::Nowhere,
        bytes: 4,
        store: false,
    };

    /// Decodes the instruction that begins with these two halfwords.
    pub fn decode(first: u16, second: u16) -> Op {
        let mut op = Op {
            length: if is_32bit(first) { 4 } else { 2 },
            ..Op::UNMET
        };
        match decode(first, second) {
            Insn::Branch { .. }
            | Insn::BranchLink { .. }
            | Insn::Bx { .. }
            | Insn::Blx { .. }
            | Insn::Cbz { .. } => op.class = Class::Branch,
            Insn::TableBranch { rn, rm, half } => {
                op.class = Class::TableBranch;
                op.bytes = 1 + u8::from(half);
                op.place = Place::Indexed {
                    base: rn,
                    index: rm,
                    shift: u8::from(half),
                };
            }
            Insn::LoadStore {
                load,
                size,
                rt,
                rn,
                offset,
                index,
                add,
                ..
            } => {
                op.bytes = size.bytes() as u8;
                op.store = !load;
                op.place = match offset {
                    // Post-indexed: the base alone is the address.
                    _ if !index => Place::Register {
                        base: rn,
                        offset: 0,
                    },
                    MemOffset::Imm(imm) => Place::Register {
                        base: rn,
                        offset: signed(imm, add),
                    },
                    MemOffset::Reg { rm, lsl } => Place::Indexed {
                        base: rn,
                        index: rm,
                        shift: lsl,
                    },
                };
                op.class = match (load, offset) {
                    (true, _) => Class::Load,
                    (false, MemOffset::Imm(_)) => Class::Store,
                    (false, MemOffset::Reg { .. }) => Class::StoreIndexed,
                };
                if load {
                    op.loads = rt;
                }
            }
            Insn::LoadLiteral {
                size, rt, imm, add, ..
            } => {
                op.bytes = size.bytes() as u8;
                op.class = Class::Load;
                op.loads = rt;
                op.place = Place::Literal {
                    offset: signed(imm, add),
                };
            }
            Insn::LoadStoreDual {
                load,
                rn,
                imm,
                index,
                add,
                ..
            } => {
                op.store = !load;
                op.class = Class::Multiple(2);
                op.place = Place::Register {
                    base: rn,
                    offset: if index { signed(imm, add) } else { 0 },
                };
            }
            Insn::LoadStoreExclusive {
                load,
                size,
                rt,
                rn,
                imm,
                ..
            } => {
                op.bytes = size.bytes() as u8;
                op.store = !load;
                op.class = Class::Load;
                if load {
                    op.loads = rt;
                }
                op.place = Place::Register {
                    base: rn,
                    offset: imm as i32,
                };
            }
            Insn::LoadStoreMultiple {
                load,
                rn,
                list,
                before,
                ..
            } => {
                let count = list.count_ones() as u8;
                op.store = !load;
                op.class = Class::Multiple(count);
                op.place = Place::Register {
                    base: rn,
                    offset: if before { -4 * i32::from(count) } else { 0 },
                };
            }
            Insn::Div { .. } => op.class = Class::Divide,
            Insn::Hint {
                op: HintOp::Wfi | HintOp::Wfe,
            } => op.class = Class::Sleep,
            // SYSm 8 is MSP and 9 is PSP (ARMv7-M, B5.2.3).
            Insn::Msr { sysm, .. } => op.moves_stack = sysm == 8 || sysm == 9,
            Insn::Coproc { cp } => op.floating = cp == 10 || cp == 11,
            _ => {}
        }
        op
    }

    /// The access this instruction will make, if its condition holds.
    pub fn access(&self, pc: u32, registers: &Registers) -> Option<Access> {
        let register = |number: u8| registers[usize::from(number & 15)];
        let address = match self.place {
            Place::Nowhere => return None,
            Place::Register { base, offset } => register(base).wrapping_add_signed(offset),
            Place::Indexed { base, index, shift } => {
                // A table branch counts from the address behind it when its base is the PC.
                let base = if base == 15 {
                    pc.wrapping_add(4)
                } else {
                    register(base)
                };
                base.wrapping_add(register(index) << shift)
            }
            Place::Literal { offset } => (pc.wrapping_add(4) & !3).wrapping_add_signed(offset),
        };
        Some(Access {
            address,
            bytes: self.bytes,
            store: self.store,
        })
    }

    /// Whether the address comes from what register `number` holds.
    pub fn addresses_by(&self, number: u8) -> bool {
        match self.place {
            Place::Register { base, .. } => base == number,
            Place::Indexed { base, index, .. } => base == number || index == number,
            _ => false,
        }
    }
}

fn signed(imm: u32, add: bool) -> i32 {
    if add { imm as i32 } else { -(imm as i32) }
}
