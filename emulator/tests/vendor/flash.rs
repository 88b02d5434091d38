//! Sketches that use the flash module, well and badly.

use vrduino_emulator::witness::Trap;

use crate::bench::Bench;

pub fn eeprom(bench: &mut Bench) {
    assert_eq!(bench.number("found ", 3.0), 255.0);
    let took = bench.number("write us ", 1.0);
    assert!(
        (100.0..2000.0).contains(&took),
        "a byte was written in {took} µs"
    );
    for life in [1.0, 2.0] {
        bench.forget();
        assert_eq!(bench.number("found ", 4.0), life);
        assert_eq!(bench.wait_for("dword ", 1.0), "12345678");
        assert_eq!(bench.wait_for("word ", 1.0), "12345678");
        bench.wait_for("block", 1.0);
        assert!(bench.text.contains("word ABCD"), "{}", bench.text);
        assert_eq!(bench.number("untouched ", 1.0), 255.0);
    }
    bench.wait_for("three lives", 1.0);
    assert_eq!(bench.board.resets(), 2);
}

pub fn flash(bench: &mut Bench) {
    bench.wait_for("blank ", 3.0);
    bench.seconds(0.1);
    let printed: Vec<&str> = bench.text.lines().collect();
    let expected = [
        "erase 00",
        "blank ffffffff",
        "program 00",
        "read deadbeef ffffffff",
        "erase 00",
        "blank ffffffff",
    ];
    assert_eq!(printed, expected);
}

/// One rule broken on each fresh board.
pub fn flash_misuse(bench: &mut Bench) {
    let broken = [
        ('c', Trap::FlashCommand),
        ('a', Trap::FlashCommand),
        ('o', Trap::FlashCommand),
        ('p', Trap::FlashProtected),
        ('b', Trap::FlashBusy),
        ('n', Trap::FlashNotErased),
        ('w', Trap::FlashReadWhileWrite),
        ('s', Trap::FlashSecured),
        ('r', Trap::EepromNotReady),
        ('f', Trap::FlashCommand),
        ('t', Trap::FlashStore),
    ];
    for (key, trap) in broken {
        let stop = bench.again(&[]).stop_after(key);
        assert_eq!(stop.trap, trap, "after {key}: {stop}");
        assert!(stop.place.contains('+'), "no symbol in {}", stop.place);
    }
    let stop = bench.again(&[Trap::FlashCommand]).stop_after('e');
    assert_eq!(stop.trap, Trap::FlashErrorFlags, "{stop}");
}
