//! How many cycles an instruction takes: a band, since the manuals leave some of it open.
//!
//! Both ends follow the table of the Cortex-M4 Technical Reference Manual (DDI 0439, 3.3.1 and 3.3.2).
//!
//! | | least | greatest |
//! |---|---|---|
//! | P, refill of the pipeline after a branch | 1 | 3 |
//! | load behind a load whose result it does not need | 1 | 2 |
//! | store with an immediate offset | 1 | 2 |
//! | division | 2 | 12 |
//! | flash | no wait states | [`super::flash_cache`] |
//!
//! Nothing here is calibrated on silicon.

use super::flash_cache::FlashCache;
use super::op::{Access, Class, Op};

/// Cycles by both ends of the band.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Cycles {
    /// With no wait states, and every range of the table at its least.
    pub least: u64,
    /// With the flash's wait states, and every range at its greatest.
    pub greatest: u64,
}

impl Cycles {
    /// The same by both ends.
    pub fn exactly(cycles: u64) -> Cycles {
        Cycles {
            least: cycles,
            greatest: cycles,
        }
    }
}

impl std::ops::AddAssign for Cycles {
    fn add_assign(&mut self, other: Cycles) {
        self.least += other.least;
        self.greatest += other.greatest;
    }
}

const REFILL: Cycles = Cycles {
    least: 1,
    greatest: 3,
};

/// Follows the program from instruction to instruction.
#[derive(Debug, Clone, Default)]
pub struct Timing {
    /// The register that the last instruction loaded, if the next access may overlap with it.
    pending_load: Option<u8>,
    flash: FlashCache,
}

impl Timing {
    /// What `op` at `pc` takes; `branched` tells whether it went elsewhere than to the next instruction, `ratio` is the
    /// core clock over the flash clock.
    pub fn of(
        &mut self,
        op: &Op,
        pc: u32,
        access: Option<Access>,
        branched: bool,
        ratio: u32,
    ) -> Cycles {
        let overlaps = self
            .pending_load
            .take()
            .is_some_and(|register| !op.addresses_by(register));
        let single = 2 - u64::from(overlaps);
        let mut cycles = match op.class {
            Class::Single | Class::Sleep | Class::Branch => Cycles::exactly(1),
            Class::TableBranch => Cycles::exactly(2),
            Class::Load => {
                self.pending_load = Some(op.loads);
                Cycles {
                    least: single,
                    greatest: 2,
                }
            }
            Class::Store => Cycles {
                least: 1,
                greatest: 2,
            },
            Class::StoreIndexed => Cycles {
                least: single,
                greatest: 2,
            },
            Class::Multiple(registers) => Cycles::exactly(1 + u64::from(registers)),
            Class::Divide => Cycles {
                least: 2,
                greatest: 12,
            },
        };
        if branched {
            cycles += REFILL;
            self.pending_load = None;
        }
        cycles.greatest += self.flash.fetch(pc, op.length, ratio);
        if let Some(access) = access.filter(|access| !access.store) {
            cycles.greatest += self.flash.load(access.address, ratio);
        }
        cycles
    }
}
