//! What the keys do, over everything.

use ratatui::Frame;
use ratatui::layout::{Constraint, Flex, Layout, Rect};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Clear, Paragraph};

use super::{BOLD, panel};
use crate::tui::keys::KEYS;

/// Draws it.
pub fn draw(frame: &mut Frame, area: Rect) {
    let lines: Vec<Line> = KEYS
        .iter()
        .map(|(key, what)| {
            Line::from(vec![
                Span::styled(format!(" {key:>7}  "), BOLD),
                Span::raw(*what),
            ])
        })
        .collect();
    let width = lines.iter().map(Line::width).max().unwrap_or(0) + 4;
    let size = |count: usize| Constraint::Length(u16::try_from(count).unwrap_or(u16::MAX));
    let [area] = Layout::horizontal([size(width)])
        .flex(Flex::Center)
        .areas(area);
    let [area] = Layout::vertical([size(lines.len() + 2)])
        .flex(Flex::Center)
        .areas(area);
    frame.render_widget(Clear, area);
    frame.render_widget(Paragraph::new(lines).block(panel("keys")), area);
}
