//! Copies and fingerprints of the processor with its memories.

use std::sync::Arc;

use rsemu::core::device::Device;
use rsemu::core::space::MemAttrs;
use rsemu::core::state::{ChunkReader, MachineShape, StateReader, StateWriter};
use rsemu::cpu::arm::v7m::ArmV7m;

use super::counters::settle;
use super::memory::Map;
use super::{Cpu, PeripheralBus, RAM_BASE, RAM_SIZE, Ram};
use crate::hash::Fnv1a;

/// Where the engine's saved state counts cycles of its own, which influence nothing: behind sixteen registers, the
/// other stack pointer and xPSR with two flags, and the five bytes of the mask registers and two of flags.
const ENGINE_CYCLES: std::ops::Range<usize> = 80..88;

impl Cpu {
    /// A copy that goes on from here, with `flash`, `ram` and `peripherals` in the place of the original's.
    pub(crate) fn fork(&self, flash: &[u8], ram: &Ram, peripherals: Arc<dyn PeripheralBus>) -> Cpu {
        let (space, map) = Map::new(flash, ram, peripherals);
        let core = Cpu::core(&space);
        load(&core, &saved(&self.core));
        Cpu {
            core,
            space,
            map,
            registers: self.registers,
            before: self.before,
            code: self.code.clone(),
            code_in_ram: self.code_in_ram.clone(),
            timing: self.timing.clone(),
            pace: self.pace,
            owed: self.owed,
            calm: self.calm,
            counting: self.counting,
            asleep: self.asleep,
            faults_seen: self.faults_seen,
            fault: self.fault.clone(),
        }
    }

    /// Takes in everything that can influence what the processor does from now on.
    pub(crate) fn hash_into(&self, hash: &mut Fnv1a) {
        use std::fmt::Write;
        // The counters as they are once they have counted what they are owed, on a copy: looking changes nothing.
        let copy = Cpu::core(&self.space);
        load(&copy, &saved(&self.core));
        let mut owed = self.owed;
        if self.counting {
            copy.with_sys(|sys| settle(sys, &mut owed));
        }
        let mut state = saved(&copy);
        assert_eq!(
            state[ENGINE_CYCLES],
            copy.cycles().to_le_bytes(),
            "rsemu saves in another order"
        );
        state[ENGINE_CYCLES].fill(0);
        hash.bytes(&state);
        let owed_systick = if self.counting { owed.systick } else { 0 };
        // Writing to a hash cannot fail.
        let _ = write!(
            hash,
            "{owed_systick} {} {} {} {:?} {:?}",
            self.counting, self.asleep, self.faults_seen, self.pace, self.timing
        );
        hash.bytes(&self.memory(RAM_BASE, RAM_SIZE));
    }

    fn memory(&self, base: u32, length: u32) -> Vec<u8> {
        let mut bytes = vec![0; length as usize];
        self.space
            .read_bytes(u64::from(base), &mut bytes, MemAttrs::DEBUG)
            .expect("the chip has this memory");
        bytes
    }
}

const PATH: &str = "/cpu";

/// The engine's own account of its state.
fn saved(core: &ArmV7m) -> Vec<u8> {
    let mut writer = StateWriter::new(MachineShape::new());
    let class = core.class();
    writer
        .chunk(PATH, class.name, class.version)
        .and_then(|mut chunk| core.save(&mut chunk))
        .expect("a processor can always be saved");
    let bytes = writer.to_vec().expect("it was written a moment ago");
    let reader = StateReader::new(&bytes).expect("it was written a moment ago");
    let (_, _, state) = reader.load_raw(PATH).expect("it was written a moment ago");
    state.to_vec()
}

fn load(core: &ArmV7m, state: &[u8]) {
    let mut reader = ChunkReader::new(state);
    core.load(&mut reader)
        .and_then(|()| reader.end())
        .expect("the same engine has saved it");
}
