//! Yaw, pitch and roll over the last seconds.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::Color;
use ratatui::symbols::Marker;
use ratatui::text::Line;
use ratatui::widgets::canvas::{self, Canvas};

use super::{BOLD, DIM, panel};
use crate::tui::model::Model;
use crate::tui::strips::{self, NAMES, SPAN, Strips};

/// Draws all three.
pub fn draw(frame: &mut Frame, model: &Model, areas: [Rect; 3]) {
    let angles = model.sample.as_ref().map(strips::angles);
    for (axis, area) in areas.into_iter().enumerate() {
        let value = angles.map_or_else(String::new, |angles| format!(" {:+.1}° ", angles[axis]));
        let block = panel(NAMES[axis]).title(Line::styled(value, BOLD).right_aligned());
        let inner = block.inner(area);
        frame.render_widget(block, area);
        strip(frame, inner, &model.strips, axis);
    }
}

fn strip(frame: &mut Frame, area: Rect, strips: &Strips, axis: usize) {
    let [low, high] = strips.range(axis);
    let now = strips.now();
    // A turn over the seam goes out at the top and comes in at the bottom.
    let is_seam = |from: f64, to: f64| (to - from).abs() > 180.0;
    let canvas = Canvas::default()
        .marker(Marker::Braille)
        .x_bounds([now - SPAN, now])
        .y_bounds([low, high])
        .paint(|context| {
            if low < 0.0 && high > 0.0 {
                // Dots, so that it is no curve.
                let zero: Vec<_> = (0..=50)
                    .map(|i| (now - SPAN + f64::from(i) * SPAN / 50.0, 0.0))
                    .collect();
                context.draw(&canvas::Points::new(&zero, Color::DarkGray));
            }
            context.layer();
            let points = strips.points();
            for (from, to) in points.clone().zip(points.skip(1)) {
                let (before, after) = (from.angles[axis], to.angles[axis]);
                if to.is_joined && !is_seam(before, after) {
                    let line = canvas::Line::new(from.time, before, to.time, after, Color::Reset);
                    context.draw(&line);
                }
            }
            // Of the text's colour, whatever is drawn there.
            let label = |angle: f64| Line::styled(format!("{angle:.0}°"), DIM.fg(Color::Reset));
            context.print(now - SPAN, high, label(high));
            context.print(now - SPAN, low, label(low));
        });
    frame.render_widget(canvas, area);
}
