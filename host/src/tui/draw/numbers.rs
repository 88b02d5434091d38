//! The numbers beside the picture, what matters most first: what finds no room is left out.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::Paragraph;

use super::{DIM, panel};
use crate::hub::Status;
use crate::tui::model::Model;

/// Draws them.
pub fn draw(frame: &mut Frame, model: &Model, area: Rect) {
    let block = panel("stream");
    frame.render_widget(Paragraph::new(rows(model)).block(block), area);
}

fn rows(model: &Model) -> Vec<Line<'static>> {
    let status = &model.status;
    let report = &status.report;
    let mut rows = vec![
        row("rate", format!("{:.1} a second", report.rate)),
        row("delay, ms", delay(status)),
        losses(status),
    ];
    // Two to a row, what wants attention first.
    let words = model.condition().words();
    for (i, pair) in words.chunks(2).enumerate() {
        let name = if i == 0 { "status" } else { "" };
        rows.push(row(name, pair.join(", ")));
    }
    rows.push(row("estimator", known(status.estimator.clone())));
    rows.push(row("weight", weight(status)));
    if let Some(off) = model.off {
        let off = off.to_degrees();
        rows.push(row("truth", format!("{off:.2}° off")));
    }
    if let Some(motion) = &status.motion {
        rows.push(row("motion", motion.clone()));
    }
    rows.push(row("sent as", known(status.stream.clone())));
    rows.push(row(
        "starts",
        format!(
            "{} again, {} new connections",
            report.restarts, report.reconnections
        ),
    ));
    rows
}

fn row(name: &'static str, value: String) -> Line<'static> {
    Line::from(vec![
        Span::styled(format!(" {name:<10}"), DIM),
        Span::raw(value),
    ])
}

fn known(value: Option<String>) -> String {
    value.unwrap_or_else(|| "not known yet".into())
}

fn delay(status: &Status) -> String {
    // The fastest are the zero; see `vrduino monitor --help`.
    let delay = status.report.delay;
    delay.map_or("not known: no device time".into(), |delay| {
        delay.to_string()
    })
}

fn losses(status: &Status) -> Line<'static> {
    let report = &status.report;
    let found: Vec<String> = [
        (report.missing, "missing"),
        (report.damaged, "CRC"),
        (report.malformed, "malformed"),
        (report.bytes, "bytes"),
    ]
    .into_iter()
    .filter(|&(count, _)| count > 0)
    .map(|(count, what)| format!("{count} {what}"))
    .collect();
    if found.is_empty() {
        row("lost", "nothing".into())
    } else {
        let mut line = row("lost", found.join(", "));
        line.spans[1].style = Style::new().fg(Color::Red);
        line
    }
}

/// The time constant of the estimator in use, of the notes' with its weight of the gyro.
fn weight(status: &Status) -> String {
    let notes = status.estimator.as_deref() == Some("notes");
    let name = if notes { "notes-time" } else { "tilt-time" };
    let Some(time) = status.settings.get(name) else {
        return "not known yet".into();
    };
    if notes {
        // α = τ / (τ + Δt) with samples of a millisecond.
        let alpha = time / (time + 1e-3);
        format!("α {alpha:.6}, τ {time} s")
    } else {
        format!("{name} {time} s")
    }
}
