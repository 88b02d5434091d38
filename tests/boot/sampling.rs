//! Every sample of the sensor is read once, soon, and with the time at which it was ready.

use vrduino_emulator::board::Setup;
use vrduino_emulator::cpu::Pace;
use vrduino_emulator::motion::turns::Turns;
use vrduino_emulator::mpu9250::{Burst, Part};
use vrduino_emulator::time::{self, MICROSECOND, MILLISECOND, SECOND};

use crate::run::Run;

/// Seconds from power-on until the loop is locked: half a second for the start, two for the loop.
const LOCKED: f64 = 2.5;

fn with(part: Part, pace: Pace) -> Run {
    let mut setup = Setup::new(Box::new(Turns::new(1e6, 0.0)));
    (setup.part, setup.pace) = (part, pace);
    Run::with(setup)
}

fn off(error: f64) -> Part {
    Part::perfect().clock_error(error)
}

/// What is read in so many seconds.
fn bursts(run: &mut Run, seconds: f64) -> Vec<Burst> {
    run.board.chip().sensor.recording = Some(Vec::new());
    run.seconds(seconds);
    let recording = run.board.chip().sensor.recording.take();
    recording.expect("it records")
}

#[test]
fn once_locked_each_sample_is_read_once_whatever_the_sensors_clock() {
    for error in [-0.01, 0.01] {
        let mut run = with(off(error), Pace::Greatest);
        run.seconds(LOCKED);
        let bursts = bursts(&mut run, 4.0);
        let period = SECOND as f64 / 1000.0 / (1.0 + error);
        for pair in bursts.windows(2) {
            assert_eq!(pair[1].bytes[0] & 1, 1, "a sample came twice");
            let apart = (pair[1].ready - pair[0].ready) as f64;
            assert!((apart - period).abs() < 2.0, "a sample was lost");
        }
        let expected = 4000.0 * (1.0 + error);
        assert!((bursts.len() as f64 - expected).abs() <= 1.5);
    }
}

#[test]
fn the_time_stamps_are_those_of_data_ready() {
    for (error, pace) in [(-0.009, Pace::Least), (0.004, Pace::Greatest)] {
        let mut run = with(off(error), pace);
        run.seconds(LOCKED);
        run.board.chip().sensor.recording = Some(Vec::new());
        let (mut offsets, mut last) = (Vec::new(), 0);
        let until = run.board.now() + 3 * SECOND;
        while run.board.now() < until {
            run.board.run(100 * MICROSECOND);
            let stamp = run.variable("vrduino_data_ready_us");
            let mut chip = run.board.chip_quietly();
            let bursts = chip.sensor.recording.as_mut().expect("it records");
            // A burst is on record once its STOP is, which is just before or behind its delivery.
            if let Some(burst) = bursts.last()
                && stamp != std::mem::replace(&mut last, stamp)
            {
                let micros = burst.ready as f64 / MICROSECOND as f64;
                // The stamp is of this burst or of one near it.
                let period = 1000.0 / (1.0 + error);
                let off = f64::from(stamp) - micros;
                offsets.push(off - (off / period).round() * period);
            }
        }
        assert!(offsets.len() > 2900, "{} stamps", offsets.len());
        // What is subtracted is the time from power-on to the start of the board's clock.
        let (least, most) = offsets
            .iter()
            .fold((f64::MAX, f64::MIN), |(a, b), &x| (a.min(x), b.max(x)));
        assert!(most - least < 2.0, "{least} to {most} µs");
    }
}

#[test]
fn a_sample_is_on_its_way_within_half_a_millisecond() {
    // What the filter takes is not counted here: it has its own budget.
    let mut run = with(off(0.006), Pace::Greatest);
    run.seconds(LOCKED);
    let bursts = bursts(&mut run, 3.0);
    let mut delays: Vec<u64> = bursts.iter().map(|burst| burst.at - burst.ready).collect();
    delays.sort_unstable();
    let (median, worst) = (delays[delays.len() / 2], delays[delays.len() - 1]);
    assert!(median < 6 * MICROSECOND, "{} s", time::seconds(median));
    assert!(worst < 140 * MICROSECOND, "{} s", time::seconds(worst));
}

#[test]
fn the_core_is_busy_for_a_twentieth_of_the_time_and_with_a_frame_a_sample_for_a_tenth() {
    for (typed, most) in [(":stream text\n", 0.05), (":stream binary\n", 0.1)] {
        let mut run = with(off(0.003), Pace::Greatest);
        run.seconds(1.5);
        run.board.chip().host.send(typed.as_bytes());
        // Binary frames are no text, so from here on the host's end is not looked at.
        run.board.run(SECOND);
        run.board.begin_figures();
        run.board.run(2 * SECOND);
        let figures = run.board.figures();
        assert!(figures.load.1 < most, "{typed:?}: {figures:?}");
        assert!(figures.bus < 0.5, "{figures:?}");
        assert!(figures.ram < Some(12 * 1024), "{figures:?}");
        let [median, _, worst] = figures.latency.expect("there were packets");
        assert!(median < 0.5e-3 && worst < 0.65e-3, "{typed:?}: {figures:?}");
        assert_eq!((run.board.stop(), run.board.resets()), (None, 0));
    }
}

#[test]
fn locked_on_the_hosts_frames_a_sample_comes_in_each_and_the_odd_ones_are_counted() {
    let mut run = with(off(0.006), Pace::Least);
    run.seconds(1.5);
    run.board.chip().host.send(b":lock usb\n0");
    run.wait_for("OK lock usb", 0.1);
    run.seconds(0.5);
    let bursts = bursts(&mut run, 2.0);
    assert!(bursts.len().abs_diff(2000) <= 1, "{}", bursts.len());
    for pair in bursts.windows(2) {
        let off = (pair[1].at - pair[0].at).abs_diff(MILLISECOND);
        assert!(off < 10 * MICROSECOND, "{off} ticks from a frame");
    }
    let skipped = bursts
        .windows(2)
        .filter(|pair| pair[1].ready - pair[0].ready > 3 * MILLISECOND / 2)
        .count();
    assert!((11..=13).contains(&skipped), "{skipped} left out");
    let overruns = |run: &mut Run| -> u32 {
        run.forget();
        run.wait_for("OVERRUNS: ", 1.1);
        run.seconds(0.01);
        let line = run
            .text
            .lines()
            .find_map(|line| line.strip_prefix("OVERRUNS: "));
        line.expect("a counter").parse().expect("a number")
    };
    let before = overruns(&mut run);
    run.seconds(0.5);
    let told = overruns(&mut run) - before;
    assert!((5..=13).contains(&told), "{told} told in a second or two");
    // And back: nothing is lost from then on.
    run.board.chip().host.send(b":lock sensor\n");
    run.seconds(2.0);
    let before = overruns(&mut run);
    assert_eq!(overruns(&mut run), before);
}

#[test]
fn at_half_the_clock_the_load_doubles_and_the_latency_holds() {
    let mut run = with(off(0.003), Pace::Greatest);
    run.seconds(2.5);
    let loads = [36, 72].map(|mhz| {
        run.board
            .chip()
            .host
            .send(format!(":core {mhz}\n").as_bytes());
        run.wait_for(&format!("OK core {mhz} MHz"), 0.5);
        run.seconds(0.5);
        run.board.begin_figures();
        run.seconds(1.5);
        let figures = run.board.figures();
        let [_, _, worst] = figures.latency.expect("there were packets");
        assert!(worst < 0.65e-3, "{mhz} MHz: {figures:?}");
        figures.load.1
    });
    assert!(loads[0] < 0.1, "{loads:?}");
    assert!((1.7..2.1).contains(&(loads[0] / loads[1])), "{loads:?}");
    assert_eq!((run.board.stop(), run.board.resets()), (None, 0));
}
