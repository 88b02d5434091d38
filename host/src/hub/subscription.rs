//! What is passed on waits in a queue for whoever wanted it.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::{Update, lock};
use crate::stream::Item;

/// What is kept for one who is slow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// The newest: so many updates at most.
    Newest(usize),
    /// Everything.
    All,
}

/// A place in the line; it is given up when this is dropped.
#[derive(Debug)]
pub struct Subscription {
    queue: Arc<Queue>,
}

#[derive(Debug)]
pub(super) struct Queue {
    hold: Hold,
    updates: Mutex<VecDeque<Update>>,
    arrived: Condvar,
    wanted: AtomicBool,
    dropped: AtomicU64,
}

impl Subscription {
    pub(super) fn new(hold: Hold) -> (Self, Arc<Queue>) {
        let queue = Arc::new(Queue {
            hold,
            updates: Mutex::default(),
            arrived: Condvar::new(),
            wanted: AtomicBool::new(true),
            dropped: AtomicU64::new(0),
        });
        (
            Self {
                queue: Arc::clone(&queue),
            },
            queue,
        )
    }

    /// The next, if one comes within this time.
    pub fn next(&self, patience: Duration) -> Option<Update> {
        let until = Instant::now() + patience;
        let mut updates = lock(&self.queue.updates);
        loop {
            if let Some(update) = updates.pop_front() {
                return Some(update);
            }
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return None;
            }
            let waited = self.queue.arrived.wait_timeout(updates, left);
            updates = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Samples that were dropped because they were not taken in time.
    pub fn dropped(&self) -> u64 {
        self.queue.dropped.load(Ordering::Relaxed)
    }
}

impl Drop for Subscription {
    fn drop(&mut self) {
        self.queue.wanted.store(false, Ordering::Relaxed);
    }
}

impl Queue {
    pub fn is_wanted(&self) -> bool {
        self.wanted.load(Ordering::Relaxed)
    }

    pub fn push(&self, update: Update) {
        let mut updates = lock(&self.updates);
        if let Hold::Newest(count) = self.hold {
            while updates.len() >= count.max(1) {
                if let Some(Update::Stream(items)) = updates.pop_front() {
                    let samples = items
                        .iter()
                        .filter(|item| matches!(item, Item::Sample(_)))
                        .count();
                    self.dropped.fetch_add(samples as u64, Ordering::Relaxed);
                }
            }
        }
        updates.push_back(update);
        self.arrived.notify_one();
    }
}
