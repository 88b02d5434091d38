//! Every sample is read once, soon, and with the time at which it was ready, whatever the sensor's clock.

#[path = "random/mod.rs"]
mod random;

#[path = "sampling/bench.rs"]
mod bench;

use bench::{Bench, Sensor};

/// Seconds in which the loop has to lock.
const TO_LOCK: f64 = 2.0;

const ERRORS: [f64; 7] = [-0.01, -0.005, -0.000_3, 0.0, 0.000_1, 0.004, 0.01];

#[test]
fn within_two_seconds_each_sample_is_read_once_whatever_the_clock() {
    for error in ERRORS {
        for phase in [0.0, 0.2, 0.5, 0.99] {
            let mut bench = Bench::new(Sensor::new(error, phase));
            bench.run(TO_LOCK);
            assert!(bench.ready.is_locked(), "clock {error}, phase {phase}");
            let before = bench.counts();
            bench.run(20.0);
            let counts = bench.counts().since(before);
            assert_eq!((counts.lost, counts.repeated, counts.told_lost), (0, 0, 0));
            let expected = 20_000.0 * (1.0 + error);
            assert!((counts.read as f64 - expected).abs() <= 1.0, "{counts:?}");
        }
    }
}

#[test]
fn the_time_is_that_of_data_ready_and_the_period_is_the_sensors() {
    for error in ERRORS {
        let mut bench = Bench::new(Sensor::new(error, 0.3));
        bench.run(TO_LOCK);
        bench.errors_us.clear();
        bench.run(20.0);
        let worst = bench.errors_us.iter().fold(0.0, |a: f64, e| a.max(e.abs()));
        assert!(worst < 1.1, "{worst} µs off at {error}");
        let period = 1e6 / (1.0 + error);
        let measured = f64::from(bench.last.period_ns);
        assert!(
            (measured - period).abs() < 30.0,
            "{measured} ns for {period}"
        );
    }
}

#[test]
fn a_sample_is_asked_for_within_microseconds_and_seldom_in_vain() {
    let mut bench = Bench::new(Sensor::new(0.006, 0.3));
    bench.run(TO_LOCK);
    bench.delays_us.clear();
    let asked = bench.counts();
    bench.run(20.0);
    bench.delays_us.sort_by(f64::total_cmp);
    let median = bench.delays_us[bench.delays_us.len() / 2];
    let worst = bench.delays_us[bench.delays_us.len() - 1];
    assert!(median < 2.0, "{median} µs in the median");
    assert!(worst < bench::ASK_US + 5.0, "{worst} µs at worst");
    let in_vain = bench.counts().since(asked).in_vain;
    assert!((20..=200).contains(&in_vain), "{in_vain} in twenty seconds");
}

#[test]
fn an_oscillator_that_warms_up_is_followed() {
    // 0.1 % in a hundred seconds.
    for drift in [-1e-5, 1e-5] {
        let mut sensor = Sensor::new(0.002, 0.1);
        sensor.drift = drift;
        let mut bench = Bench::new(sensor);
        bench.run(TO_LOCK);
        bench.errors_us.clear();
        let before = bench.counts();
        bench.run(60.0);
        let counts = bench.counts().since(before);
        assert_eq!((counts.lost, counts.repeated), (0, 0));
        let worst = bench.errors_us.iter().fold(0.0, |a: f64, e| a.max(e.abs()));
        assert!(worst < 4.0, "{worst} µs off");
    }
}

#[test]
fn jitter_of_the_sensor_and_of_the_interrupt_costs_no_sample() {
    for (jitter, service) in [(0.5, 0.0), (2.0, 1.0), (5.0, 3.0)] {
        let mut sensor = Sensor::new(-0.004, 0.7);
        sensor.jitter_us = jitter;
        let mut bench = Bench::new(sensor);
        bench.service_us = service;
        bench.run(TO_LOCK);
        let before = bench.counts();
        bench.run(20.0);
        let counts = bench.counts().since(before);
        assert_eq!((counts.lost, counts.repeated), (0, 0), "jitter {jitter}");
        let period = 1e6 / (1.0 - 0.004);
        assert!((f64::from(bench.last.period_ns) - period).abs() < 40.0 * (1.0 + jitter));
    }
}

#[test]
fn reads_that_fail_are_counted_and_the_lock_is_kept() {
    let mut bench = Bench::new(Sensor::new(0.008, 0.4));
    bench.run(TO_LOCK);
    let before = bench.counts();
    for burst in 1..8 {
        bench.fail_next(burst);
        bench.run(1.0);
    }
    let counts = bench.counts().since(before);
    assert_eq!((counts.lost, counts.told_lost), (28, 28));
    assert_eq!(counts.repeated, 0);
    assert!(bench.ready.is_locked());
    bench.errors_us.clear();
    bench.run(1.0);
    assert!(bench.errors_us.iter().all(|error| error.abs() < 1.1));
}

#[test]
fn a_sensor_that_stops_is_repeated_and_one_that_starts_again_is_locked_on_anew() {
    for phase in [0.1, 0.45, 0.8] {
        let mut bench = Bench::new(Sensor::new(-0.007, 0.0));
        bench.run(TO_LOCK);
        let before = bench.counts();
        bench.pause(0.3, phase);
        bench.run(0.3);
        let repeated = bench.counts().since(before).repeated;
        assert!((290..=310).contains(&repeated), "{repeated} in 0.3 s");
        bench.run(TO_LOCK);
        assert!(bench.ready.is_locked());
        let before = bench.counts();
        bench.errors_us.clear();
        bench.run(5.0);
        let counts = bench.counts().since(before);
        assert_eq!((counts.lost, counts.repeated), (0, 0));
        assert!(bench.errors_us.iter().all(|error| error.abs() < 1.1));
    }
}

#[test]
fn a_phase_that_jumps_unseen_is_found_again() {
    for jump_us in [-400.0, -30.0, 30.0, 400.0] {
        let mut bench = Bench::new(Sensor::new(0.003, 0.0));
        bench.run(TO_LOCK);
        bench.sensor.jump(jump_us);
        bench.run(4.0);
        assert!(bench.ready.is_locked(), "{jump_us} µs");
        let before = bench.counts();
        bench.errors_us.clear();
        bench.run(5.0);
        let counts = bench.counts().since(before);
        assert_eq!((counts.lost, counts.repeated), (0, 0));
        assert!(bench.errors_us.iter().all(|error| error.abs() < 1.1));
    }
}

#[test]
fn the_loop_does_not_depend_on_the_clock_that_it_is_given() {
    for ticks_per_us in [16, 24, 60, 72, 200] {
        let mut bench = Bench::with_clock(Sensor::new(0.01, 0.3), ticks_per_us);
        bench.run(TO_LOCK);
        bench.errors_us.clear();
        bench.run(5.0);
        assert!(bench.ready.is_locked(), "{ticks_per_us} ticks");
        assert!(bench.errors_us.iter().all(|error| error.abs() < 1.1));
    }
}

#[test]
fn read_by_another_clock_repeats_and_omissions_are_counted_and_the_time_is_known() {
    for error in [-0.01, -0.000_4, 0.000_4, 0.01] {
        let mut bench = Bench::new(Sensor::new(error, 0.3));
        bench.run(TO_LOCK);
        bench.errors_us.clear();
        let before = bench.counts();
        bench.run_by_the_host(20.0);
        let counts = bench.counts().since(before);
        assert!(counts.lost.abs_diff(counts.told_lost) <= 2, "{counts:?}");
        let beats = (20_000.0 * error).abs();
        let odd = f64::from(counts.lost + counts.repeated);
        assert!((odd - beats).abs() <= 2.0, "{odd} for {beats}");
        // Which read was the one behind an omission, nothing tells.
        let off = bench.errors_us.iter().filter(|e| e.abs() > 25.0).count();
        assert!(off <= 200, "{off} of twenty thousand at {error}");
        // And back.
        bench.ready.resume();
        bench.run(TO_LOCK);
        assert!(bench.ready.is_locked());
    }
}
