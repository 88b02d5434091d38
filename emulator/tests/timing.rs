//! The band of cycle counts, held against the examples and the table of the Cortex-M4 Technical Reference Manual
//! (DDI 0439, 3.3), and the counters that a program reads.

use std::sync::Arc;

use vrduino_emulator::cpu::timing::Cycles;
use vrduino_emulator::cpu::{Cpu, FLASH_SIZE, Pace, PeripheralBus, Ram};

#[derive(Debug)]
struct Nothing;

impl PeripheralBus for Nothing {
    fn read(&self, _address: u32, _width: u8) -> Option<u32> {
        None
    }

    fn write(&self, _address: u32, _width: u8, _value: u32) -> bool {
        false
    }
}

/// The first instruction: at the beginning of a line of the flash cache.
const CODE: u32 = 0x418;

/// `sub sp, #64; mov r1, sp; mov r3, sp; movs r2, #0`: r1 and r3 point into the RAM.
const PREPARED: [u16; 4] = [0xB090, 0x4669, 0x466B, 0x2200];

/// A processor that has left reset and is about to execute `code`.
fn processor(code: &[u16], pace: Pace) -> Cpu {
    let mut flash = vec![0xFF; FLASH_SIZE as usize];
    let words = [0x2000_8000, CODE | 1];
    for (at, word) in words.into_iter().enumerate() {
        flash[4 * at..][..4].copy_from_slice(&u32::to_le_bytes(word));
    }
    for (at, halfword) in code.iter().enumerate() {
        flash[CODE as usize + 2 * at..][..2].copy_from_slice(&halfword.to_le_bytes());
    }
    let mut cpu = Cpu::new(&flash, &Ram::new(), Arc::new(Nothing), pace);
    cpu.step(1); // the reset sequence
    cpu
}

fn run(cpu: &mut Cpu, steps: usize, ratio: u32) -> Cycles {
    let mut sum = Cycles::default();
    for _ in 0..steps {
        sum += cpu.step(ratio).cycles;
    }
    sum
}

/// Cycles of `code` behind [`PREPARED`], from a flash without wait states.
fn cycles_of(code: &[u16], steps: usize) -> Cycles {
    let whole: Vec<u16> = PREPARED.iter().chain(code).copied().collect();
    let mut cpu = processor(&whole, Pace::Least);
    run(&mut cpu, PREPARED.len(), 1);
    run(&mut cpu, steps, 1)
}

#[test]
fn loads_overlap_as_in_the_manuals_examples() {
    let examples: [(&str, &[u16], u64); 5] = [
        ("LDR R0,[R1]; LDR R2,[R3]", &[0x6808, 0x681A], 3),
        ("LDR R0,[R1,R2]; STR R0,[R3,#20]", &[0x5888, 0x6158], 3),
        ("LDR R0,[R1,R2]; STR R1,[R3,R2]", &[0x5888, 0x5099], 3),
        (
            "LDR R0,[R1,R2]; LDR R4,[R3]; LDR R5,[R3,#4]",
            &[0x5888, 0x681C, 0x685D],
            4,
        ),
        // The second load's address is what the first one loads.
        (
            "STR R1,[R1]; LDR R1,[R1]; LDR R0,[R1]",
            &[0x6009, 0x6809, 0x6808],
            5,
        ),
    ];
    for (text, code, least) in examples {
        let cycles = cycles_of(code, code.len());
        assert_eq!(cycles.least, least, "{text}");
        assert!(cycles.greatest >= cycles.least, "{text}");
    }
}

#[test]
fn single_instructions_have_the_tables_cycles() {
    let table: [(&str, &[u16], [u64; 2]); 8] = [
        ("NOP", &[0xBF00], [1, 1]),
        ("UMULL", &[0xFBA2, 0x0103], [1, 1]),
        ("UDIV", &[0xFBB1, 0xF0F1], [2, 12]),
        ("STR with an immediate offset", &[0x6148], [1, 2]),
        ("PUSH of three", &[0xB407], [4, 4]),
        ("LDRD", &[0xE9D1, 0x0100], [3, 3]),
        ("B, taken", &[0xE7FE], [2, 4]),
        // The flags come from `movs r2, #0`: equal.
        ("BNE, not taken", &[0xD1FE], [1, 1]),
    ];
    for (text, code, [least, greatest]) in table {
        assert_eq!(cycles_of(code, 1), Cycles { least, greatest }, "{text}");
    }
}

/// Four halfwords to a line; a read takes up to 2 × 3 − 1 cycles where the core is three times as fast as the flash
/// (K20 manual 27.5.3).
#[test]
fn each_new_line_of_the_flash_is_waited_for_once() {
    let mut cpu = processor(&[0xBF00; 8], Pace::Least);
    let cycles = run(&mut cpu, 8, 3);
    assert_eq!(cycles.least, 8);
    assert_eq!(cycles.greatest, 8 + 2 * 4);

    // nop; nop; nop; b back to the first: all in the cache from the second round on.
    let mut cpu = processor(&[0xBF00, 0xBF00, 0xBF00, 0xE7FB], Pace::Least);
    run(&mut cpu, 4, 3);
    let cycles = run(&mut cpu, 4, 3);
    assert_eq!(
        cycles,
        Cycles {
            least: 3 + 2,
            greatest: 3 + 4
        }
    );
}

/// Writes DEMCR.TRCENA and DWT_CTRL.CYCCNTENA, leaves DWT_CYCCNT's address in r4, and a place in RAM in r1.
const START_COUNTER: [u16; 15] = [
    0xF64E, 0x54FC, // movw r4, #0xEDFC
    0xF2CE, 0x0400, // movt r4, #0xE000
    0xF04F, 0x7580, // mov r5, #0x01000000
    0x6025, // str r5, [r4]
    0xF241, 0x0400, // movw r4, #0x1000
    0xF2CE, 0x0400, // movt r4, #0xE000
    0x2501, // movs r5, #1
    0x6025, // str r5, [r4]
    0x3404, // adds r4, #4
    0xB090, // sub sp, #64
];
const START_STEPS: usize = 10;

#[test]
fn the_cycle_counter_counts_what_the_band_says() {
    for pace in [Pace::Least, Pace::Greatest] {
        let mut code = START_COUNTER.to_vec();
        // mov r1, sp; ldr r5, [r4]; a load, a division, a store, a push; ldr r6, [r4]
        code.extend([
            0x4669, 0x6825, 0x6808, 0xFBB1, 0xF0F1, 0x6148, 0xB407, 0x6826,
        ]);
        let mut cpu = processor(&code, pace);
        run(&mut cpu, START_STEPS + 1, 3);
        let between = run(&mut cpu, 5, 3);
        cpu.step(3);
        let registers = cpu.registers().0;
        let counted = u64::from(registers[6].wrapping_sub(registers[5]));
        assert_eq!(counted, pace.of(between), "{pace:?}");
    }
}

#[test]
fn the_cycle_counter_stands_still_in_sleep() {
    const IRQ: u16 = 24;
    let mut code = START_COUNTER.to_vec();
    // cpsid i; ldr r5, [r4]; wfi; ldr r6, [r4]
    code.extend([0xB672, 0x6825, 0xBF30, 0x6826]);
    let mut cpu = processor(&code, Pace::Least);
    run(&mut cpu, START_STEPS + 3, 1);
    assert!(cpu.is_asleep());
    run(&mut cpu, 50, 1);
    cpu.sleep(1_000_000);
    assert!(cpu.is_asleep());
    // Masked, an interrupt wakes the processor without being taken.
    cpu.enable_irq(IRQ);
    cpu.set_irq(IRQ, true);
    run(&mut cpu, 1, 1);
    assert!(!cpu.is_asleep());
    let registers = cpu.registers().0;
    let counted = registers[6].wrapping_sub(registers[5]);
    assert!((1..10).contains(&counted), "{counted}");
}
