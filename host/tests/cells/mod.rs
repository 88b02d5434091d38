//! Terminals of cells, and what may be drawn into them.

// Every test file compiles a copy of this and calls what it needs of it: the rest is unused there, not everywhere.
#![allow(dead_code, reason = "not every test asks for everything")]

use std::sync::Arc;

use nalgebra::UnitQuaternion;
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::Buffer;
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::layout::Rect;
use vrduino_host::hub::{State, Status, Update};
use vrduino_host::source;
use vrduino_host::stream::{Item, Sample};
use vrduino_host::tui::draw;
use vrduino_host::tui::keys::{Wish, press};
use vrduino_host::tui::model::Model;
use vrduino_host::tui::scene::Ink;

/// The model, drawn.
pub fn drawn(model: &Model, [width, height]: [u16; 2]) -> Buffer {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).expect("cells");
    terminal
        .draw(|frame| draw::draw(frame, model))
        .expect("drawn");
    terminal.backend().buffer().clone()
}

/// The words in a part of it, row after row.
pub fn text(buffer: &Buffer, area: Rect) -> String {
    let row = |y| (area.left()..area.right()).map(move |x| buffer[(x, y)].symbol());
    let rows = (area.top()..area.bottom()).map(|y| row(y).collect::<String>());
    rows.collect::<Vec<_>>().join("\n")
}

/// A key, pressed.
pub fn key(code: KeyCode) -> KeyEvent {
    KeyEvent::new(code, KeyModifiers::NONE)
}

/// A letter, typed.
pub fn typed(model: &mut Model, letter: char) -> Option<Wish> {
    press(model, key(KeyCode::Char(letter)))
}

/// Where a letter of that colour stands in the area.
pub fn found(buffer: &Buffer, area: Rect, ink: Ink, letter: &str) -> [f64; 2] {
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
pub fn within(area: Rect) -> Rect {
    Rect::new(area.x + 1, area.y + 1, area.width - 2, area.height - 2)
}

/// How things are, but for this change as nothing has come.
pub fn status(change: impl FnOnce(&mut Status)) -> Update {
    let mut status = Status::default();
    change(&mut status);
    Update::Status(Arc::new(status))
}

/// A board on a port.
pub fn connected() -> Update {
    status(|status| {
        status.state = State::Connected;
        status.kind = Some(source::Kind::Port);
        status.source = "/dev/ttyACM0".into();
        status.estimator = Some("default".into());
        status.settings.insert("tilt-time", 3.0);
        status.settings.insert("notes-time", 7.6);
    })
}

/// A sample.
pub fn stream(orientation: UnitQuaternion<f64>, arrival: f64) -> Update {
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
