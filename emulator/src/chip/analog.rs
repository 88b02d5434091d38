//! The converters, and the voltages that the board has at their inputs.

use crate::peripherals::adc::{Adc, Inputs};
use crate::peripherals::clocks::Clocks;
use crate::peripherals::dac::Dac;
use crate::peripherals::vref::VoltageReference;
use crate::time::Ticks;

/// Supply of the analog part (V).
pub const VDDA: f64 = 3.3;
/// Band-gap buffer (data sheet: 0.97 to 1.03 V).
const BANDGAP: f64 = 1.0;
/// Temperature sensor at 25 °C (V) and its slope (V/°C), from the data sheet's ADC characteristics.
const TEMPERATURE_25: f64 = 0.719;
const TEMPERATURE_SLOPE: f64 = 0.001_715;

/// Analog inputs of the board, A0 to A20; A14 is the DAC's output.
const INPUTS: usize = 21;

/// ADC0, ADC1, DAC0 and the reference, with what is connected to them.
#[derive(Debug, Clone)]
pub struct Analog {
    pub(super) converters: [Adc; 2],
    pub(super) dac: Dac,
    pub(super) reference: VoltageReference,
    /// Voltage at each of the board's analog inputs, A0 to A20 (V).
    pub inputs: [f64; INPUTS],
    /// Temperature of the chip (°C).
    pub temperature: f64,
}

impl Analog {
    pub(super) fn new() -> Analog {
        Analog {
            converters: [Adc::new(), Adc::new()],
            dac: Dac::new(),
            reference: VoltageReference::new(),
            inputs: [0.0; INPUTS],
            temperature: 25.0,
        }
    }

    pub(super) fn reset(&mut self) {
        let Analog {
            inputs,
            temperature,
            ..
        } = *self;
        *self = Analog {
            inputs,
            temperature,
            ..Analog::new()
        };
    }

    /// What the DAC puts out (V); `None` while it is off.
    pub fn dac_output(&self, now: Ticks) -> Option<f64> {
        let (fraction, from_supply) = self.dac.output()?;
        Some(
            fraction
                * if from_supply {
                    VDDA
                } else {
                    self.reference.volts(now)
                },
        )
    }

    pub(super) fn next_event(&self) -> Ticks {
        self.converters[0]
            .next_event()
            .min(self.converters[1].next_event())
    }

    pub(super) fn advance(&mut self, clocks: &Clocks) {
        for number in 0..2 {
            if self.converters[number].next_event() <= clocks.now {
                let dac = self.dac_output(clocks.now).unwrap_or(0.0);
                let at = At {
                    number,
                    inputs: &self.inputs,
                    temperature: self.temperature,
                    reference: self.reference.volts(clocks.now),
                    dac,
                };
                self.converters[number].advance(clocks, &at);
            }
        }
    }
}

/// The voltages at one converter's channels.
struct At<'a> {
    number: usize,
    inputs: &'a [f64; INPUTS],
    temperature: f64,
    reference: f64,
    dac: f64,
}

impl Inputs for At<'_> {
    /// Channel assignments of ADC0 and ADC1 (K20 manual, chapter 3, "ADC channel assignments"), as far as the board
    /// brings them out; what it does not reads as 0 V.
    fn voltage(&self, channel: u32, alternate: bool) -> f64 {
        let input = match (self.number, channel, alternate) {
            (0, 5, true) => 0,
            (0, 14, _) => 1,
            (_, 8, _) => 2,
            (_, 9, _) => 3,
            (0, 13, _) => 4,
            (0, 12, _) => 5,
            (0, 6, true) => 6,
            (0, 7, true) => 7,
            (0, 15, _) => 8,
            (0, 4, true) => 9,
            (0, 0, _) | (1, 3, _) => 10,
            (0, 19, _) => 11,
            (0, 3, _) | (1, 0, _) => 12,
            (1, 19, _) => 13,
            (0, 23, _) => return self.dac,
            (1, 5, false) => 15,
            (1, 5, true) => 16,
            (1, 4, true) => 17,
            (1, 6, true) => 18,
            (1, 7, true) => 19,
            (1, 4, false) => 20,
            (0, 22, _) | (1, 18, _) => return self.reference,
            (_, 26, _) => return TEMPERATURE_25 - TEMPERATURE_SLOPE * (self.temperature - 25.0),
            (_, 27, _) => return BANDGAP,
            (_, 29, _) => return VDDA,
            _ => return 0.0,
        };
        self.inputs[input]
    }

    /// The differential pairs: DP0 and DM0 are A10 and A11 on ADC0, A12 and A13 on ADC1; DP3 and DM3 the other way round.
    fn difference(&self, channel: u32) -> f64 {
        match (self.number, channel) {
            (0, 0) | (1, 3) => self.inputs[10] - self.inputs[11],
            (1, 0) | (0, 3) => self.inputs[12] - self.inputs[13],
            (_, 26) => self.voltage(26, false),
            (_, 27) => BANDGAP,
            (_, 29) => VDDA,
            _ => 0.0,
        }
    }

    fn reference(&self, alternate: bool) -> f64 {
        if alternate {
            self.reference.max(f64::MIN_POSITIVE)
        } else {
            VDDA
        }
    }
}
