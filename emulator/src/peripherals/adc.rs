//! Analog-to-digital converter (K20 manual, chapter "Analog-to-Digital Converter (ADC)"): conversion times, averaging,
//! compare function, self-calibration, software and hardware triggers.

use super::clocks::Clocks;
use crate::time::{self, NEVER, Ticks};

const SC1B: u32 = 0x04;
const CFG1: u32 = 0x08;
const CFG2: u32 = 0x0C;
const RA: u32 = 0x10;
const RB: u32 = 0x14;
const CV1: u32 = 0x18;
const CV2: u32 = 0x1C;
const SC2: u32 = 0x20;
const SC3: u32 = 0x24;
/// Offset, gains and calibration values: registers that keep what is written.
const OFS: u32 = 0x28;
const CLM0: u32 = 0x6C;

/// SC1n.
const COCO: u32 = 1 << 7;
const AIEN: u32 = 1 << 6;
const DIFF: u32 = 1 << 5;
const OFF: u32 = 0x1F;
/// SC2.
const ADACT: u32 = 1 << 7;
const ADTRG: u32 = 1 << 6;
const ACFE: u32 = 1 << 5;
const ACFGT: u32 = 1 << 4;
const ACREN: u32 = 1 << 3;
const DMAEN: u32 = 1 << 2;
/// SC3.
const CAL: u32 = 1 << 7;
const CALF: u32 = 1 << 6;
const ADCO: u32 = 1 << 3;
const AVGE: u32 = 1 << 2;

/// The converter's own asynchronous clock (data sheet, normal power, typical).
const ADACK_HZ: u32 = 5_200_000;
/// Conversions that a calibration makes, each averaged as SC3 says.
const CALIBRATION_STEPS: u64 = 15;
/// Calibration registers' values at reset, from OFS on; a calibration finds an ideal converter.
const CALIBRATION: [u32; 18] = [
    0x0004, 0x8200, 0x8200, 0x0A, 0x20, 0x200, 0x100, 0x80, 0x40, 0x20, 0, 0x0A, 0x20, 0x200,
    0x100, 0x80, 0x40, 0x20,
];

/// What a converter is connected to, at the moment of a conversion.
pub trait Inputs {
    /// Voltage of a channel (V); `alternate` selects the "b" inputs (MUXSEL of CFG2).
    fn voltage(&self, channel: u32, alternate: bool) -> f64;
    /// Voltage between the two inputs of a differential channel (V).
    fn difference(&self, channel: u32) -> f64;
    /// The reference (V): the alternate one is the internal 1.2 V.
    fn reference(&self, alternate: bool) -> f64;
}

#[derive(Debug, Clone, Copy)]
enum Running {
    Conversion { trigger: usize, until: Ticks },
    Calibration { until: Ticks },
}

/// One converter.
#[derive(Debug, Clone)]
pub struct Adc {
    status: [u32; 2],
    result: [u32; 2],
    configuration: [u32; 2],
    compare: [u32; 2],
    sc2: u32,
    sc3: u32,
    calibration: [u32; 18],
    running: Option<Running>,
}

impl Adc {
    /// The state after reset.
    pub fn new() -> Adc {
        Adc {
            status: [OFF; 2],
            result: [0; 2],
            configuration: [0; 2],
            compare: [0; 2],
            sc2: 0,
            sc3: 0,
            calibration: CALIBRATION,
            running: None,
        }
    }

    /// When the running conversion ends.
    pub fn next_event(&self) -> Ticks {
        match self.running {
            Some(Running::Conversion { until, .. } | Running::Calibration { until }) => until,
            None => NEVER,
        }
    }

    /// Whether a finished conversion asks for its interrupt.
    pub fn interrupt(&self) -> bool {
        self.status
            .iter()
            .any(|status| status & (COCO | AIEN) == COCO | AIEN)
    }

    /// Whether a finished conversion asks for DMA.
    pub fn dma_request(&self) -> bool {
        self.sc2 & DMAEN != 0 && self.status.iter().any(|status| status & COCO != 0)
    }

    /// ADCK.
    fn clock_hz(&self, clocks: &Clocks) -> u32 {
        let source = match self.configuration[0] & 3 {
            0 => clocks.bus_hz,
            1 => clocks.bus_hz / 2,
            2 => clocks.crystal_hz,
            _ => ADACK_HZ,
        };
        source >> (self.configuration[0] >> 5 & 3)
    }

    fn bits(&self) -> u32 {
        [8, 12, 10, 16][(self.configuration[0] >> 2 & 3) as usize]
    }

    /// Sample time and total conversion time: the first conversion's adder, then the rest once for each sample averaged.
    fn conversion_time(&self, differential: bool, samples: u64, clocks: &Clocks) -> Ticks {
        let (long, fast) = (
            self.configuration[0] & 1 << 4 != 0,
            self.configuration[1] & 1 << 2 != 0,
        );
        let base = match (self.bits(), differential) {
            (8, false) => 17,
            (8, true) => 27,
            (16, false) => 25,
            (16, true) => 34,
            (_, false) => 20,
            (_, true) => 30,
        };
        let sampling = if long {
            [20, 12, 6, 2][(self.configuration[1] & 3) as usize]
        } else {
            0
        };
        let high_speed = if fast { 2 } else { 0 };
        let first = if long { 3 } else { 5 };
        let cycles = first + samples * (base + sampling + high_speed);
        time::of_cycles(cycles, self.clock_hz(clocks)) + time::of_cycles(5, clocks.bus_hz)
    }

    fn samples(&self) -> u64 {
        if self.sc3 & AVGE != 0 {
            4 << (self.sc3 & 3)
        } else {
            1
        }
    }

    fn start(&mut self, trigger: usize, clocks: &Clocks) {
        self.running = None;
        if self.status[trigger] & OFF != OFF {
            let differential = self.status[trigger] & DIFF != 0;
            let until = clocks.now + self.conversion_time(differential, self.samples(), clocks);
            self.running = Some(Running::Conversion { trigger, until });
        }
    }

    /// A hardware trigger for SC1A (0) or SC1B (1).
    pub fn trigger(&mut self, trigger: usize, clocks: &Clocks) {
        if self.sc2 & ADTRG != 0 && self.running.is_none() {
            self.start(trigger, clocks);
        }
    }

    /// Ends the running conversion if its time has come.
    pub fn advance(&mut self, clocks: &Clocks, inputs: &dyn Inputs) {
        if clocks.now < self.next_event() {
            return;
        }
        match self.running.take() {
            Some(Running::Calibration { .. }) => {
                self.sc3 &= !CAL;
                self.calibration = CALIBRATION;
                self.status[0] |= COCO;
            }
            Some(Running::Conversion { trigger, .. }) => {
                let code = self.convert(self.status[trigger], inputs);
                if self.compares(code) {
                    self.result[trigger] = code;
                    self.status[trigger] |= COCO;
                }
                if self.sc3 & ADCO != 0 {
                    self.start(trigger, clocks);
                }
            }
            None => {}
        }
    }

    /// An ideal conversion, rounded to the nearest code and clipped.
    fn convert(&self, status: u32, inputs: &dyn Inputs) -> u32 {
        let channel = status & OFF;
        let reference = inputs.reference(self.sc2 & 3 == 1);
        if status & DIFF != 0 {
            // One bit more than single-ended, the sign; sixteen bits in all at most.
            let bits = (self.bits() + 1).min(16);
            let half = f64::from(1u32 << (bits - 1));
            let code = (inputs.difference(channel) / reference * half).round();
            (code.clamp(-half, half - 1.0) as i32) as u32 & 0xFFFF
        } else {
            let full = f64::from(1u32 << self.bits());
            let code = (inputs.voltage(channel, self.configuration[1] & 1 << 4 != 0) / reference
                * full)
                .round();
            code.clamp(0.0, full - 1.0) as u32
        }
    }

    /// Whether the compare function lets a result through.
    fn compares(&self, code: u32) -> bool {
        let [low, high] = self.compare;
        match (
            self.sc2 & ACFE != 0,
            self.sc2 & ACREN != 0,
            self.sc2 & ACFGT != 0,
        ) {
            (false, _, _) => true,
            (true, false, false) => code < low,
            (true, false, true) => code >= low,
            (true, true, false) if low <= high => code < low || code > high,
            (true, true, false) => code < low && code > high,
            (true, true, true) if low <= high => code >= low && code <= high,
            (true, true, true) => code >= low || code <= high,
        }
    }

    /// Reads a 32-bit register; reading a result clears its COCO.
    pub fn read(&mut self, offset: u32) -> u32 {
        match offset {
            0x00 | SC1B => self.status[offset as usize / 4],
            CFG1 | CFG2 => self.configuration[(offset - CFG1) as usize / 4],
            RA | RB => {
                let n = (offset - RA) as usize / 4;
                self.status[n] &= !COCO;
                self.result[n]
            }
            CV1 | CV2 => self.compare[(offset - CV1) as usize / 4],
            SC2 => {
                let active = matches!(self.running, Some(Running::Conversion { .. }));
                self.sc2 | if active { ADACT } else { 0 }
            }
            SC3 => self.sc3,
            OFS..=CLM0 => self
                .calibration
                .get((offset - OFS) as usize / 4)
                .copied()
                .unwrap_or(0),
            _ => 0,
        }
    }

    /// Writes a 32-bit register; writing SC1A with software trigger starts a conversion and aborts the one before.
    pub fn write(&mut self, offset: u32, value: u32, clocks: &Clocks) {
        match offset {
            0x00 | SC1B => {
                let n = offset as usize / 4;
                self.status[n] = value & 0x7F;
                if n == 0 && self.sc2 & ADTRG == 0 {
                    self.abort_calibration();
                    self.start(0, clocks);
                }
            }
            CFG1 | CFG2 => self.configuration[(offset - CFG1) as usize / 4] = value & 0xFF,
            CV1 | CV2 => self.compare[(offset - CV1) as usize / 4] = value & 0xFFFF,
            SC2 => self.sc2 = value & 0x7F,
            SC3 => {
                self.abort_calibration();
                self.running = None;
                let failed = self.sc3 & CALF & !value;
                self.sc3 = value & (CAL | ADCO | AVGE | 3) | failed;
                if value & CAL != 0 {
                    self.status[0] &= !COCO;
                    let steps = CALIBRATION_STEPS * self.samples();
                    let until = clocks.now + self.conversion_time(false, steps, clocks);
                    self.running = Some(Running::Calibration { until });
                }
            }
            OFS..=CLM0 => {
                if let Some(register) = self.calibration.get_mut((offset - OFS) as usize / 4) {
                    *register = value & 0xFFFF;
                }
            }
            _ => {}
        }
    }

    /// Touching the converter during a calibration makes it fail.
    fn abort_calibration(&mut self) {
        if let Some(Running::Calibration { .. }) = self.running {
            self.running = None;
            self.sc3 = self.sc3 & !CAL | CALF;
        }
    }
}

impl Default for Adc {
    fn default() -> Adc {
        Adc::new()
    }
}
