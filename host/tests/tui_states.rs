//! The view in the terminal, drawn into cells, whatever state things are in: its keys, its sizes, its eyes.

#![cfg(feature = "tui")]

mod cells;

use std::sync::Arc;

use cells::{connected, drawn, found, key, status, stream, text, typed, within};
use nalgebra::UnitQuaternion;
use ratatui::buffer::Buffer;
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::layout::Rect;
use vrduino_host::failure::{Failure, Kind};
use vrduino_host::hub::{State, Update};
use vrduino_host::source::{self, Choice, Emulation, Order};
use vrduino_host::stream::Item;
use vrduino_host::tui::draw::{Areas, LEAST};
use vrduino_host::tui::keys::{Wish, press};
use vrduino_host::tui::model::Model;
use vrduino_host::tui::scene::Ink;

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
    for letter in ['n', 'u'] {
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
        typed(&mut model, 'n'),
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
    assert_eq!(typed(&mut model, 'v'), None);
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
    let cube = |buffer: &Buffer, eye: Rect| found(buffer, eye, Ink::Z, "Z")[0];
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
        for keys in ["", "v", "vm?", "hvp", "n", "?"] {
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

#[test]
fn a_board_that_does_not_answer_is_told_once() {
    let mut model = Model::new();
    let strange = || {
        status(|status| {
            status.state = State::Connected;
            status.trouble = Some(Failure::new(Kind::Stream, "the board does not answer"));
        })
    };
    model.take(&strange());
    model.take(&strange());
    assert_eq!(model.lines, ["warning: the board does not answer"]);
}
