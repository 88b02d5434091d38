//! Every estimator on every trial, on all cores.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use nalgebra::UnitQuaternion;

use crate::estimators::Estimator;
use crate::score::Score;
use crate::trial::Trial;
use crate::variant::Variant;

/// What one estimator made of one trial.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Its errors.
    pub score: Score,
    /// Body → world (y up) after each sample.
    pub orientations: Vec<UnitQuaternion<f64>>,
}

/// Outcomes by estimator, then by trial.
pub fn run(estimators: &[Estimator], trials: &[Trial], variant: Variant) -> Vec<Vec<Outcome>> {
    let per_trial = in_parallel(trials, |trial| {
        let changed = variant.of(trial);
        let outcome = |estimator: &Estimator| {
            let orientations = estimator.run(&changed);
            Outcome {
                score: Score::of(&changed, &orientations),
                orientations,
            }
        };
        estimators.iter().map(outcome).collect::<Vec<_>>()
    });
    let mut columns: Vec<Vec<Outcome>> = estimators.iter().map(|_| Vec::new()).collect();
    for row in per_trial {
        for (column, outcome) in columns.iter_mut().zip(row) {
            column.push(outcome);
        }
    }
    columns
}

/// The scores alone, by estimator.
pub fn scores(outcomes: &[Vec<Outcome>]) -> Vec<Vec<Score>> {
    let of = |column: &Vec<Outcome>| column.iter().map(|outcome| outcome.score).collect();
    outcomes.iter().map(of).collect()
}

fn in_parallel<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let mut results: Vec<(usize, R)> = thread::scope(|scope| {
        let worker = || {
            let mut done = Vec::new();
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let Some(item) = items.get(index) else {
                    return done;
                };
                done.push((index, work(item)));
            }
        };
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(worker)).collect();
        let join = |worker: thread::ScopedJoinHandle<'_, Vec<(usize, R)>>| {
            worker.join().expect("a worker does not panic")
        };
        workers.into_iter().flat_map(join).collect()
    });
    results.sort_by_key(|(index, _)| *index);
    results.into_iter().map(|(_, result)| result).collect()
}
