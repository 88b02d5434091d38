//! How long something has been waited for, as it counts for a program that looks again and again.

use std::time::{Duration, Instant};

/// A look counts no more than this, however long the computer stood still before it.
const LOOK: Duration = Duration::from_millis(100);

/// Waits for something that should have come: a pause of the whole computer, or of this program alone, is not laid
/// to the other side.
#[derive(Debug)]
pub struct Patience {
    looked: Instant,
    waited: Duration,
}

impl Patience {
    /// From now on.
    pub fn new() -> Self {
        Self {
            looked: Instant::now(),
            waited: Duration::ZERO,
        }
    }

    /// Looks once more: how long it has been waited for. To be asked ten times a second or more.
    pub fn look(&mut self) -> Duration {
        self.waited += self.looked.elapsed().min(LOOK);
        self.looked = Instant::now();
        self.waited
    }

    /// It has come, and the next is waited for.
    pub fn renew(&mut self) {
        *self = Self::new();
    }
}

impl Default for Patience {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::{LOOK, Patience};
    use std::thread::sleep;

    #[test]
    fn a_pause_counts_as_one_look() {
        let mut patience = Patience::new();
        sleep(3 * LOOK);
        assert_eq!(patience.look(), LOOK);
        sleep(LOOK / 2);
        assert!(patience.look() >= LOOK + LOOK / 2);
        patience.renew();
        assert!(patience.look() <= LOOK);
    }
}
