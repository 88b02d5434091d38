//! Where the time goes: cycles by the function they were spent in.

use std::collections::BTreeMap;

use super::Board;
use crate::cpu::timing::Cycles;

/// Cycles and instructions by address of the instruction.
#[derive(Debug, Clone, Default)]
pub(super) struct Profile(BTreeMap<u32, Share>);

/// What was spent at one place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Share {
    /// Instructions executed.
    pub instructions: u64,
    /// Their cycles, with the entries of exceptions at the first instruction of their handlers.
    pub cycles: Cycles,
}

impl Profile {
    /// An instruction was executed.
    pub fn note(&mut self, pc: u32, cycles: Cycles) {
        let share = self.0.entry(pc).or_default();
        share.instructions += 1;
        share.cycles += cycles;
    }
}

impl Board {
    /// Notes from now on where the time goes, which takes a while for each instruction.
    pub fn profile(&mut self) {
        self.profile = Some(Profile::default());
    }

    /// What was spent in each function since [`Board::profile`], the most expensive first by the upper end of the band.
    pub fn profiled(&self) -> Vec<(String, Share)> {
        let mut functions: BTreeMap<&str, Share> = BTreeMap::new();
        for (&pc, share) in self.profile.iter().flat_map(|profile| &profile.0) {
            let name = self.image.symbol_at(pc).map_or("?", |(name, _)| name);
            let function = functions.entry(name).or_default();
            function.instructions += share.instructions;
            function.cycles += share.cycles;
        }
        let mut sorted: Vec<_> = functions
            .into_iter()
            .map(|(name, share)| (name.to_owned(), share))
            .collect();
        sorted.sort_by_key(|(_, share)| std::cmp::Reverse(share.cycles.greatest));
        sorted
    }
}
