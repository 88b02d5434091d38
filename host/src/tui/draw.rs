//! Draws a [`Model`].
//!
//! Of the sixteen colours only those that can be read on light and on dark are taken, and nothing is
//! told by colour alone: axes have letters, states have shapes, warnings begin with their word.

mod areas;

mod charts;

mod help;

mod lines;

mod numbers;

mod title;

mod view;

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};
use ratatui::text::Line;
use ratatui::widgets::{Block, BorderType, Borders, Paragraph, Wrap};

use super::model::Model;
use super::strips;
pub use areas::{Areas, LEAST};
pub use view::colour;

/// Less important than the rest.
const DIM: Style = Style::new().add_modifier(Modifier::DIM);

/// More important than the rest.
const BOLD: Style = Style::new().add_modifier(Modifier::BOLD);

/// Draws it all over the frame.
pub fn draw(frame: &mut Frame, model: &Model) {
    let whole = frame.area();
    let Some(areas) = Areas::of(whole, model.is_stereo) else {
        too_small(frame, model, whole);
        return;
    };
    title::draw(frame, model, areas.title);
    view::draw(frame, model, areas.view);
    if let Some(numbers) = areas.numbers {
        numbers::draw(frame, model, numbers);
    }
    charts::draw(frame, model, areas.strips);
    lines::draw(frame, model, areas.lines);
    title::keys(frame, model, areas.keys);
    if model.shows_help {
        help::draw(frame, whole);
    }
}

/// What is left where there is no room.
fn too_small(frame: &mut Frame, model: &Model, area: Rect) {
    let [width, height] = LEAST;
    let mut text = vec![Line::from(format!(
        "vrduino wants a window of {width} by {height} characters; this one has {} by {}. Enlarge it, or take `vrduino monitor`. q quits.",
        area.width, area.height
    ))];
    if let Some(sample) = &model.sample {
        let [yaw, pitch, roll] = strips::angles(sample);
        text.push(Line::from(format!(
            "yaw {yaw:.1}° pitch {pitch:.1}° roll {roll:.1}°"
        )));
    }
    frame.render_widget(Paragraph::new(text).wrap(Wrap { trim: true }), area);
}

/// A frame with a title.
fn panel(title: &str) -> Block<'_> {
    Block::new()
        .borders(Borders::ALL)
        .border_type(BorderType::Rounded)
        .border_style(DIM)
        .title(Line::styled(format!(" {title} "), BOLD))
}
