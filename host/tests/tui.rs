//! The view in the terminal, drawn into cells: fed by the emulated board through the hub, and with
//! whatever else may come.

#![cfg(feature = "tui")]

use std::sync::Arc;
use std::time::{Duration, Instant};

use nalgebra::UnitQuaternion;
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::Buffer;
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::layout::Rect;
use vrduino_host::failure::{Failure, Kind};
use vrduino_host::hub::{Hold, Hub, State, Status, Subscription, Update};
use vrduino_host::source::{self, Choice, Emulation, Order, Truth};
use vrduino_host::stream::{Item, Sample};
use vrduino_host::tui::draw::{self, Areas, LEAST};
use vrduino_host::tui::keys::{Wish, press};
use vrduino_host::tui::model::Model;
use vrduino_host::tui::scene::board;

/// Nothing here takes longer, the image to be built included.
const PATIENCE: Duration = Duration::from_secs(300);

fn drawn(model: &Model, [width, height]: [u16; 2]) -> Buffer {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).expect("cells");
    terminal
        .draw(|frame| draw::draw(frame, model))
        .expect("drawn");
    terminal.backend().buffer().clone()
}

/// The words in a part of it, row after row.
fn text(buffer: &Buffer, area: Rect) -> String {
    let row = |y| (area.left()..area.right()).map(move |x| buffer[(x, y)].symbol());
    let rows = (area.top()..area.bottom()).map(|y| row(y).collect::<String>());
    rows.collect::<Vec<_>>().join("\n")
}

fn key(code: KeyCode) -> KeyEvent {
    KeyEvent::new(code, KeyModifiers::NONE)
}

fn typed(model: &mut Model, letter: char) -> Option<Wish> {
    press(model, key(KeyCode::Char(letter)))
}

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
        let angles = self
            .model
            .sample
            .as_ref()
            .map(vrduino_host::tui::strips::angles);
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

/// Where a letter of that colour stands in the area.
fn found(
    buffer: &Buffer,
    area: Rect,
    ink: vrduino_host::tui::scene::Ink,
    letter: &str,
) -> [f64; 2] {
    for y in area.top()..area.bottom() {
        for x in area.left()..area.right() {
            let cell = &buffer[(x, y)];
            if cell.symbol() == letter && cell.fg == draw::colour(ink) {
                return [f64::from(x - area.left()), f64::from(y - area.top())];
            }
        }
    }
    panic!("no {letter} in\n{}", text(buffer, area));
}

/// Without its frame.
fn within(area: Rect) -> Rect {
    Rect::new(area.x + 1, area.y + 1, area.width - 2, area.height - 2)
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
    running.until("it is turned again", |running| running.yaw().abs() > 25.0);
    running.press('r');
    running.until("it faces ahead", |running| {
        running.model.off.is_some_and(|off| off > 0.2)
    });

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
    running.press('m');
    running.until("quarter turns", |running| {
        running.model.status.motion.as_deref() == Some("turns")
    });
}

fn status(change: impl FnOnce(&mut Status)) -> Update {
    let mut status = Status::default();
    change(&mut status);
    Update::Status(Arc::new(status))
}

fn connected() -> Update {
    status(|status| {
        status.state = State::Connected;
        status.kind = Some(source::Kind::Port);
        status.source = "/dev/ttyACM0".into();
        status.estimator = Some("default".into());
        status.settings.insert("tilt-time", 3.0);
        status.settings.insert("notes-time", 7.6);
    })
}

#[test]
fn keys_ask_for_what_they_are_for() {
    let mut model = Model::new();
    model.take(&connected());
    let say = |line: &str| Some(Wish::Say(line.into()));
    assert_eq!(typed(&mut model, 'r'), Some(Wish::Press(b'r')));
    assert_eq!(typed(&mut model, 'b'), Some(Wish::Press(b'b')));
    assert_eq!(typed(&mut model, 'e'), say(":estimator notes"));
    assert_eq!(typed(&mut model, '+'), say(":set tilt-time 3.75"));
    assert_eq!(typed(&mut model, '-'), say(":set tilt-time 2.40"));
    assert_eq!(typed(&mut model, 'q'), Some(Wish::Quit));
    assert_eq!(press(&mut model, key(KeyCode::Esc)), Some(Wish::Quit));
    let interrupt = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
    assert_eq!(press(&mut model, interrupt), Some(Wish::Quit));

    // What is for the emulated board says so, and does nothing.
    for letter in ['m', 'u'] {
        assert_eq!(typed(&mut model, letter), None);
        let notice = model.notice.clone().expect("a reason");
        assert!(notice.contains("emulated"), "{notice}");
    }
    assert_eq!(press(&mut model, key(KeyCode::Enter)), None);

    model.take(&status(|status| {
        status.state = State::Connected;
        status.kind = Some(source::Kind::Emulated);
        status.motions = &["head", "hand"];
        status.motion = Some("head".into());
        status.estimator = Some("notes".into());
        status.settings.insert("notes-time", 1000.0);
    }));
    assert_eq!(typed(&mut model, 'e'), say(":estimator default"));
    assert_eq!(typed(&mut model, '+'), say(":set notes-time 1000.00"));
    assert_eq!(
        typed(&mut model, 'u'),
        Some(Wish::Order(Order::Plug(false)))
    );
    assert_eq!(
        typed(&mut model, 'm'),
        Some(Wish::Order(Order::Motion("hand".into())))
    );
    assert_eq!(press(&mut model, key(KeyCode::Left)), None);
    model.take(&status(|status| {
        status.state = State::Lost;
        status.kind = Some(source::Kind::Emulated);
    }));
    assert_eq!(typed(&mut model, 'u'), Some(Wish::Order(Order::Plug(true))));
    assert_eq!(typed(&mut model, 'r'), None);

    // By hand, an arrow a step of ten degrees.
    model.take(&status(|status| {
        status.state = State::Connected;
        status.kind = Some(source::Kind::Emulated);
        status.motion = Some("hand".into());
    }));
    let half = 5.0_f64.to_radians();
    match press(&mut model, key(KeyCode::Left)) {
        Some(Wish::Order(Order::Turn([w, x, y, z]))) => {
            assert!((w - half.cos()).abs() < 1e-12 && (y - half.sin()).abs() < 1e-12);
            assert_eq!((x, z), (0.0, 0.0));
        }
        other => panic!("{other:?}"),
    }

    // Nothing is plugged in: the emulated board is an Enter away.
    model.take(&status(|status| status.kind = Some(source::Kind::Port)));
    let emulated = Choice::Emulated(Emulation::default());
    assert_eq!(
        press(&mut model, key(KeyCode::Enter)),
        Some(Wish::Switch(emulated))
    );
    model.take(&status(|status| status.kind = Some(source::Kind::Replay)));
    assert_eq!(typed(&mut model, 'r'), None);
    assert!(model.notice.expect("a reason").contains("recording"));
}

#[test]
fn with_nothing_plugged_in_it_says_what_to_do() {
    let mut model = Model::new();
    model.take(&status(|status| {
        status.kind = Some(source::Kind::Port);
        status.trouble = Some(Failure::new(Kind::Board, "no board is plugged in"));
    }));
    for size in [LEAST, [200, 60]] {
        let whole = Rect::new(0, 0, size[0], size[1]);
        let words = text(&drawn(&model, size), whole);
        assert!(words.contains("no board is plugged in"), "{words}");
        assert!(words.contains("Enter starts the emulated board"), "{words}");
    }
}

#[test]
fn both_eyes_see_the_cube_and_a_turned_head_sees_another_column() {
    let size = [160, 50];
    let areas = Areas::of(Rect::new(0, 0, size[0], size[1]), true).expect("room");
    let mut model = Model::new();
    model.take(&connected());
    model.take(&stream(UnitQuaternion::identity(), 0.0));
    assert_eq!(typed(&mut model, 's'), None);
    let view = areas.view;
    let middle = view.x + view.width / 2;
    let left = within(Rect {
        width: middle - view.x,
        ..view
    });
    let right = within(Rect {
        x: middle,
        width: view.right() - middle,
        ..view
    });
    let cube =
        |buffer: &Buffer, eye: Rect| found(buffer, eye, vrduino_host::tui::scene::Ink::Z, "Z")[0];
    let ahead = drawn(&model, size);
    // What is near is further to the right for the left eye.
    assert!(cube(&ahead, left) > cube(&ahead, right) + 1.0);
    let words = text(&ahead, view);
    assert!(
        words.contains("0°") && words.contains("30°") && !words.contains("60°"),
        "{words}"
    );

    // To the left by a quarter turn, and with the board turned round nothing else is seen.
    let quarter = UnitQuaternion::from_euler_angles(0.0, 90.0_f64.to_radians(), 0.0);
    model.take(&stream(quarter, 1.0));
    let words = text(&drawn(&model, size), view);
    assert!(
        words.contains("90°") && words.contains("120°") && !words.contains(" 0°"),
        "{words}"
    );
    // Leaning over, the neck moves the eyes aside: the cube is elsewhere than without.
    model.take(&stream(
        UnitQuaternion::from_euler_angles(0.0, 0.0, 0.5),
        2.0,
    ));
    let neck = drawn(&model, size);
    assert_eq!(typed(&mut model, 'h'), None);
    let eyes = drawn(&model, size);
    assert_ne!(cube(&neck, left), cube(&eyes, left));
    assert!(text(&eyes, view).contains("about the eyes"));
}

fn stream(orientation: UnitQuaternion<f64>, arrival: f64) -> Update {
    let sample = Sample {
        time: arrival,
        arrival,
        orientation,
        sequence: Some(0),
        status: Some(vrduino::wire::Status::from_byte((arrival * 100.0) as u8)),
        delay: Some(arrival),
        is_first: arrival == 0.0,
    };
    Update::Stream(Arc::from([Item::Sample(sample)]))
}

#[test]
fn no_size_and_no_state_is_too_much() {
    // Turned every way, the poles and half turns among them.
    let quarter = |n: i32| f64::from(n) * std::f64::consts::FRAC_PI_4;
    let turns: Vec<_> = (0..27)
        .map(|i| {
            UnitQuaternion::from_euler_angles(
                quarter(i % 3),
                quarter(i / 3 % 3) * 2.0,
                quarter(i / 9) * 2.0,
            )
        })
        .collect();
    let long = "error: ".to_owned() + &"ü→°".repeat(60);
    let mut models = Vec::new();
    for (i, state) in [State::Waiting, State::Connected, State::Lost, State::Ended]
        .into_iter()
        .enumerate()
    {
        for keys in ["", "s", "sf?", "hsp", "m", "?"] {
            let mut model = Model::new();
            model.take(&status(|status| {
                status.state = state;
                status.source = long.clone();
                status.version = Some(long.clone());
                status.report.rate = 1e6;
                status.report.missing = u64::MAX;
                status.trouble = (i % 2 == 0).then(|| Failure::new(Kind::Board, long.clone()));
            }));
            model.take(&Update::Stream(Arc::from([Item::Line(long.clone())])));
            models.push(model.clone());
            for (at, turn) in turns.iter().enumerate() {
                model.take(&stream(*turn, at as f64 * 0.03));
            }
            for letter in keys.chars() {
                typed(&mut model, letter);
            }
            models.push(model);
        }
    }
    let sizes = [
        [1, 1],
        [20, 5],
        [79, 24],
        [80, 23],
        LEAST,
        [81, 30],
        [115, 29],
        [116, 30],
        [117, 90],
        [200, 24],
        [200, 60],
        [80, 60],
        [255, 25],
    ];
    for size in sizes {
        for model in &models {
            let words = text(&drawn(model, size), Rect::new(0, 0, size[0], size[1]));
            if size[0] < LEAST[0] || size[1] < LEAST[1] {
                assert!(size[0] < 20 || words.contains("vrduino wants"), "{words}");
            } else {
                assert!(words.contains("1000000 /s"), "{words}");
            }
        }
    }
    // And every orientation at the least size.
    for turn in turns {
        let mut model = Model::new();
        model.take(&connected());
        model.take(&stream(turn, 1.0));
        drawn(&model, LEAST);
    }
}
