//! What the board says, the latest last.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::text::Line;
use ratatui::widgets::Paragraph;

use super::{DIM, panel};
use crate::tui::model::Model;

/// Draws as many as there is room for.
pub fn draw(frame: &mut Frame, model: &Model, area: Rect) {
    let block = panel("lines of the board");
    let room = usize::from(block.inner(area).height);
    let first = model.lines.len().saturating_sub(room);
    let lines: Vec<Line> = model
        .lines
        .iter()
        .skip(first)
        .map(|line| Line::styled(format!(" {line}"), style(line)))
        .collect();
    frame.render_widget(Paragraph::new(lines).block(block), area);
}

fn style(line: &str) -> Style {
    if line.starts_with("error:") || line.starts_with("ERR ") {
        Style::new().fg(Color::Red)
    } else if line.starts_with("warning:") {
        Style::new().fg(Color::Magenta)
    } else if line.starts_with('>') {
        DIM
    } else {
        Style::new()
    }
}
