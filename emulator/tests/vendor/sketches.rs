//! What each sketch has to print.

use vrduino_emulator::peripherals::spi::Wire;
use vrduino_emulator::time::{self, MICROSECOND};

use crate::bench::Bench;
use crate::bring_up::bring_up;
use crate::flash::{eeprom, flash, flash_misuse};

/// A test's name, its sketch, the clock it is built for (Hz), and what has to come of it.
type Test = (&'static str, &'static str, u32, fn(&mut Bench));

const FAST: u32 = 72_000_000;

/// Every test.
pub const ALL: &[Test] = &[
    (
        "the_sheet_for_a_real_board_says_what_is_measured",
        "bring_up",
        FAST,
        bring_up,
    ),
    ("usb_serial_prints_and_echoes", "serial", FAST, usb_serial),
    (
        "usb_serial_works_at_48_mhz",
        "serial",
        48_000_000,
        usb_serial,
    ),
    (
        "usb_serial_works_at_24_mhz",
        "serial",
        24_000_000,
        usb_serial,
    ),
    ("delays_last_what_they_say", "time", FAST, delays),
    (
        "delays_last_what_they_say_at_48_mhz",
        "time",
        48_000_000,
        delays,
    ),
    (
        "delays_last_what_they_say_at_24_mhz",
        "time",
        24_000_000,
        delays,
    ),
    (
        "interval_timers_keep_their_periods",
        "interval_timer",
        FAST,
        interval_timers,
    ),
    ("eeprom_outlives_resets", "eeprom", FAST, eeprom),
    (
        "wire_finds_the_sensor_alone_at_both_speeds",
        "i2c",
        FAST,
        wire,
    ),
    ("wire_finds_the_sensor_at_48_mhz", "i2c", 48_000_000, wire),
    ("analog_reads_what_is_at_the_pins", "analog", FAST, analog),
    ("serial_ports_send_and_receive", "uart", FAST, serial_ports),
    (
        "pins_read_levels_and_interrupt_on_edges",
        "pins",
        FAST,
        pins,
    ),
    ("pulses_are_measured", "capture", FAST, capture),
    ("timers_make_pulses", "pwm", FAST, pulses),
    ("spi_transfers_over_a_loop", "spi", FAST, spi),
    ("dma_moves_memory_serial_data_and_samples", "dma", FAST, dma),
    ("flash_is_erased_and_programmed", "flash", FAST, flash),
    (
        "misuse_of_the_flash_stops_the_board_by_name",
        "flash_misuse",
        FAST,
        flash_misuse,
    ),
    ("other_modules_count_and_measure", "modules", FAST, modules),
    (
        "a_request_at_134_baud_starts_the_loader",
        "reboot",
        FAST,
        reboot,
    ),
];

fn assert_near(what: &str, value: f64, expected: f64, tolerance: f64) {
    assert!(
        (value - expected).abs() <= tolerance,
        "{what} is {value}, not {expected} ± {tolerance}"
    );
}

fn usb_serial(bench: &mut Bench) {
    bench.wait_for("end of lines", 3.0);
    for line in [
        "hello",
        "int -12345",
        "hex BEEF",
        "float 3.1416",
        "printf 42 text 00000cafe",
        "string 7",
    ] {
        let line = line.replace("00000cafe", "0000cafe");
        assert!(
            bench.text.contains(&line),
            "no {line:?} in:\n{}",
            bench.text
        );
    }
    let printed: Vec<&str> = bench
        .text
        .lines()
        .filter(|line| line.starts_with("line "))
        .collect();
    let expected: Vec<String> = (0..500).map(|n| format!("line {n}")).collect();
    assert_eq!(printed, expected);
    bench.forget();
    bench.type_in("Echo, please!\n");
    bench.wait_for("eCHO, PLEASE!", 0.5);
    let chip = bench.board.chip();
    let name = chip.host.identity().expect("it is enumerated");
    assert_eq!((name.vendor, name.product), (0x16C0, 0x0483));
    assert_eq!(name.manufacturer, "Teensyduino");
    assert_eq!(name.serial_number, "4900000");
}

fn delays(bench: &mut Bench) {
    // Printing itself costs a few microseconds.
    assert_near("delay(1)", bench.number("delay1 ", 3.0), 1000.0, 8.0);
    assert_near("delay(100)", bench.number("delay100 ", 3.0), 100_000.0, 8.0);
    // The loop of delayMicroseconds is timed for flash that keeps up with the core.
    let short = bench.number("delayMicroseconds50 ", 1.0);
    assert_near("delayMicroseconds(50)", short, 50.0, 5.0);
    let long = bench.number("delayMicroseconds1000 ", 1.0);
    assert_near("delayMicroseconds(1000)", long, 1000.0, 30.0);
    assert_eq!(bench.number("agree ", 1.0), 0.0);
    bench.wait_for("tick", 1.0);
    let from = time::seconds(bench.board.now());
    bench.wait_for("tock", 2.0);
    let took = time::seconds(bench.board.now()) - from;
    // Seen by the host, which looks every 5 ms.
    assert_near("delay(1000)", took, 1.0, 0.012);
}

fn interval_timers(bench: &mut Bench) {
    bench.wait_for("again", 3.0);
    // The counter's own reading may be some cycles off at either end of the span.
    assert_near(
        "cycles in 100 µs",
        bench.number("period ", 0.1),
        7200.0,
        1.0,
    );
    let calls: Vec<f64> = bench
        .text
        .lines()
        .filter_map(|line| line.strip_prefix("calls ")?.parse().ok())
        .collect();
    for (calls, expected) in calls.iter().zip([1000.0, 100.0, 40.0, 3007.5]) {
        assert_near("calls in 100 ms", *calls, expected, 1.0);
    }
    assert_eq!(bench.number("again ", 0.1), 1.0);
}

fn wire(bench: &mut Bench) {
    assert_eq!(bench.number("devices ", 4.0), 1.0);
    assert!(bench.text.contains("device at 0x68"), "{}", bench.text);
    bench.wait_for("nobody ", 2.0);
    let reads: Vec<(String, f64)> = bench
        .text
        .lines()
        .filter_map(|line| line.strip_prefix("who ")?.split_once(" us "))
        .map(|(who, took)| (who.to_owned(), took.parse().expect("a number")))
        .collect();
    assert_eq!((reads[0].0.as_str(), reads[1].0.as_str()), ("71", "71"));
    // Four bytes of nine bits, with start, repeated start and stop.
    assert!(
        (320.0..500.0).contains(&reads[0].1),
        "{} µs at 100 kHz",
        reads[0].1
    );
    assert!(
        (90.0..180.0).contains(&reads[1].1),
        "{} µs at 400 kHz",
        reads[1].1
    );
    assert_eq!(bench.number("burst ", 0.1), 14.0);
    let accel = bench.numbers("accel ", 0.1);
    let g = accel.iter().map(|axis| axis * axis).sum::<f64>().sqrt();
    assert_near("gravity in counts at ±2 g", g, 16_384.0, 20.0);
    assert_eq!(bench.number("nobody ", 0.1), 2.0);
}

fn analog(bench: &mut Bench) {
    for (n, volts) in bench.board.chip().analog.inputs.iter_mut().enumerate() {
        *volts = 0.15 * n as f64;
    }
    bench.board.chip().analog.temperature = 35.0;
    let code = |n: f64, bits: i32| 0.15 * n / 3.3 * f64::from(1 << bits);
    let front = bench.numbers("ten bits ", 3.0);
    assert_eq!(front.len(), 14);
    for (n, value) in (0..).zip(front) {
        assert_near(&format!("A{n}"), value, code(f64::from(n), 10), 0.51);
    }
    for (n, value) in (15..).zip(bench.numbers("back ", 1.0)) {
        assert_near(&format!("A{n}"), value, code(f64::from(n), 10), 0.51);
    }
    let time = |bench: &mut Bench, bits| bench.numbers(&format!("bits {bits} 0 us "), 1.0)[0];
    let (eight, sixteen) = (time(bench, 8), time(bench, 16));
    assert!(
        eight < sixteen && sixteen < 80.0,
        "{eight} µs at 8 bits, {sixteen} µs at 16"
    );
    let sensor = (0.719 - 0.001_715 * 10.0) / 3.3 * 4096.0;
    assert_near(
        "temperature",
        bench.number("temperature ", 1.0),
        sensor,
        0.51,
    );
    assert_near(
        "reference",
        bench.number("reference ", 1.0),
        1.195 / 3.3 * 4096.0,
        3.0,
    );
    assert_near("DAC", bench.number("dac ", 1.0), 2048.0, 1.0);
    let internal = bench.number("internal ", 1.0);
    assert_near("A1 against 1.2 V", internal, 0.15 / 1.195 * 4096.0, 3.0);
}

fn serial_ports(bench: &mut Bench) {
    let took = bench.number("hundred us ", 3.0);
    assert_near("100 characters at 115200 baud", took, 8681.0, 20.0);
    bench.seconds(0.05);
    let expected = [
        format!("one\r\n{}", "x".repeat(100)),
        "two\r\n".into(),
        "three\r\n".into(),
    ];
    for (n, expected) in expected.into_iter().enumerate() {
        let sent = std::mem::take(&mut bench.board.chip().communication.uarts[n].sent);
        assert_eq!(String::from_utf8_lossy(&sent), expected);
        bench.forget();
        let text = format!("to port {} and back, through the fifo\n", n + 1);
        assert!(bench.board.chip().send_serial(n, text.as_bytes()));
        bench.wait_for(text.trim_end(), 1.0);
        bench.seconds(0.1);
        let sent = std::mem::take(&mut bench.board.chip().communication.uarts[n].sent);
        assert_eq!(String::from_utf8_lossy(&sent), text.to_uppercase());
    }
}

fn pins(bench: &mut Bench) {
    assert_eq!(bench.wait_for("idle ", 3.0), "0 1 0");
    assert_eq!(bench.wait_for("output ", 1.0), "1");
    bench.seconds(0.005);
    assert!(bench.board.chip().level(2), "digitalWriteFast(2, HIGH)");
    for _ in 0..3 {
        for level in [true, false] {
            for pin in [3, 6, 7, 33] {
                bench.board.chip().drive(pin, Some(level));
            }
            bench.seconds(0.002);
        }
    }
    bench.board.chip().drive(3, Some(true));
    bench.type_in("?");
    assert_eq!(bench.wait_for("edges ", 1.0), "3 3 6 levels 1 0 0");
    let mut levels = Vec::new();
    for _ in 0..40 {
        bench.seconds(0.001);
        levels.push(bench.board.chip().level(13));
    }
    let toggles = levels.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert!((3..=5).contains(&toggles), "{toggles} toggles in 40 ms");
}

fn pulses(bench: &mut Bench) {
    bench.wait_for("share ", 3.0);
    assert_near("share of time high", bench.number("share ", 0.1), 50.0, 2.0);
    // 440 Hz for 100 ms: 44 periods of two edges.
    assert_near("edges", bench.number("tone ", 1.0), 88.0, 2.0);
    {
        let chip = bench.board.chip();
        let pulses = |timer: usize, channel| {
            let pulses = chip.timers.flex[timer]
                .pulses(channel)
                .expect("it makes pulses");
            (
                time::seconds(pulses.period),
                pulses.high as f64 / pulses.period as f64,
            )
        };
        for ((timer, channel), hz, duty) in [
            ((0, 0), 488.28, 0.25),
            ((1, 0), 1000.0, 0.5),
            ((2, 0), 10.0, 0.25),
        ] {
            let (period, high) = pulses(timer, channel);
            assert_near("frequency", 1.0 / period, hz, hz * 0.002);
            assert_near("duty cycle", high, duty, 0.001);
        }
    }
}

fn capture(bench: &mut Bench) {
    let pulse = |bench: &mut Bench, pin, microseconds| {
        bench.board.chip().drive(pin, Some(true));
        bench.board.run(microseconds * MICROSECOND);
        bench.board.chip().drive(pin, Some(false));
        bench.seconds(0.002);
    };
    bench.wait_for("waiting", 3.0);
    bench.seconds(0.005);
    pulse(bench, 4, 1500);
    assert_near("pulseIn", bench.number("pulse ", 1.0), 1500.0, 2.0);
    for microseconds in [700, 2500] {
        pulse(bench, 3, microseconds);
    }
    let widths = bench.numbers("widths ", 1.0);
    // Counts of half the bus clock.
    assert_near("700 µs", widths[0], 12_600.0, 5.0);
    assert_near("2500 µs", widths[1], 45_000.0, 5.0);
}

fn spi(bench: &mut Bench) {
    bench.board.chip().communication.spi.wire = Wire::Loopback;
    bench.wait_for("spi ", 3.0);
    bench.seconds(0.01);
    let lines: Vec<&str> = bench
        .text
        .lines()
        .filter(|line| line.starts_with("spi "))
        .collect();
    assert_eq!(lines.len(), 2, "{}", bench.text);
    let times: Vec<f64> = lines
        .iter()
        .map(|line| {
            let rest = line.strip_prefix("spi a5 1234 [a longer transfer through the FIFO] us ");
            rest.unwrap_or_else(|| panic!("{line}"))
                .parse()
                .expect("a number")
        })
        .collect();
    // 8 + 16 + 34 × 8 bits.
    assert_near("µs at 1 MHz", times[0], 296.0, 60.0);
    assert!(times[1] < times[0] / 3.0, "{times:?}");
}

fn dma(bench: &mut Bench) {
    bench.board.chip().analog.inputs[0] = 1.65;
    assert_eq!(bench.wait_for("copy ", 3.0), "1 0");
    assert_eq!(bench.wait_for("serial ", 1.0), "1");
    assert_eq!(bench.wait_for("sampler ", 1.0), "1 512 512");
    let sent = &bench.board.chip().communication.uarts[0].sent.clone();
    assert_eq!(String::from_utf8_lossy(sent), "sent by dma\n");
}

fn modules(bench: &mut Bench) {
    bench.board.chip().timers.rtc.crystal_fitted = true;
    assert_eq!(bench.wait_for("crc ", 3.0), "cbf43926");
    let open = bench.number("touch ", 1.0);
    assert!((100.0..5000.0).contains(&open), "an open pin counts {open}");
    assert_near("seconds", bench.number("rtc ", 4.0), 2.0, 1.0);
    assert_near(
        "25 ms of the LPO",
        bench.number("lptmr us ", 1.0),
        25_000.0,
        1000.0,
    );
    assert_near(
        "36000 counts of the bus clock",
        bench.number("pdb us ", 1.0),
        1000.0,
        3.0,
    );
}

fn reboot(bench: &mut Bench) {
    bench.wait_for("ready", 3.0);
    bench.seconds(0.1);
    assert!(bench.board.in_loader().is_none());
    bench.board.chip().host.set_baud(134);
    for _ in 0..50 {
        bench.board.run(time::MILLISECOND);
    }
    let entered = bench.board.in_loader().expect("the board is in its loader");
    assert!(time::seconds(entered) > 0.0);
    assert_eq!(bench.board.resets(), 0);
    let events = bench.board.take_events();
    assert!(
        events.iter().any(|event| event.what.contains("loader")),
        "{events:?}"
    );
    // Nothing runs any more.
    let instructions = bench.board.instructions();
    bench.board.run(time::SECOND);
    assert_eq!(bench.board.instructions(), instructions);
}
