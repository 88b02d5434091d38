//! Lines to the tracker and its answers.

#[path = "tracker/bench.rs"]
mod bench;

use bench::{Bench, LEVEL, handled};
use vrduino::command::request::Setting;

#[test]
fn every_verb_is_answered() {
    let mut bench = Bench::started();
    for (line, answer) in [
        (
            ":help",
            "OK verbs: help version estimator get set defaults compass calibration keep forget bias decimals stream every lock core\n",
        ),
        (
            ":version",
            concat!("OK vrduino ", env!("CARGO_PKG_VERSION"), "\n"),
        ),
        (":estimator", "OK estimator default\n"),
        (":estimator notes", "OK estimator notes\n"),
        (":estimator", "OK estimator notes\n"),
        (":compass", "OK compass auto: no field\n"),
        (":compass off", "OK compass off\n"),
        (":compass on", "OK compass on: no field\n"),
        (":set tilt-time 2.5", "OK tilt-time 2.5000 s\n"),
        (":get tilt-time", "OK tilt-time 2.5000 s\n"),
        (":set notes-alpha 0.9", "OK notes-alpha 0.900000\n"),
        (":get notes-time", "OK notes-time 0.0090 s\n"),
        (":defaults", "OK defaults\n"),
        (":get notes-time", "OK notes-time 7.6000 s\n"),
        (":get tilt-time", "OK tilt-time 3.0000 s\n"),
        (":estimator", "OK estimator default\n"),
        (":compass", "OK compass auto: no field\n"),
        (":decimals", "OK decimals 3\n"),
        (":decimals 6", "OK decimals 6\n"),
        (":stream", "OK stream text every 10\n"),
        (":stream timed", "OK stream timed every 10\n"),
        (":decimals", "OK decimals 6, 5 in timed lines\n"),
        (":stream binary", "OK stream binary every 1\n"),
        (":every 5", "OK stream binary every 5\n"),
        (":every", "OK stream binary every 5\n"),
        (":stream counts", "OK stream counts every 1\n"),
        (":every 0", "ERR 0: 1 to 1000 is wanted\n"),
        (":defaults", "OK defaults\n"),
        (":stream", "OK stream text every 10\n"),
        (":decimals", "OK decimals 3\n"),
        (":decimals 7", "ERR 7: 3 to 6 is wanted\n"),
        (":set lead 101", "ERR 101: lead is 0 to 100 ms\n"),
        (":get lead", "OK lead 0.0000 ms\n"),
        (":fly", "ERR fly: no such verb, :help lists them\n"),
    ] {
        assert_eq!(bench.ask(line), answer, "{line}");
    }
}

#[test]
fn every_setting_is_what_it_was_set_to() {
    let mut bench = Bench::started();
    for setting in Setting::ALL {
        let [least, greatest] = setting.range();
        for value in [least, greatest, 0.5 * (least + greatest)] {
            let answer = bench
                .ask(&format!(":set {} {value:.4}", setting.name()))
                .to_owned();
            let said: f32 = answer.split(' ').nth(2).unwrap().trim().parse().unwrap();
            assert!((said - value).abs() <= 1e-4 * value.max(1.0), "{answer}");
        }
    }
    // At the ends of every range the stream goes on.
    bench.feed(100, handled);
    assert_eq!(bench.tagged("QC").len(), 10);
}

#[test]
fn a_change_of_estimator_or_setting_does_not_turn_the_picture() {
    let mut bench = Bench::started();
    bench.feed(2000, handled);
    for line in [
        ":estimator notes",
        ":set notes-alpha 0.98",
        ":estimator default",
        ":set tilt-time 1",
        ":defaults",
    ] {
        let before = bench.tracker.orientation();
        bench.ask(line);
        assert!(
            bench.tracker.orientation().angle_to(&before) < 1e-6,
            "{line}"
        );
    }
}

#[test]
fn a_lead_goes_on_at_the_last_rate() {
    let mut bench = Bench::started();
    bench.ask(":set lead 10");
    // 983 counts are 60 °/s.
    bench.feed(100, |_| vrduino::sensor::RawSample {
        gyro: [0, 8 + 983, 0],
        ..LEVEL
    });
    let led = bench.tracker.orientation();
    bench.ask(":set lead 0");
    let turned = led.angle_to(&bench.tracker.orientation()).to_degrees();
    assert!((turned - 0.6).abs() < 0.01, "{turned}");
}

#[test]
fn the_verdict_on_the_bias_says_how_it_is_known() {
    let mut bench = Bench::started();
    bench.feed(3000, |_| LEVEL);
    assert_eq!(
        bench.ask(":bias"),
        "OK bias 0.000 0.488 0.000 deg/s, still 1 s, residual 0.0 deg/min\n"
    );
    // The verdict comes up to two blocks of eight late.
    bench.feed(2016, handled);
    let moving = bench.ask(":bias");
    assert!(
        moving.ends_with("deg/s, moving, at rest 2 s ago\n"),
        "{moving}"
    );
    bench.ask(":estimator notes");
    let notes = bench.ask(":bias");
    assert!(
        notes.ends_with("deg/s, as it was when it was chosen\n"),
        "{notes}"
    );
}

#[test]
fn a_board_that_is_never_still_says_so_every_minute_until_it_rests() {
    let mut bench = Bench::new();
    bench.feed(5000, handled);
    bench.lines.clear();
    bench.feed(120_000, handled);
    assert_eq!(bench.tagged("warning: never still").len(), 2);
    assert_eq!(bench.tagged("QC").len(), 12_000, "it streams all the same");
    assert!(
        bench
            .ask(":bias")
            .ends_with("deg/s, never still, a guess\n")
    );
    bench.lines.clear();
    bench.feed(60_000, |_| LEVEL);
    assert_eq!(bench.tagged("Bias: ").len(), 1);
    assert_eq!(bench.tagged("warning").len(), 0);
    assert!(bench.ask(":bias").contains(" 0.488 0.000 deg/s, still 5"));
}

#[test]
fn a_lead_is_not_built_up_by_choosing_again() {
    let turning = |_| vrduino::sensor::RawSample {
        gyro: [0, 8 + 983, 0],
        ..LEVEL
    };
    let mut bench = Bench::started();
    bench.feed(100, turning);
    let before = bench.tracker.orientation();
    bench.ask(":set lead 100");
    for _ in 0..10 {
        bench.ask(":estimator default");
        bench.ask(":estimator notes");
    }
    bench.ask(":estimator default");
    bench.ask(":set lead 0");
    assert!(bench.tracker.orientation().angle_to(&before) < 1e-5);
}

#[test]
fn choosing_the_notes_filter_does_not_make_a_guess_a_measurement() {
    let mut bench = Bench::new();
    bench.feed(5000, handled);
    bench.lines.clear();
    bench.ask(":estimator notes");
    bench.feed(2000, handled);
    assert_eq!(bench.tagged("Bias: ").len(), 0);
    assert!(bench.ask(":bias").ends_with("never still, a guess\n"));
}
