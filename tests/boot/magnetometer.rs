//! The compass: every field once and in the body's axes, and no sample of the IMU less for it.

use vrduino_emulator::board::Setup;
use vrduino_emulator::motion::turns::Turns;
use vrduino_emulator::motion::{Instant, Motion, rotation};
use vrduino_emulator::mpu9250::part::Magnetic;
use vrduino_emulator::mpu9250::{Burst, Part};
use vrduino_emulator::time::{MICROSECOND, MILLISECOND};
use vrduino_emulator::witness::Trap;

use crate::run::Run;

/// Level and still in a field that depends on the time.
struct Field<F>(F);

impl<F: Fn(f64) -> [f64; 3] + Send + Sync> Motion for Field<F> {
    fn at(&self, t: f64) -> Instant {
        Instant {
            rate: [0.0; 3],
            force: [0.0, 9.81, 0.0],
            field: Some((self.0)(t)),
            truth: None,
        }
    }

    fn duration(&self) -> Option<f64> {
        None
    }

    fn describe(&self) -> String {
        "a field".into()
    }
}

/// The part, with a magnetometer that is like this.
fn with(part: Part, change: impl FnOnce(&mut Magnetic)) -> Part {
    let mut part = part;
    change(&mut part.magnetic);
    part
}

fn run(motion: impl Motion + 'static, part: Part) -> Run {
    let mut setup = Setup::new(Box::new(motion));
    setup.part = part;
    Run::with(setup)
}

fn still() -> Turns {
    Turns::new(1e6, 0.0)
}

/// What the last INFO block says behind this tag.
fn told(run: &Run, tag: &str) -> String {
    let line = run.text.lines().rfind(|line| line.starts_with(tag));
    let line = line.unwrap_or_else(|| panic!("no {tag} in:\n{}", run.text));
    line[tag.len()..].trim().to_owned()
}

/// Goes to the INFO block and waits for a whole one.
fn info(run: &mut Run) {
    run.board.chip().host.send(b"0");
    run.seconds(0.1);
    run.forget();
    run.wait_for("FIELDS_SKIPPED: ", 1.2);
    run.seconds(0.01);
}

fn field(line: &str) -> ([f64; 3], u32) {
    let words: Vec<&str> = line.split(' ').collect();
    let [x, y, z, "uT", rate, "Hz)"] = words[..] else {
        panic!("not a field: {line:?}");
    };
    let number = |word: &str| word.parse().expect("a number");
    let rate = rate.strip_prefix('(').expect("a bracket");
    ([x, y, z].map(number), rate.parse().expect("a rate"))
}

fn recorded(run: &mut Run) -> Vec<Burst> {
    let recording = run.board.chip().sensor.recording.take();
    recording.expect("recording is on")
}

fn complains_of_nothing(run: &mut Run) {
    assert_eq!(run.board.chip().sensor.complaints.list(), []);
    assert_eq!((run.board.stop(), run.board.resets()), (None, 0));
}

/// Every axis of the field has another size and sign, and every axis of the part another sensitivity:
/// an axis exchanged, a sign or a factor would show.
#[test]
fn the_field_is_the_emulators_in_the_bodys_axes() {
    for (axis, degrees) in [([0.36, 0.48, 0.8], 130.0), ([0.8, -0.6, 0.0], -75.0)] {
        let attitude = rotation::about(axis, f64::to_radians(degrees));
        let motion = || still().from_attitude(attitude);
        let truth = motion().at(0.0).magnetic_field();
        let part = with(Part::perfect(), |magnetic| {
            magnetic.adjustment = [178, 101, 64];
        });
        let mut run = run(motion(), part);
        run.seconds(1.5);
        info(&mut run);
        let (seen, rate) = field(&told(&run, "Field:"));
        for (seen, truth) in seen.into_iter().zip(truth) {
            // Half a count, of 1.2 times 0.15 µT at most, and print.
            assert!((seen - truth).abs() < 0.091, "{seen} for {truth}");
            assert!(truth.abs() > 3.0, "no test of this axis");
        }
        assert_eq!(rate, 100);
        assert_eq!(told(&run, "FIELDS_SKIPPED:"), "0");
        complains_of_nothing(&mut run);
    }
}

/// Ten counts from one measurement to the next, so one that is missed or comes twice is seen. In five
/// seconds a clock that is a per cent off goes through five periods: through every phase between the
/// board, the IMU and the magnetometer.
#[test]
fn no_measurement_is_lost_and_none_comes_twice_whatever_the_clocks() {
    for (imu, compass) in [(-0.01, 0.01), (0.01, -0.01)] {
        let part = with(Part::perfect().clock_error(imu), |magnetic| {
            magnetic.clock_error = compass;
        });
        let growing = Field(|t| [150.0 * t, 20.0, 30.0]);
        let mut run = run(growing, part);
        run.seconds(1.3);
        run.board.chip().sensor.recording = Some(Vec::new());
        run.seconds(5.0);
        let bursts = recorded(&mut run);
        let fields: Vec<[u8; 8]> = bursts.iter().filter_map(|burst| burst.field).collect();
        let expected = 500.0 * (1.0 + compass);
        assert!(
            (fields.len() as f64 - expected).abs() <= 1.0,
            "{} fields in five seconds, {expected} were measured",
            fields.len()
        );
        let counts = |field: &[u8; 8]| i32::from(i16::from_le_bytes([field[3], field[4]]));
        for pair in fields.windows(2) {
            assert_eq!(pair[1][0], 0x01, "DRDY and no DOR");
            assert_eq!(pair[1][7], 0x10, "ST2: 16 bits and no overflow");
            let step = (counts(&pair[1]) - counts(&pair[0])).abs();
            assert!(
                (9..=11).contains(&step),
                "{step} counts from one to the next"
            );
        }
        info(&mut run);
        let (_, rate) = field(&told(&run, "Field:"));
        // A second is a thousand samples here, by the sensor's clock.
        assert!((98..=102).contains(&rate), "{rate} a second");
        assert_eq!(told(&run, "FIELDS_SKIPPED:"), "0");
        complains_of_nothing(&mut run);
    }
}

/// When the bursts of the IMU were once it is locked on, and what the counters say.
fn timing(part: Part) -> (Vec<u64>, [String; 3]) {
    let mut run = run(still(), part);
    run.seconds(2.5);
    run.board.chip().sensor.recording = Some(Vec::new());
    run.seconds(2.0);
    let times = recorded(&mut run).iter().map(|burst| burst.at).collect();
    info(&mut run);
    let counters = ["nReads/sec:", "REPEATED:", "OVERRUNS:"].map(|tag| told(&run, tag));
    (times, counters)
}

#[test]
fn the_imu_is_sampled_as_if_there_were_no_magnetometer() {
    let error = -0.01;
    let part = Part::perfect().clock_error(error);
    let (with, counters) = timing(part);
    let (without, expected) = timing(part.without_magnetometer());
    assert_eq!(counters, expected);
    assert_eq!(expected[2], "0", "overruns");
    let period = (MILLISECOND as f64 / (1.0 + error)) as u64;
    for times in [with, without] {
        assert!((1979..=1981).contains(&times.len()), "{}", times.len());
        for pair in times.windows(2) {
            // One that was asked for too early is asked for again.
            let off = (pair[1] - pair[0]).abs_diff(period);
            assert!(off < 135 * MICROSECOND, "{off} ticks from a period");
        }
    }
}

#[test]
fn parts_without_a_magnetometer_run_on_six_axes_and_say_so_once() {
    let line = "Magnetometer: none, running on six axes";
    for part in [
        Part::perfect().without_magnetometer(),
        Part::perfect().who_am_i(0x70),
    ] {
        let mut run = run(still(), part);
        run.board.chip().sensor.recording = Some(Vec::new());
        run.seconds(3.0);
        assert_eq!(run.text.matches(line).count(), 1, "{}", run.text);
        assert!(run.orientations.len() > 150);
        info(&mut run);
        assert_eq!(told(&run, "Field:"), "none");
        assert!(recorded(&mut run).iter().all(|burst| burst.field.is_none()));
        complains_of_nothing(&mut run);
    }
}

#[test]
fn a_magnetometer_that_vanishes_or_freezes_is_reported_once_and_costs_no_sample() {
    for (absent, why) in [(true, "stopped answering"), (false, "no new measurements")] {
        let line = format!("Magnetometer: {why}, running on six axes");
        let mut run = run(still(), Part::perfect());
        run.seconds(2.0);
        assert!(!run.text.contains("Magnetometer"), "{}", run.text);
        run.board.chip().sensor.recording = Some(Vec::new());
        {
            let mut chip = run.board.chip();
            let magnetometer = chip.sensor.magnetometer().expect("there is one");
            magnetometer.faults.absent = absent;
            magnetometer.faults.frozen = !absent;
        }
        run.wait_for(&line, 1.0);
        run.seconds(2.0);
        assert_eq!(run.text.matches("Magnetometer").count(), 1, "{}", run.text);
        assert!(!run.text.contains("error"), "{}", run.text);
        let bursts = recorded(&mut run);
        let span = bursts[bursts.len() - 1].at - bursts[0].at;
        let periods = span.div_ceil(MILLISECOND);
        let apart = (bursts.len() as u64 - 1).abs_diff(periods);
        assert!(apart <= 1, "{} bursts in {periods} periods", bursts.len());
        info(&mut run);
        assert_eq!(told(&run, "Field:"), "none");
        assert_eq!(told(&run, "OVERRUNS:"), "0");
        // Who opens the port later is told too.
        run.forget();
        run.board.chip().host.set_plugged(false);
        run.seconds(0.3);
        run.board.chip().host.set_plugged(true);
        run.wait_for(&line, 1.0);
        complains_of_nothing(&mut run);
    }
}

#[test]
fn a_magnet_beside_the_board_is_warned_of_and_its_field_is_not_taken() {
    let magnet = Field(|t| {
        if (2.0..4.0).contains(&t) {
            [3000.0, -1500.0, 600.0]
        } else {
            [20.0, -40.0, 10.0]
        }
    });
    let mut run = run(magnet, Part::perfect());
    run.seconds(1.9);
    assert!(!run.text.contains("warning"), "{}", run.text);
    run.wait_for("warning: magnetic field of 4912 uT or more", 0.3);
    info(&mut run);
    assert!(told(&run, "Field:").starts_with("magnetic field of 4912"));
    run.seconds(2.0);
    info(&mut run);
    let (seen, _) = field(&told(&run, "Field:"));
    assert!((seen[1] + 40.0).abs() < 0.1, "{seen:?}");
    assert_eq!(told(&run, "OVERRUNS:"), "0");
    complains_of_nothing(&mut run);
}

#[test]
fn after_a_loss_of_supply_and_after_a_reset_of_the_processor_it_measures_again() {
    let mut setup = Setup::new(Box::new(still()));
    setup.allowed.push(Trap::WatchdogTimeout);
    let mut run = Run::with(setup);
    run.seconds(1.5);
    let now = run.board.now();
    run.board.chip().sensor.brown_out(now);
    run.wait_for("error: the IMU", 1.0);
    run.forget();
    run.wait_for("QC ", 2.5);
    assert!(!run.text.contains("Magnetometer"), "{}", run.text);
    // Sampling went on while the sensor started again, and nobody knew.
    run.board.chip().sensor.complaints.take();
    run.seconds(1.0);
    info(&mut run);
    assert_eq!(field(&told(&run, "Field:")).1, 100);
    // The magnetometer goes on measuring through a reset of the processor alone.
    let halt = run.board.image().address_of("rust_begin_unwind");
    run.board.jump(halt.expect("the panic handler is there"));
    run.wait_for("warning: reset by watchdog", 2.0);
    run.seconds(2.5);
    info(&mut run);
    assert_eq!(field(&told(&run, "Field:")).1, 100);
    assert_eq!(run.board.chip().sensor.complaints.list(), []);
}
