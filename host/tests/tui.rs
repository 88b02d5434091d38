//! The view in the terminal, drawn into cells and fed by the emulated board through the hub.

#![cfg(feature = "tui")]

mod cells;

use std::time::{Duration, Instant};

use cells::{drawn, found, text, typed, within};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use vrduino_host::hub::{Hold, Hub, State, Subscription, Update};
use vrduino_host::source::{Choice, Emulation, Truth};
use vrduino_host::tui::draw::Areas;
use vrduino_host::tui::keys::Wish;
use vrduino_host::tui::model::Model;
use vrduino_host::tui::scene::board;
use vrduino_host::tui::strips;

/// Nothing here takes longer, the image to be built included.
const PATIENCE: Duration = Duration::from_secs(300);

/// The emulated board, and the model of what came from it.
struct Running {
    hub: Hub,
    updates: Subscription,
    model: Model,
    truth: Option<Truth>,
}

impl Running {
    fn start() -> Self {
        let hub = Hub::start(Choice::Emulated(Emulation::default()), Some("binary"));
        let updates = hub.subscribe(Hold::All);
        Self {
            hub,
            updates,
            model: Model::new(),
            truth: None,
        }
    }

    /// Goes on until it is so.
    fn until(&mut self, what: &str, is_so: impl Fn(&Self) -> bool) {
        let began = Instant::now();
        while !is_so(self) {
            assert!(began.elapsed() < PATIENCE, "still not: {what}");
            if let Some(update) = self.updates.next(Duration::from_millis(100)) {
                self.model.take(&update);
                self.truth = match update {
                    Update::Truth(truth) => Some(truth),
                    // Of that very moment, or none.
                    _ => None,
                };
            }
        }
    }

    /// What has come while something else was done.
    fn catch_up(&mut self) {
        while let Some(update) = self.updates.next(Duration::ZERO) {
            self.model.take(&update);
        }
    }

    /// Presses a key as the program does.
    fn press(&mut self, letter: char) {
        match typed(&mut self.model, letter).expect("it asks for something") {
            Wish::Press(key) => self.hub.press(&[key]),
            Wish::Say(line) => self.hub.say(&line),
            Wish::Order(order) => self.hub.order(order),
            other => panic!("{other:?}"),
        }
    }

    fn is_connected(&self) -> bool {
        self.model.status.state == State::Connected
    }

    fn yaw(&self) -> f64 {
        let angles = self.model.sample.as_ref().map(strips::angles);
        angles.map_or(0.0, |[yaw, ..]| yaw)
    }
}

/// Where the end of an axis is to be seen, column and row of the area: by plain geometry, with nothing of
/// the library.
fn place(truth: [f64; 4], end: [f64; 3], area: Rect) -> [f64; 2] {
    type Vector = [f64; 3];
    let dot = |a: Vector, b: Vector| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross = |a: Vector, b: Vector| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    let scaled = |a: Vector, by: f64| a.map(|component| component * by);
    let plus = |a: Vector, b: Vector| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    let unit = |a: Vector| scaled(a, 1.0 / dot(a, a).sqrt());
    // v + 2w (u × v) + 2 u × (u × v)
    let [w, x, y, z] = truth;
    let u = [x, y, z];
    let once = cross(u, end);
    let turned = plus(
        end,
        plus(scaled(once, 2.0 * w), scaled(cross(u, once), 2.0)),
    );
    let ahead = unit(scaled(board::EYE, -1.0));
    let right = unit(cross(ahead, [0.0, 1.0, 0.0]));
    let up = cross(right, ahead);
    let seen = plus(turned, scaled(board::EYE, -1.0));
    let aspect = f64::from(area.width) / (2.0 * f64::from(area.height));
    let [across, above] = board::WITHIN;
    let slope = above.max(across / aspect) / dot(board::EYE, board::EYE).sqrt();
    let depth = dot(seen, ahead);
    let picture = [
        dot(seen, right) / depth / slope / aspect,
        dot(seen, up) / depth / slope,
    ];
    [
        (picture[0] + 1.0) / 2.0 * f64::from(area.width - 1),
        (1.0 - picture[1]) / 2.0 * f64::from(area.height - 1),
    ]
}

#[test]
fn the_emulated_board_is_seen_to_turn_and_does_what_is_typed() {
    let mut running = Running::start();
    let size = [120, 40];
    let areas = Areas::of(Rect::new(0, 0, size[0], size[1]), false).expect("room");

    running.until("the board is there", Running::is_connected);
    let waiting = drawn(&running.model, size);
    assert!(text(&waiting, areas.view).contains("It measures"));

    // The head moves after three seconds.
    running.until("it is turned", |running| {
        running.truth.is_some() && running.yaw().abs() > 25.0
    });
    let turned = drawn(&running.model, size);
    let truth = running.truth.expect("it was asked for").orientation;
    let view = within(areas.view);
    for (ink, end, letter) in board::AXES {
        let seen = found(&turned, view, ink, letter);
        let wanted = place(truth, end, view);
        let off = (seen[0] - wanted[0]).hypot(seen[1] - wanted[1]);
        assert!(off < 2.0, "{letter} at {seen:?}, the truth at {wanted:?}");
    }
    assert!(running.model.off.expect("compared") < 0.05);
    let numbers = text(&turned, areas.numbers.expect("room"));
    for words in [
        "a second",
        "p50",
        "nothing",
        "bias measured",
        "default",
        "tilt-time 3 s",
        "binary every 1",
    ] {
        assert!(numbers.contains(words), "no {words} in\n{numbers}");
    }
    let lines = text(&turned, areas.lines);
    assert!(lines.contains("Bias:") && !lines.contains("OK "), "{lines}");

    // The strips go on, and stand while it is paused.
    let strip = |buffer: &Buffer| text(buffer, areas.strips[0]);
    let arrival = running.model.sample.expect("some").arrival;
    running.until("half a second later", |running| {
        running
            .model
            .sample
            .is_some_and(|sample| sample.arrival > arrival + 0.5)
    });
    let later = drawn(&running.model, size);
    assert_ne!(strip(&turned), strip(&later));
    assert_eq!(typed(&mut running.model, 'p'), None);
    let status = running.model.status.report.samples;
    running.until("a second of pause", |running| {
        running.model.status.report.samples > status + 1000
    });
    let paused = drawn(&running.model, size);
    assert_eq!(strip(&later), strip(&paused));
    assert!(text(&paused, areas.title).contains("paused"));
    assert_eq!(typed(&mut running.model, 'p'), None);

    // Straight ahead is elsewhere now, and the truth does not know.
    // The key comes when it comes: on a busy machine the head may have turned back by then.
    let is_ahead = |running: &mut Running| {
        running.catch_up();
        running.until("it is turned again", |running| running.yaw().abs() > 25.0);
        running.press('r');
        let samples = running.model.status.report.samples;
        running.until("a second later", |running| {
            running.model.status.report.samples > samples + 1000
        });
        running.model.off.is_some_and(|off| off > 0.2)
    };
    assert!((0..10).any(|_| is_ahead(&mut running)));

    // The other estimator, and its weight.
    running.press('e');
    running.until("the notes' estimator", |running| {
        running.model.status.estimator.as_deref() == Some("notes")
    });
    running.press('+');
    running.until("its time is a quarter longer", |running| {
        running.model.status.settings.get("notes-time") == Some(&9.5)
    });
    let notes = drawn(&running.model, size);
    assert!(text(&notes, areas.numbers.expect("room")).contains("α 0.999895, τ 9.5 s"));
    assert!(text(&notes, areas.lines).contains("> :set notes-time 9.50"));

    // The plug.
    running.press('u');
    running.until("it is gone", |running| {
        running.model.status.state == State::Lost
    });
    let gone = drawn(&running.model, size);
    assert!(text(&gone, areas.title).contains("× gone"));
    assert!(text(&gone, areas.view).contains("u puts the plug back"));
    let samples = running.model.status.report.samples;
    running.press('u');
    running.until("it is there again", |running| {
        running.is_connected() && running.model.status.report.samples > samples
    });
    let again = drawn(&running.model, size);
    assert!(text(&again, areas.title).contains("● connected"));
    assert!(!text(&again, areas.view).contains("plug"));

    // Another motion.
    running.press('n');
    running.until("quarter turns", |running| {
        running.model.status.motion.as_deref() == Some("turns")
    });
}
