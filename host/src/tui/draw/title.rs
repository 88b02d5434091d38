//! The first row and the last.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::text::{Line, Span};

use super::{BOLD, DIM};
use crate::hub::State;
use crate::tui::model::Model;

/// What is seen, and whether it is there.
pub fn draw(frame: &mut Frame, model: &Model, area: Rect) {
    let status = &model.status;
    let (shape, word, colour) = match status.state {
        State::Connected => ("●", "connected", Color::Green),
        State::Waiting => ("○", "waiting", Color::Magenta),
        State::Lost => ("×", "gone", Color::Red),
        State::Ended => ("■", "ended", Color::Magenta),
    };
    let mut left = vec![Span::styled(" vrduino ", BOLD)];
    if !status.source.is_empty() {
        left.push(Span::raw(format!("{} ", status.source)));
    }
    if let Some(version) = &status.version {
        left.push(Span::styled(format!("({version}) "), DIM));
    }
    let mut right = Vec::new();
    if model.is_paused {
        right.push(Span::styled("‖ paused  ", BOLD));
    }
    right.push(Span::raw(format!("{:.0} /s  ", status.report.rate)));
    right.push(Span::styled(
        format!("{shape} {word} "),
        Style::new().fg(colour),
    ));
    frame.render_widget(Line::from(left), area);
    frame.render_widget(Line::from(right).right_aligned(), area);
}

/// The keys, or why the last one did nothing.
pub fn keys(frame: &mut Frame, model: &Model, area: Rect) {
    if let Some(notice) = &model.notice {
        let notice = Line::styled(format!(" {notice}"), Style::new().fg(Color::Magenta));
        frame.render_widget(notice, area);
        return;
    }
    /// The last of these are left to the help where there is no room for them.
    const KEYS: [(&str, &str); 10] = [
        ("q", "quit"),
        ("?", "keys"),
        ("r", "ahead"),
        ("b", "bias"),
        ("e", "estimator"),
        ("v", "stereo"),
        ("p", "pause"),
        ("n", "motion"),
        ("u", "plug"),
        ("+ -", "tilt"),
    ];
    let mut spans = vec![Span::raw(" ")];
    let mut room = usize::from(area.width);
    for (key, what) in KEYS {
        let width = key.chars().count() + what.len() + 3;
        if room <= width {
            break;
        }
        room -= width;
        spans.push(Span::styled(key, BOLD));
        spans.push(Span::styled(format!(" {what}  "), DIM));
    }
    frame.render_widget(Line::from(spans), area);
}
