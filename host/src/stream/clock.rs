//! The device's clock, over its wraps.

/// Makes of microseconds that begin anew every 71.6 minutes seconds that do not.
#[derive(Debug, Default)]
pub struct Clock {
    last: Option<u32>,
    seconds: f64,
}

impl Clock {
    /// The same moment in s. The first is taken as it is; a step back of less than half the range stays one.
    pub fn seconds(&mut self, micros: u32) -> f64 {
        self.seconds = match self.last {
            None => f64::from(micros) * 1e-6,
            Some(last) => self.seconds + f64::from(micros.wrapping_sub(last).cast_signed()) * 1e-6,
        };
        self.last = Some(micros);
        self.seconds
    }
}

#[cfg(test)]
mod tests {
    use super::Clock;

    #[test]
    fn goes_on_over_a_wrap() {
        let mut clock = Clock::default();
        assert_eq!(clock.seconds(u32::MAX - 999), 4294.966296);
        assert!((clock.seconds(1000) - 4294.968296).abs() < 1e-9);
        assert!((clock.seconds(500) - 4294.967796).abs() < 1e-9);
    }
}
