//! `vrduino plot`.

use std::fs;

use vrduino_host::recording::{Entry, Head};
use vrduino_host::stream::Sample;

use crate::fixture::{Scratch, row, turned, turns, write};
use crate::program::vrduino;

const YAW: &str = "#0072B2";
const GAP: &str = "#F2DAE8";
const RESTART: &str = "#CC79A7";

fn svg(recording: &str, name: &str) -> String {
    let picture = Scratch::new(&format!("{name}.svg"));
    vrduino(&["plot", recording, "-o", picture.path()]).expect(0);
    let text = fs::read_to_string(&picture.0).expect("a picture");
    assert!(
        text.starts_with("<svg width=\"1200\" height=\"800\""),
        "{name}"
    );
    assert!(text.trim_end().ends_with("</svg>"), "{name}");
    assert!(!text.contains("NaN") && !text.contains("inf"), "{name}");
    text
}

/// The corners of the lines of this colour, below the heading.
fn lines(svg: &str, colour: &str) -> Vec<Vec<(f64, f64)>> {
    let lines = svg.lines().filter(|line| line.starts_with("<polyline"));
    let lines = lines.filter(|line| line.contains(&format!("stroke=\"{colour}\"")));
    let points = lines.map(|line| {
        let points = line.split("points=\"").nth(1).expect("points");
        let points = points.split('"').next().expect("an end");
        let corner = |pair: &str| {
            let (x, y) = pair.split_once(',').expect("two");
            (x.parse().expect("x"), y.parse().expect("y"))
        };
        points.split_whitespace().map(corner).collect()
    });
    // The first is that of the legend.
    points.skip(usize::from(colour == YAW)).collect()
}

fn count(svg: &str, what: &str) -> usize {
    svg.lines().filter(|line| line.starts_with(what)).count()
}

fn gaps(svg: &str) -> usize {
    svg.lines()
        .filter(|line| line.starts_with("<rect") && line.contains(GAP))
        .count()
}

fn plain(name: &str, samples: impl IntoIterator<Item = Sample>) -> Scratch {
    let entries: Vec<Entry> = samples.into_iter().map(row).collect();
    let head = Head {
        started: "2026-11-22T16:41:52+01:00".into(),
        source: "<a & \"b\">".into(),
        ..Head::default()
    };
    write(&format!("{name}.csv"), &head, &entries)
}

#[test]
fn a_recording_of_the_board_is_drawn() {
    let text = svg(turns(), "turns");
    for words in [
        "vrduino 0.1.0 on emulated board",
        "yaw",
        "samples a second",
        "delay, ms",
        "time, s",
    ] {
        assert!(text.contains(words), "{words}");
    }
    let yaw = lines(&text, YAW);
    assert_eq!(yaw.len(), 1, "one line without a gap");
    assert_eq!(gaps(&text), 0);
    // A quarter turn is much of its height.
    let heights = || yaw[0].iter().map(|corner| corner.1);
    let span = heights().fold(0.0, f64::max) - heights().fold(f64::INFINITY, f64::min);
    assert!(span > 1000.0, "{span}");
}

/// Two and a half turns to the left in 25 s, with a pause of 5 s, and a board that starts again after 10 s.
#[test]
fn yaw_goes_on_over_half_a_turn_and_gaps_are_marked() {
    let samples = (0..2500_u16)
        .filter(|tick| !(600..900).contains(tick))
        .map(|tick| {
            let mut sample = turned(f64::from(tick) * 1e-2, tick, f64::from(tick) * 0.36);
            if tick >= 1900 {
                sample.time -= 15.0;
                sample.is_first = tick == 1900;
            }
            sample
        });
    let file = plain("gaps", samples);
    let text = svg(file.path(), "gaps");
    assert!(text.contains("2200 samples in 25.0 s, 300 missing, 1 gap, 1 new beginning"));
    let yaw = lines(&text, YAW);
    assert_eq!(
        yaw.len(),
        3,
        "a line before the gap, one behind it, one after the restart"
    );
    let corners: Vec<_> = yaw.concat();
    assert!(corners.is_sorted_by_key(|corner| corner.0));
    assert!(
        corners.is_sorted_by(|one, other| one.1 >= other.1),
        "it only rises"
    );
    // In each of three panels.
    assert_eq!(gaps(&text), 3);
    assert_eq!(lines(&text, RESTART).len(), 3);
    assert!(text.contains("&lt;a &amp;"), "names are not markup");
}

#[test]
fn odd_recordings_have_pictures_too() {
    let one = plain("one", [turned(1.0, 0, 10.0)]);
    let text = svg(one.path(), "one");
    assert_eq!(
        count(&text, "<circle"),
        4,
        "a dot for each angle and for the delay"
    );
    let still = plain(
        "still",
        (0..100).map(|tick| turned(f64::from(tick), tick, 0.0)),
    );
    assert_eq!(lines(&svg(still.path(), "still"), YAW).len(), 1);
    let at_once = plain(
        "at-once",
        (0..100).map(|tick| turned(5.0, tick, f64::from(tick))),
    );
    svg(at_once.path(), "at-once");
    let unnumbered = plain(
        "unnumbered",
        (0..1000).map(|tick| Sample {
            sequence: None,
            status: None,
            delay: None,
            ..turned(
                f64::from(tick) * if tick < 500 { 0.01 } else { 0.02 },
                tick,
                0.0,
            )
        }),
    );
    let text = svg(unnumbered.path(), "unnumbered");
    assert!(
        !text.contains("delay, ms"),
        "what is not known is not drawn"
    );
    assert_eq!(gaps(&text), 2, "the step from 5 to 10 s, in two panels");
    let far = plain("far", [turned(-9e8, 0, 1.0), turned(9e8, 1, 2.0)]);
    assert!(svg(far.path(), "far").contains("time, hours"));
    let none = plain("none", []);
    vrduino(&["plot", none.path()])
        .expect(5)
        .said("holds no sample");
    let dense = plain(
        "dense",
        (0..60_000_u32).map(|tick| {
            let mut sample = turned(f64::from(tick) * 0.06, tick as u16, f64::from(tick % 7));
            sample.is_first = tick == 0;
            sample
        }),
    );
    let text = svg(dense.path(), "dense");
    assert!(text.contains("time, minutes"));
    assert!(text.len() < 2_000_000, "{}", text.len());
}

#[test]
fn pixels_show_the_same() {
    let whole = plain(
        "pixels",
        (0..200).map(|tick| turned(f64::from(tick) * 0.01, tick, 30.0)),
    );
    let gap = plain(
        "pixels-gap",
        (0..200)
            .filter(|tick| !(50..150).contains(tick))
            .map(|tick| turned(f64::from(tick) * 0.01, tick, 30.0)),
    );
    for (file, has_gap) in [(&whole, false), (&gap, true)] {
        let picture = Scratch::new("pixels.png");
        vrduino(&["plot", file.path(), "-o", picture.path()]).expect(0);
        let input = std::io::BufReader::new(fs::File::open(&picture.0).expect("a picture"));
        let mut reader = png::Decoder::new(input).read_info().expect("PNG");
        let mut pixels = vec![0; reader.output_buffer_size().expect("its size")];
        let info = reader.next_frame(&mut pixels).expect("pixels");
        assert_eq!((info.width, info.height), (2400, 1600));
        let of = |colour: [u8; 3]| {
            pixels
                .as_chunks::<3>()
                .0
                .iter()
                .filter(|&&p| p == colour)
                .count()
        };
        assert!(of([255; 3]) > 1_500_000, "a light ground");
        assert!(of([0, 114, 178]) > 500, "the line of the yaw");
        assert_eq!(
            of([242, 218, 232]) > 100_000,
            has_gap,
            "half of the time is a gap"
        );
    }
}

#[test]
fn what_is_no_picture_is_told() {
    vrduino(&["plot", turns(), "-o", "x.jpg"])
        .expect(5)
        .said("ends in .svg or .png");
    vrduino(&["plot", turns(), "-o", "no/such/x.svg"])
        .expect(5)
        .said("cannot be written");
}
