//! What a host sees, sample by sample: the same code the board runs.

#[path = "tracker/bench.rs"]
mod bench;

use bench::{Bench, LEVEL, handled};
use nalgebra::{UnitQuaternion, Vector3};
use vrduino::sampling::Timing;
use vrduino::sensor::RawSample;
use vrduino::tracker::{Health, STILL_DEADLINE};

const WARNING: &str =
    "warning: not still for 5 s, gyro bias unknown: lay the board down for two seconds\n";

fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace()
        .skip(1)
        .map(|number| number.parse().expect("a number"))
        .collect()
}

#[test]
fn a_still_start_takes_one_second() {
    let mut bench = Bench::new();
    bench.feed(2000, |_| LEVEL);
    assert_eq!(bench.lines[0], (1, "Measuring bias\n".into()));
    let bias = "Bias: 0.000 0.488 0.000 deg/s (still)\n";
    assert_eq!(bench.lines[1], (1000, bias.into()));
    assert_eq!(
        bench.lines[2],
        (1000, "QC 1.000 0.000 0.000 0.000\n".into())
    );
    // Then a hundred lines a second, evenly, and without the bias nothing turns.
    for (n, (at, line)) in bench.lines.iter().skip(2).enumerate() {
        assert_eq!(*at, 1000 + 10 * n as u32);
        assert_eq!(line, "QC 1.000 0.000 0.000 0.000\n");
    }
    assert_eq!(bench.lines.len(), 2 + 101);
}

#[test]
fn the_first_orientation_has_the_tilt_of_the_board_and_no_yaw() {
    let mut bench = Bench::new();
    // Pitched down by 30°: y and +z share the force.
    bench.feed(1000, |_| RawSample {
        accel: [0, 1774, 1024],
        ..LEVEL
    });
    assert_eq!(bench.lines[2].1, "QC 0.966 -0.259 0.000 0.000\n");
}

#[test]
fn a_moving_start_streams_after_five_seconds_with_a_warning() {
    let mut bench = Bench::new();
    bench.feed(6000, handled);
    assert_eq!(bench.lines[0].1, "Measuring bias\n");
    assert_eq!(bench.lines[1], (STILL_DEADLINE, WARNING.into()));
    let (at, line) = &bench.lines[2];
    assert_eq!(*at, STILL_DEADLINE);
    assert!(line.starts_with("QC "), "{line}");
    assert_eq!(bench.lines.len(), 2 + 101);
}

#[test]
fn putting_the_board_down_late_still_gets_it_measured() {
    let mut bench = Bench::new();
    bench.feed(2500, handled);
    bench.feed(2000, |_| LEVEL);
    assert_eq!(bench.lines[1].0, 4000);
    assert_eq!(bench.lines[1].1, "Bias: 0.000 0.488 0.000 deg/s (still)\n");
}

#[test]
fn a_turn_shows_as_that_turn() {
    let mut bench = Bench::started();
    // Yaw left by 90° in a second: 90 °/s is 1474.56 counts, on top of the bias.
    bench.feed(1000, |i| RawSample {
        gyro: [0, 8 + 1474 + i16::from(i % 25 < 14), 0],
        ..LEVEL
    });
    assert_eq!(bench.texts().last(), Some(&"QC 0.707 0.000 0.707 0.000\n"));
    let expected = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 90_f32.to_radians());
    assert!(bench.tracker.orientation().angle_to(&expected) < 1e-3);
}

#[test]
fn b_measures_again_in_the_background() {
    let mut bench = Bench::started();
    bench.press(b'b');
    let warmer = RawSample {
        gyro: [0, 16, 0],
        ..LEVEL
    };
    bench.feed(1000, |_| warmer);
    assert_eq!(bench.lines[0], (1001, "Measuring bias\n".into()));
    assert_eq!(bench.tagged("QC").len(), 100, "the stream goes on");
    assert_eq!(bench.tagged("Bias: 0.000 0.977 0.000").len(), 1);
    // The old bias was in use until then, so it turned by 0.488° and turns no more.
    let before = bench.tracker.orientation();
    assert!((before.angle().to_degrees() - 0.488).abs() < 0.01);
    bench.feed(1000, |_| warmer);
    assert!(bench.tracker.orientation().angle_to(&before) < 1e-5);
}

#[test]
fn b_gives_up_after_five_seconds_of_motion() {
    let mut bench = Bench::started();
    bench.press(b'b');
    bench.feed(5000, handled);
    let (at, _) = bench.lines[bench.lines.len() - 2];
    assert_eq!(at, 6000);
    assert_eq!(
        bench.tagged("warning"),
        ["warning: moved for 5 s, gyro bias kept\n"]
    );
    assert_eq!(bench.tagged("QC").len(), 500);
    bench.lines.clear();
    bench.press(b'3');
    bench.feed(10, |_| LEVEL);
    // The integral has followed these hundredths of a degree; a measurement would not be zero either.
    let left = numbers(bench.texts()[0]);
    assert!(left.iter().all(|rate| rate.abs() < 0.03), "{left:?}");
}

#[test]
fn r_faces_ahead_and_keeps_the_tilt_of_the_board() {
    let mut bench = Bench::started();
    bench.feed(1000, |_| RawSample {
        gyro: [300, 1500, -700],
        ..LEVEL
    });
    assert!(bench.tracker.orientation().angle() > 0.5);
    bench.press(b'r');
    let pitched = RawSample {
        accel: [0, 1774, 1024],
        ..LEVEL
    };
    bench.lines.clear();
    bench.feed(10, |_| pitched);
    assert_eq!(bench.texts(), ["QC 0.966 -0.259 0.000 0.000\n"]);
}

#[test]
fn keys_before_the_start_do_not_disturb_it() {
    let mut bench = Bench::new();
    bench.feed(500, |_| LEVEL);
    for key in *b"rb5" {
        bench.press(key);
    }
    bench.tracker.resume();
    bench.feed(500, |_| LEVEL);
    assert_eq!(bench.tagged("QC").len(), 0, "the window has a hole");
    bench.feed(500, |_| LEVEL);
    assert_eq!(bench.tagged("Measuring bias").len(), 1);
    assert_eq!(bench.lines[1].0, 1500);
}

#[test]
fn after_a_gap_the_tilt_is_right_at_once_and_yaw_is_kept() {
    let mut bench = Bench::started();
    bench.feed(1000, |_| RawSample {
        gyro: [0, 8 + 737, 0],
        ..LEVEL
    });
    let yaw = bench.tracker.orientation();
    bench.tracker.resume();
    bench.feed(1, |_| RawSample {
        accel: [0, 1774, 1024],
        ..LEVEL
    });
    let tilted = bench.tracker.orientation();
    let up = tilted * Vector3::new(0.0, 1774.0, 1024.0).normalize();
    assert!((up - Vector3::y()).norm() < 1e-5);
    assert!((tilted * yaw.inverse()).j.abs() < 1e-6);
}

#[test]
fn mode_1_is_flatland() {
    let mut bench = Bench::started();
    bench.press(b'1');
    // Roll left at 30 °/s with a force that says 45°.
    bench.feed(1000, |_| RawSample {
        gyro: [0, 8, 492],
        accel: [1448, 1448, 0],
        ..LEVEL
    });
    assert_eq!(bench.tagged("FLAT ").len(), 100);
    let last = numbers(bench.texts()[99]);
    assert!((last[0] - 30.03).abs() < 0.01, "gyro: {last:?}");
    assert_eq!(last[1], 45.0, "accelerometer: {last:?}");
    assert!(last[2] > last[0] && last[2] < 35.0, "fused: {last:?}");
}

#[test]
fn mode_2_shows_three_orientations_side_by_side() {
    let mut bench = Bench::started();
    bench.press(b'2');
    // The gyro rolls; the accelerometer does not.
    bench.feed(1000, |_| RawSample {
        gyro: [0, 8, 737],
        ..LEVEL
    });
    assert_eq!(bench.lines.len(), 300);
    let texts = bench.texts();
    for block in texts.chunks(3) {
        assert!(block[0].starts_with("QG "));
        assert_eq!(block[1], "EA 0.000 0.000 0.000\n");
        assert!(block[2].starts_with("QC "));
    }
    let (gyro, fused) = (numbers(texts[297]), numbers(texts[299]));
    assert!((gyro[3] - 22.5_f64.to_radians().sin()).abs() < 0.001);
    assert!(fused[3] < gyro[3] - 0.01, "{fused:?}");
}

#[test]
fn dead_reckoning_starts_where_the_tracker_is_when_it_is_chosen() {
    let mut bench = Bench::started();
    bench.feed(1000, |_| RawSample {
        gyro: [0, 1483, 0],
        ..LEVEL
    });
    bench.press(b'2');
    bench.lines.clear();
    bench.feed(10, |_| LEVEL);
    let texts = bench.texts();
    assert_eq!(texts[0].replace("QG", "QC"), texts[2]);
    assert!(numbers(texts[0])[2] > 0.7);
}

#[test]
fn modes_3_and_4_show_the_corrected_sensor() {
    let mut bench = Bench::started();
    bench.press(b'3');
    bench.feed(10, |_| RawSample {
        gyro: [16384, 8, -16384],
        ..LEVEL
    });
    bench.press(b'4');
    bench.feed(10, |_| RawSample {
        accel: [0, 2048, -4096],
        ..LEVEL
    });
    bench.press(b'5');
    bench.feed(10, |_| LEVEL);
    let texts = bench.texts();
    assert_eq!(texts[0], "GYR: 1000.000 0.000 -1000.000\n");
    assert_eq!(texts[1], "ACC: 0.000 9.810 -19.620\n");
    assert!(texts[2].starts_with("QC "));
}

#[test]
fn mode_0_tells_once_a_second_what_the_board_knows() {
    let mut bench = Bench::started();
    bench.press(b'0');
    bench.health = Health {
        dropped_lines: 3,
        overruns: 4,
        skipped_fields: 5,
    };
    bench.feed(2000, |i| RawSample {
        fresh: i % 100 != 0,
        ..LEVEL
    });
    assert_eq!(bench.lines[0].0, 2000);
    let second = [
        "nReads/sec: 990\n",
        "GYR_BIAS: 0.00000 0.48828 0.00000\n",
        "GYR_VAR: 0.00000 0.00000 0.00000\n",
        "ACC_BIAS: 0.00000 9.81000 0.00000\n",
        "ACC_VAR: 0.00000 0.00000 0.00000\n",
        "DROPPED: 3\n",
        "REPEATED: 10\n",
        "OVERRUNS: 4\n",
        "CLIPPED: 0\n",
        "Field: none\n",
        "FIELDS_SKIPPED: 5\n",
    ];
    assert_eq!(bench.texts()[..11], second);
    assert_eq!(bench.texts()[17], "REPEATED: 20\n");
    assert_eq!(bench.lines.len(), 22);
}

#[test]
fn without_a_still_window_there_is_no_variance_to_tell() {
    let mut bench = Bench::new();
    bench.feed(5000, handled);
    bench.press(b'0');
    bench.lines.clear();
    bench.feed(1000, handled);
    let texts = bench.texts();
    assert_eq!(texts[0], "nReads/sec: 1000\n");
    assert!(texts[1].starts_with("GYR_BIAS: "), "a guess");
    assert_eq!(texts.len(), 8);
}

#[test]
fn a_repeated_sample_is_integrated_like_any_other() {
    let turning = RawSample {
        gyro: [0, 8 + 737, 0],
        ..LEVEL
    };
    let mut fresh = Bench::started();
    fresh.feed(1000, |_| turning);
    let mut repeated = Bench::started();
    repeated.feed(1000, |i| RawSample {
        fresh: i % 2 == 0,
        ..turning
    });
    assert_eq!(fresh.tracker.orientation(), repeated.tracker.orientation());
}

#[test]
fn no_sample_puts_anything_but_numbers_on_the_wire() {
    let extremes = [i16::MIN, i16::MAX, 0, 1, -1];
    let mut bench = Bench::started();
    let mut state = 1_u32;
    for round in 0..600 {
        bench.press(b"012345rb"[round % 8]);
        if round % 7 == 0 {
            bench.tracker.resume();
        }
        let mut any = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            extremes[(state >> 16) as usize % extremes.len()]
        };
        let raw = RawSample {
            gyro: [any(), any(), any()],
            accel: [any(), any(), any()],
            temperature: any(),
            fresh: round % 3 != 0,
        };
        bench.feed(100, |_| raw);
    }
    for line in bench.texts() {
        assert!(line.ends_with('\n') && line.is_ascii());
        let lower = line.to_lowercase();
        assert!(!lower.contains("nan") && !lower.contains("inf"), "{line}");
        if line.starts_with('Q') {
            let norm = numbers(line).iter().map(|n| n * n).sum::<f64>().sqrt();
            assert!((norm - 1.0).abs() < 0.002, "{line}");
        }
    }
}

#[test]
fn the_end_of_the_range_is_told_of_when_it_begins() {
    let mut bench = Bench::started();
    let knock = |i| RawSample {
        gyro: if i % 2 == 0 {
            [i16::MAX, 0, 0]
        } else {
            [9000, 0, 0]
        },
        ..LEVEL
    };
    bench.feed(50, knock);
    bench.feed(500, |_| LEVEL);
    bench.feed(50, knock);
    assert_eq!(
        bench.tagged("warning"),
        ["warning: the sensor is at the end of its range: turned or knocked too hard\n"]
    );
    bench.feed(1000, |_| LEVEL);
    bench.feed(50, knock);
    assert_eq!(bench.tagged("warning").len(), 2);
    bench.press(b'0');
    bench.feed(1000, |_| LEVEL);
    assert_eq!(bench.tagged("CLIPPED"), ["CLIPPED: 75\n"]);
}

#[test]
fn a_sensor_with_a_slower_clock_turns_as_far() {
    for (period_ns, samples) in [(1_000_000, 1000), (1_010_000, 990), (990_000, 1010)] {
        let mut bench = Bench::started();
        bench.tracker.timed(&Timing {
            period_ns,
            ..Timing::default()
        });
        // A second at 100.1 °/s (1640 counts) about y, with the bias on top.
        bench.feed(samples, |_| RawSample {
            gyro: [0, 1648, 0],
            ..LEVEL
        });
        let q: UnitQuaternion<f32> = bench.tracker.orientation();
        let turned = f64::from(q.angle()).to_degrees();
        assert!((turned - 100.1).abs() < 0.3, "{turned} at {period_ns} ns");
    }
}
