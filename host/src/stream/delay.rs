//! How late samples are, by two clocks that do not know of each other.
//!
//! The device says when it measured, the host when it took. Their difference is the delay and an
//! offset that nobody knows, and which drifts: the crystals differ by some parts in a million. The
//! fastest samples of every second lie on a line, and how far a sample lies above it is how much
//! later than they it was. The fastest count as not late at all: what even they need stays unknown
//! (`cargo cost` counts it in the emulator).

use std::collections::VecDeque;

/// Seconds over which the line is drawn.
const SECONDS: usize = 20;

/// Above the fastest of the last seconds.
#[derive(Debug, Default)]
pub struct Delay {
    /// The least difference of each second: device time, difference.
    fastest: VecDeque<(f64, f64)>,
    second: f64,
}

impl Delay {
    /// By how much more than the fastest the sample measured at `device` and taken at `host` was late (s).
    pub fn of(&mut self, device: f64, host: f64) -> f64 {
        let difference = host - device;
        match self.fastest.back_mut() {
            Some(fastest) if (device - self.second).abs() < 1.0 => {
                if difference < fastest.1 {
                    *fastest = (device, difference);
                }
            }
            _ => {
                self.second = device;
                if self.fastest.len() == SECONDS {
                    self.fastest.pop_front();
                }
                self.fastest.push_back((device, difference));
            }
        }
        (difference - self.least(device)).max(0.0)
    }

    /// The line beneath all differences, at `device`.
    fn least(&self, device: f64) -> f64 {
        let slope = self.slope();
        let least = self
            .fastest
            .iter()
            .map(|&(time, difference)| difference - slope * (time - device));
        least.fold(f64::INFINITY, f64::min)
    }

    /// The drift of one clock against the other, by least squares, once there is enough of it to be seen.
    fn slope(&self) -> f64 {
        /// Two crystals cannot differ by more (s/s); beyond, it is a load that grows.
        const WORST: f64 = 300e-6;
        let count = self.fastest.len();
        if count < SECONDS / 2 {
            return 0.0;
        }
        let mean =
            |of: fn(&(f64, f64)) -> f64| self.fastest.iter().map(of).sum::<f64>() / count as f64;
        let (time, difference) = (mean(|f| f.0), mean(|f| f.1));
        let (mut product, mut square) = (0.0, 0.0);
        for &(t, d) in &self.fastest {
            product += (t - time) * (d - difference);
            square += (t - time) * (t - time);
        }
        (product / square).clamp(-WORST, WORST)
    }
}

#[cfg(test)]
mod tests {
    use super::Delay;

    /// Two clocks that differ by 100 parts in a million and by an hour; every tenth sample is 3 ms late.
    #[test]
    fn the_late_ones_are_seen_through_offset_and_drift() {
        let mut delay = Delay::default();
        for tick in 0..60_000_u32 {
            let device = f64::from(tick) * 1e-3;
            let late = if tick % 10 == 3 { 3e-3 } else { 0.0 };
            let found = delay.of(device, 3600.0 + device * (1.0 + 100e-6) + late);
            if tick > 12_000 {
                assert!((found - late).abs() < 0.2e-3, "{found} s at {device} s");
            }
        }
    }
}
