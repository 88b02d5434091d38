//! What the keys do.

use nalgebra::UnitQuaternion;
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use vrduino::command::request::Setting;
use vrduino::orientation::euler::EulerAngles;
use vrduino::units::Angle;

use super::model::Model;
use super::strips::Strips;
use crate::hub::State;
use crate::source::{Choice, Emulation, Kind, Order};

/// What a key asks of the board, the source or the program.
#[derive(Clone, Debug, PartialEq)]
pub enum Wish {
    /// Press this key of the board's.
    Press(u8),
    /// Type this line to it.
    Say(String),
    /// For the source.
    Order(Order),
    /// Take another source.
    Switch(Choice),
    /// That was all.
    Quit,
}

/// The keys, those of the page where it has the same, and what they do, in the order in which they are explained.
pub const KEYS: [(&str, &str); 15] = [
    (
        "r",
        "face ahead: heading zero is where the board points now",
    ),
    ("b", "measure the gyro's bias again: keep the board still"),
    ("e", "the other estimator: default, or the course notes'"),
    (
        "+ -",
        "tilt-time longer, shorter (notes' estimator: its weight α)",
    ),
    (
        "v",
        "stereo: look through the headset with both eyes, or at the board",
    ),
    (
        "h",
        "head and neck: turn about the neck (algorithm 3) or the eyes (2)",
    ),
    (
        "m",
        "the board is fixed to the headset's front, turned by 180°",
    ),
    ("p", "pause the picture; what comes is still counted"),
    ("n", "the emulated board's next motion"),
    ("arrows", "turn the emulated board, if its motion is “hand”"),
    ("u", "pull the emulated board's plug, or put it back"),
    ("Enter", "start the emulated board, where none is there"),
    ("c", "clear the lines of the board"),
    ("?", "this"),
    ("q", "quit; so do Esc and Ctrl-C"),
];

/// A key of the viewer's was pressed.
pub fn press(model: &mut Model, key: KeyEvent) -> Option<Wish> {
    if key.kind == KeyEventKind::Release {
        return None;
    }
    model.notice = None;
    if key.modifiers.contains(KeyModifiers::CONTROL) {
        return matches!(key.code, KeyCode::Char('c' | 'q')).then_some(Wish::Quit);
    }
    match key.code {
        KeyCode::Char('q') => return Some(Wish::Quit),
        KeyCode::Esc if model.shows_help => model.shows_help = false,
        KeyCode::Esc => return Some(Wish::Quit),
        KeyCode::Char('?') => model.shows_help = !model.shows_help,
        KeyCode::Char('v') => model.is_stereo = !model.is_stereo,
        KeyCode::Char('h') => model.has_neck = !model.has_neck,
        KeyCode::Char('m') => model.is_turned_round = !model.is_turned_round,
        KeyCode::Char('p') => model.is_paused = !model.is_paused,
        KeyCode::Char('c') => model.lines.clear(),
        KeyCode::Enter => return emulate(model),
        KeyCode::Char(key @ ('r' | 'b')) => {
            return to_board(model).then_some(Wish::Press(key as u8));
        }
        KeyCode::Char('e') => return change_estimator(model),
        KeyCode::Char('+' | '=') => return change_weight(model, 1.25),
        KeyCode::Char('-' | '_') => return change_weight(model, 1.0 / 1.25),
        KeyCode::Char('n') => return next_motion(model),
        KeyCode::Char('u') => {
            let plugged = model.status.state == State::Connected;
            return to_emulated(model).then_some(Wish::Order(Order::Plug(!plugged)));
        }
        KeyCode::Left => return turn(model, [10.0, 0.0]),
        KeyCode::Right => return turn(model, [-10.0, 0.0]),
        KeyCode::Up => return turn(model, [0.0, 10.0]),
        KeyCode::Down => return turn(model, [0.0, -10.0]),
        _ => {}
    }
    None
}

fn refuse(model: &mut Model, why: &str) -> bool {
    model.notice = Some(why.to_owned());
    false
}

/// Whether a board is there to be spoken to; says so if not.
fn to_board(model: &mut Model) -> bool {
    if model.status.kind == Some(Kind::Replay) {
        refuse(model, "a recording plays: there is no board to be told")
    } else if model.status.state != State::Connected {
        refuse(model, "no board is there to be told")
    } else {
        true
    }
}

fn to_emulated(model: &mut Model) -> bool {
    if model.status.kind == Some(Kind::Emulated) && model.status.state != State::Ended {
        true
    } else {
        refuse(
            model,
            "that is for the emulated board: --emulate, or Enter where no board is there",
        )
    }
}

fn emulate(model: &mut Model) -> Option<Wish> {
    let is_there = model.status.state == State::Connected;
    let is_it = model.status.kind == Some(Kind::Emulated) && model.status.state != State::Ended;
    if is_there || is_it {
        refuse(model, "a board is there already");
        return None;
    }
    Some(Wish::Switch(Choice::Emulated(Emulation::default())))
}

/// Types a line whose answer is shown.
fn say(model: &mut Model, line: String) -> Wish {
    model.note(format!("> {line}"));
    model.awaited += 1;
    Wish::Say(line)
}

fn settings_known(model: &mut Model) -> bool {
    to_board(model)
        && (model.status.estimator.is_some()
            || refuse(model, "the board has not said yet how it is set"))
}

fn change_estimator(model: &mut Model) -> Option<Wish> {
    if !settings_known(model) {
        return None;
    }
    let other = match model.status.estimator.as_deref() {
        Some("notes") => "default",
        _ => "notes",
    };
    Some(say(model, format!(":estimator {other}")))
}

/// The time constant of the estimator in use; that of the notes' is the same as its weight α.
fn change_weight(model: &mut Model, factor: f64) -> Option<Wish> {
    if !settings_known(model) {
        return None;
    }
    let setting = match model.status.estimator.as_deref() {
        Some("notes") => Setting::NotesTime,
        _ => Setting::TiltTime,
    };
    let name = setting.name();
    let Some(&value) = model.status.settings.get(name) else {
        refuse(model, "the board has not said yet how it is set");
        return None;
    };
    // From zero no factor leads away; below 0.1 s there is no difference to be seen.
    let most = f64::from(setting.range()[1]);
    let value = (value.max(0.1) * factor).clamp(0.1, most);
    Some(say(model, format!(":set {name} {value:.2}")))
}

fn next_motion(model: &mut Model) -> Option<Wish> {
    if !to_emulated(model) {
        return None;
    }
    let motions = model.status.motions;
    let current = model.status.motion.as_deref();
    let at = motions.iter().position(|&motion| Some(motion) == current);
    let next = motions.get(at.map_or(0, |at| (at + 1) % motions.len()))?;
    // What the last one drew says nothing about the next.
    model.sample = None;
    model.strips = Strips::default();
    Some(Wish::Order(Order::Motion((*next).to_owned())))
}

fn turn(model: &mut Model, [yaw, pitch]: [f64; 2]) -> Option<Wish> {
    if !to_emulated(model) {
        return None;
    }
    if model.status.motion.as_deref() != Some("hand") {
        refuse(
            model,
            "the arrows turn the board if its motion is “hand”: press n until it is",
        );
        return None;
    }
    let [before_yaw, before_pitch] = model.hand;
    model.hand = [
        (before_yaw + yaw + 180.0).rem_euclid(360.0) - 180.0,
        (before_pitch + pitch).clamp(-80.0, 80.0),
    ];
    let q: UnitQuaternion<f64> = EulerAngles {
        yaw: Angle::from_degrees(model.hand[0]),
        pitch: Angle::from_degrees(model.hand[1]),
        roll: Angle::from_degrees(0.0),
    }
    .orientation();
    Some(Wish::Order(Order::Turn([q.w, q.i, q.j, q.k])))
}
