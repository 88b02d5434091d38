//! A sensor that is turned by hand: whoever watches says where it is to point, and it goes there as a hand
//! would carry it.
//!
//! The hand is a critically damped spring between the orientation as it is and as it is wanted. Its state is
//! kept a millisecond apart for the last second, so that whoever asks for one moment twice gets one answer.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::{UnitQuaternion, Vector3};
use vrduino_emulator::motion::{GRAVITY, Instant, Motion};

/// Between two states (s).
const STEP: f64 = 1e-3;

/// States that are kept.
const KEPT: usize = 1000;

/// How quickly the hand follows (rad/s): a turn is done in about half a second.
const STIFFNESS: f64 = 12.0;

/// The hand, which several may hold.
#[derive(Clone, Debug, Default)]
pub struct Hand(Arc<Mutex<Way>>);

#[derive(Debug)]
struct Way {
    target: UnitQuaternion<f64>,
    /// The latest last.
    states: VecDeque<State>,
    /// Number of the latest: it is so many steps since the beginning.
    latest: u64,
}

/// At one moment.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    /// Body to world.
    orientation: UnitQuaternion<f64>,
    /// In the body frame (rad/s).
    rate: Vector3<f64>,
}

impl Default for Way {
    fn default() -> Self {
        Self {
            target: UnitQuaternion::identity(),
            states: VecDeque::from([State::default()]),
            latest: 0,
        }
    }
}

impl Hand {
    /// Where it is to point from now on: body to world, w, x, y, z. What is no rotation is passed over.
    pub fn turn_to(&self, [w, x, y, z]: [f64; 4]) {
        let q = nalgebra::Quaternion::new(w, x, y, z);
        if let Some(target) = UnitQuaternion::try_new(q, 0.5).filter(|_| q.norm() < 2.0) {
            self.0.lock().unwrap_or_else(PoisonError::into_inner).target = target;
        }
    }
}

impl Motion for Hand {
    fn at(&self, t: f64) -> Instant {
        let state = self.0.lock().unwrap_or_else(PoisonError::into_inner).at(t);
        let force = state.orientation.inverse() * Vector3::new(0.0, GRAVITY, 0.0);
        let q = state.orientation;
        Instant {
            rate: state.rate.into(),
            force: force.into(),
            field: None,
            truth: Some([q.w, q.i, q.j, q.k]),
        }
    }

    fn duration(&self) -> Option<f64> {
        None
    }

    fn describe(&self) -> String {
        "turned by hand".into()
    }
}

impl Way {
    fn at(&mut self, t: f64) -> State {
        let steps = (t / STEP).max(0.0);
        while (self.latest as f64) < steps {
            self.advance();
        }
        let first = self.latest + 1 - self.states.len() as u64;
        // Longer ago than a second nobody asks; the oldest would do.
        let since = (steps - first as f64).max(0.0);
        let (index, part) = (since.floor() as usize, since.fract());
        let last = self.states.len() - 1;
        let (a, b) = (
            self.states[index.min(last)],
            self.states[(index + 1).min(last)],
        );
        State {
            orientation: a.orientation.slerp(&b.orientation, part),
            rate: a.rate.lerp(&b.rate, part),
        }
    }

    fn advance(&mut self) {
        let Some(&State { orientation, rate }) = self.states.back() else {
            return;
        };
        let missing = (orientation.inverse() * self.target).scaled_axis();
        let acceleration = missing * (STIFFNESS * STIFFNESS) - rate * (2.0 * STIFFNESS);
        let next = rate + acceleration * STEP;
        // By the mean of both rates, so that they add up to the turn.
        let turn = UnitQuaternion::from_scaled_axis((rate + next) * (STEP / 2.0));
        self.states.push_back(State {
            orientation: orientation * turn,
            rate: next,
        });
        self.latest += 1;
        if self.states.len() > KEPT {
            self.states.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angle_to(hand: &Hand, t: f64, target: UnitQuaternion<f64>) -> f64 {
        let [w, x, y, z] = hand.at(t).truth.expect("known");
        UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z)).angle_to(&target)
    }

    #[test]
    fn arrives_where_it_is_wanted() {
        let hand = Hand::default();
        assert!(angle_to(&hand, 1.0, UnitQuaternion::identity()) < 1e-12);
        let target = UnitQuaternion::from_euler_angles(0.3, 2.0, -0.5);
        hand.turn_to([target.w, target.i, target.j, target.k]);
        assert!(angle_to(&hand, 1.05, target) > 0.5);
        assert!(angle_to(&hand, 3.0, target) < 1e-6);
        let there = hand.at(3.0);
        assert!(Vector3::from(there.rate).norm() < 1e-6);
        assert_eq!(hand.at(3.0), there);
    }

    /// What a gyro measures on the way is the way.
    #[test]
    fn its_rates_add_up_to_its_turn() {
        let hand = Hand::default();
        let mut q = UnitQuaternion::identity();
        for step in 0..4000_u32 {
            let t = f64::from(step) * 0.5e-3;
            if step == 100 {
                hand.turn_to([0.0, 0.6, 0.0, 0.8]);
            }
            q *=
                UnitQuaternion::from_scaled_axis(Vector3::from(hand.at(t + 0.25e-3).rate) * 0.5e-3);
        }
        assert!(
            angle_to(&hand, 2.0, q) < 1e-4,
            "{}",
            angle_to(&hand, 2.0, q)
        );
    }

    #[test]
    fn what_is_no_rotation_moves_nothing() {
        let hand = Hand::default();
        for odd in [
            [0.0; 4],
            [f64::NAN, 0.0, 0.0, 1.0],
            [f64::INFINITY; 4],
            [9.0; 4],
        ] {
            hand.turn_to(odd);
            assert!(angle_to(&hand, 5.0, UnitQuaternion::identity()) < 1e-12);
        }
    }
}
