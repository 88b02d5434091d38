//! The LED on pin 13 (PTC5).

use embedded_hal::digital::OutputPin;
use mk20dx_hal::gpio::{GpioExt, Output, Pin, PushPull};
use mk20dx_hal::pac;

/// The LED.
pub struct Led {
    pin: Pin<'C', 5, Output<PushPull>>,
}

impl Led {
    /// Takes the pin.
    pub fn new(port: pac::Portc, gpio: pac::Ptc, sim: &pac::Sim) -> Led {
        Led {
            pin: port.split(gpio, sim).pc5.into_push_pull_output(),
        }
    }

    /// Tracking: a short flash every second.
    pub fn heartbeat(&mut self, milliseconds: u32) {
        self.set(milliseconds % 1024 < 64);
    }

    /// No sensor: four flashes a second.
    pub fn distress(&mut self, milliseconds: u32) {
        self.set(milliseconds % 256 < 128);
    }

    fn set(&mut self, on: bool) {
        // An output pin of this chip cannot fail.
        let _ = self.pin.set_state(on.into());
    }
}
