//! What the processor has to get right beyond the engine's own tests.

use std::sync::Arc;

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

const IRQ: u16 = 24;
const CODE: u32 = 0x410;
const HANDLER: u32 = 0x500;

fn processor(code: &[u16]) -> Cpu {
    let mut flash = vec![0xFF; FLASH_SIZE as usize];
    let mut word = |address: u32, value: u32| {
        flash[address as usize..][..4].copy_from_slice(&value.to_le_bytes());
    };
    word(0, 0x2000_8000);
    word(4, CODE | 1);
    word(4 * (16 + u32::from(IRQ)), HANDLER | 1);
    word(HANDLER, 0xBF00_4770); // bx lr
    for (index, halfword) in code.iter().enumerate() {
        let at = CODE as usize + 2 * index;
        flash[at..at + 2].copy_from_slice(&halfword.to_le_bytes());
    }
    Cpu::new(&flash, &Ram::new(), Arc::new(Nothing), Pace::Least)
}

/// ITSTATE travels with the exception frame (DDI 0403, B1.5.6), wherever in the block the interrupt
/// comes.
#[test]
fn an_interrupt_in_an_it_block_leaves_the_rest_of_the_block_conditional() {
    let code = [
        0x2000, // movs r0, #0
        0x2801, // cmp r0, #1
        0xBF02, // ittt eq
        0x2001, // moveq r0, #1
        0x3002, // addeq r0, #2
        0x3004, // addeq r0, #4
        0xE7FE, // b .
    ];
    for steps_before in 3..12 {
        let mut cpu = processor(&code);
        cpu.enable_irq(IRQ);
        for step in 0..30 {
            cpu.set_irq(IRQ, step == steps_before);
            cpu.step(1);
        }
        assert_eq!(
            cpu.registers().0[0],
            0,
            "interrupted at step {steps_before}"
        );
        assert_eq!(cpu.exception(), 0);
        assert_eq!(cpu.stack_pointer(), 0x2000_8000);
    }
}
