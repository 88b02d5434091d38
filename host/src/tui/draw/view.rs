//! The picture: the board, or the room through both eyes.

use ratatui::Frame;
use ratatui::layout::{Alignment, Constraint, Flex, Layout, Rect};
use ratatui::style::{Color, Style};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::canvas::{self, Canvas};
use ratatui::widgets::{Clear, Paragraph, Wrap};
use vrduino::view::eyes::Eye;

use super::{BOLD, panel};
use crate::hub::State;
use crate::source::Kind;
use crate::tui::model::Model;
use crate::tui::scene::{Ink, Picture, board, room};

/// Draws it, and over it what keeps it from turning.
pub fn draw(frame: &mut Frame, model: &Model, area: Rect) {
    if model.is_stereo {
        let halves = Layout::horizontal([Constraint::Fill(1); 2]).areas::<2>(area);
        let names = [("left eye", Eye::Left), ("right eye", Eye::Right)];
        for (half, (name, eye)) in halves.into_iter().zip(names) {
            let mut block = panel(name);
            if eye == Eye::Right {
                block = block.title(Line::from(standing(model)).right_aligned());
            }
            let inner = block.inner(half);
            frame.render_widget(block, half);
            let viewer = model.viewer();
            let picture = room::picture(&viewer, model.orientation(), eye, aspect(inner));
            paint(frame, inner, &picture);
        }
    } else {
        let block = panel("board").title(Line::from(" seen by the wearer ").right_aligned());
        let inner = block.inner(area);
        frame.render_widget(block, area);
        let picture = board::picture(model.orientation(), aspect(inner));
        paint(frame, inner, &picture);
    }
    if let Some(text) = hindrance(model) {
        sign(frame, area, text);
    }
}

/// How the headset is worn.
fn standing(model: &Model) -> String {
    let neck = if model.has_neck {
        "about the neck"
    } else {
        "about the eyes"
    };
    let mounting = if model.is_turned_round {
        ", board turned round"
    } else {
        ""
    };
    format!(" {neck}{mounting} ")
}

/// Width over height, in dots: a character is two by four of them, which are square on most terminals.
fn aspect(area: Rect) -> f64 {
    f64::from(area.width.max(1)) / (2.0 * f64::from(area.height.max(1)))
}

/// The colour of an ink.
pub fn colour(ink: Ink) -> Color {
    match ink {
        Ink::Thing => Color::Reset,
        Ink::Part => Color::Cyan,
        Ink::X => Color::Red,
        Ink::Y => Color::Green,
        Ink::Z => Color::LightBlue,
        Ink::Ground => Color::DarkGray,
    }
}

fn paint(frame: &mut Frame, area: Rect, picture: &Picture) {
    // One layer for each ink: the last has a character's colour.
    const ORDER: [Ink; 6] = [Ink::Ground, Ink::Part, Ink::Thing, Ink::Z, Ink::Y, Ink::X];
    let canvas = Canvas::default()
        .marker(Marker::Braille)
        .x_bounds([-1.0, 1.0])
        .y_bounds([-1.0, 1.0])
        .paint(|context| {
            for ink in ORDER {
                for &(_, [from, to]) in picture.lines.iter().filter(|line| line.0 == ink) {
                    let line = canvas::Line::new(from[0], from[1], to[0], to[1], colour(ink));
                    context.draw(&line);
                }
            }
            for (ink, [x, y], text) in &picture.marks {
                let style = if *ink == Ink::Ground {
                    Style::new().fg(colour(*ink))
                } else {
                    BOLD.fg(colour(*ink))
                };
                context.print(*x, *y, Line::styled(text.clone(), style));
            }
        });
    frame.render_widget(canvas, area);
}

/// Why nothing turns, and what to do.
fn hindrance(model: &Model) -> Option<Vec<Line<'static>>> {
    let status = &model.status;
    let trouble = status
        .trouble
        .as_ref()
        .map(|failure| failure.sentence.clone());
    let is_emulated = status.kind == Some(Kind::Emulated);
    let mut text = match status.state {
        State::Connected if model.sample.is_some() => return None,
        State::Connected => vec![Line::from(trouble.unwrap_or_else(|| {
            "The board is there. It measures its gyro's bias: keep it still for a second or two"
                .into()
        }))],
        State::Waiting if is_emulated => {
            vec![Line::from(trouble.unwrap_or_else(|| {
                "The emulated board is being switched on".into()
            }))]
        }
        State::Waiting | State::Lost => vec![Line::from(
            trouble.unwrap_or_else(|| "Looking for the board".into()),
        )],
        State::Ended => vec![Line::from(
            trouble.unwrap_or_else(|| "The recording is at its end".into()),
        )],
    };
    let key = |key: &'static str, what: &'static str| {
        Line::from(vec![Span::styled(key, BOLD), Span::raw(what)])
    };
    if status.state == State::Lost && is_emulated {
        text.push(key("u", " puts the plug back"));
    } else if matches!(status.state, State::Waiting | State::Lost | State::Ended)
        && (!is_emulated || status.state == State::Ended)
    {
        text.push(key("Enter", " starts the emulated board"));
    }
    Some(text)
}

/// A sign in the middle of the picture.
fn sign(frame: &mut Frame, area: Rect, text: Vec<Line<'static>>) {
    let width = area.width.saturating_sub(4).clamp(1, 60);
    let columns = usize::from(width.saturating_sub(4).max(1));
    // Words do not fill their lines, hence the fifth more.
    let rows: usize = text
        .iter()
        .map(|line| (line.width() * 6 / 5).div_ceil(columns).max(1))
        .sum();
    let height = u16::try_from(rows + 2).unwrap_or(u16::MAX).min(area.height);
    let [area] = Layout::horizontal([Constraint::Length(width)])
        .flex(Flex::Center)
        .areas(area);
    let [area] = Layout::vertical([Constraint::Length(height)])
        .flex(Flex::Center)
        .areas(area);
    frame.render_widget(Clear, area);
    let block = panel("").border_style(Style::new().fg(Color::Magenta));
    let paragraph = Paragraph::new(text)
        .block(block)
        .alignment(Alignment::Center)
        .wrap(Wrap { trim: true });
    frame.render_widget(paragraph, area);
}
