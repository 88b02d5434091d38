//! The figure on a sheet: angles, rate and delay over the same time.

use std::fmt::Display;
use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

use super::curve::Point;
use super::figure::Figure;
use crate::failure::{Failure, Kind};

/// Of the sheet, at scale 1.
pub const SIZE: (u32, u32) = (1200, 800);

const FONT: &str = "sans-serif";

// Told apart by those who see fewer colours too (Okabe and Ito).
const YAW: RGBColor = RGBColor(0, 114, 178);
const PITCH: RGBColor = RGBColor(213, 94, 0);
const ROLL: RGBColor = RGBColor(0, 158, 115);
const OTHER: RGBColor = RGBColor(80, 80, 80);
const GAP: RGBColor = RGBColor(242, 218, 232);
const RESTART: RGBColor = RGBColor(204, 121, 167);
const TEXT: RGBColor = RGBColor(40, 40, 40);

type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// As SVG.
pub fn svg(figure: &Figure) -> Result<Vec<u8>, Failure> {
    /// Corners lie on whole units: of a finer sheet they are, or curves would have steps.
    const FINE: u32 = 4;
    let mut text = String::new();
    let (width, height) = SIZE;
    let sheet = SVGBackend::with_string(&mut text, (width * FINE, height * FINE));
    let scale = f64::from(FINE);
    draw(figure, sheet.into_drawing_area(), scale, Pieces::Whole)?;
    let size = |scale| format!(r#"width="{}" height="{}""#, width * scale, height * scale);
    Ok(text.replacen(&size(FINE), &size(1), 1).into_bytes())
}

/// On a sheet of `scale` times the size.
pub fn draw<DB: DrawingBackend>(
    figure: &Figure,
    sheet: DrawingArea<DB, Shift>,
    scale: f64,
    pieces: Pieces,
) -> Result<(), Failure> {
    let letters = register_font(FONT, FontStyle::Normal, dejavu::sans::regular());
    letters.map_err(|_| failed("the font is no font"))?;
    let page = Page {
        figure,
        scale,
        pieces,
    };
    page.draw(&sheet).map_err(failed)?;
    sheet.present().map_err(failed)
}

fn failed(why: impl Display) -> Failure {
    Failure::new(
        Kind::Computer,
        format!("the picture cannot be drawn: {why}"),
    )
}

/// How lines are handed over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pieces {
    /// As they are.
    Whole,
    /// Step by step: the corners of a wide line in pixels would stand out far beyond a sharp peak.
    Steps,
}

struct Page<'a> {
    figure: &'a Figure,
    scale: f64,
    pieces: Pieces,
}

type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

impl Page<'_> {
    fn draw<DB: DrawingBackend>(&self, sheet: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        sheet.fill(&WHITE)?;
        let sheet = sheet.margin(self.px(16), self.px(12), self.px(14), self.px(24));
        let (heading, panels) = sheet.split_vertically(self.px(66));
        self.head(&heading)?;
        let figure = self.figure;
        let height = f64::from(panels.dim_in_pixel().1);
        let has_delay = figure.delay.range().is_some();
        let (angles, rest) = panels.split_vertically((height * 0.56) as i32);
        let mut lines = Vec::new();
        for (curve, colour) in [
            (&figure.yaw, YAW),
            (&figure.pitch, PITCH),
            (&figure.roll, ROLL),
        ] {
            lines.extend(curve.lines().into_iter().map(|line| (line, colour)));
        }
        let ranges = [&figure.yaw, &figure.pitch, &figure.roll].map(|curve| curve.range());
        let degrees = roomy(union(ranges), 1.0);
        self.panel(&angles, "angle, degrees", degrees, &lines, false)?;

        let rates = figure.rate.iter().map(|point| Some((0.0, point.1)));
        let rates = 0.0..roomy(union(rates), 1.0).end * 1.1;
        let line = [(figure.rate.clone(), OTHER)];
        if !has_delay {
            return self.panel(&rest, "samples a second", rates, &line, true);
        }
        let (middle, bottom) = rest.split_vertically((height * 0.195) as i32);
        self.panel(&middle, "samples a second", rates, &line, false)?;
        let delays = 0.0..roomy(figure.delay.range(), 0.1).end;
        let lines: Vec<_> = figure
            .delay
            .lines()
            .into_iter()
            .map(|line| (line, OTHER))
            .collect();
        self.panel(&bottom, "delay, ms", delays, &lines, true)
    }

    fn head<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let text = |size| (FONT, self.size(size)).into_font().color(&TEXT);
        let left = self.px(12);
        area.draw(&Text::new(self.figure.title.as_str(), (left, 0), text(25)))?;
        let second = self.px(34);
        let subtitle = self.figure.subtitle.as_str();
        area.draw(&Text::new(subtitle, (left, second), text(17)))?;
        // From the right, in columns.
        let mut x = area.dim_in_pixel().0 as i32;
        let entries = [("roll", ROLL), ("pitch", PITCH), ("yaw", YAW)];
        for (name, colour) in entries {
            x -= self.px(92);
            let y = second + self.px(8);
            let line = [(x, y), (x + self.px(28), y)];
            area.draw(&PathElement::new(line, self.stroke(colour, 2.5)))?;
            area.draw(&Text::new(name, (x + self.px(34), second), text(17)))?;
        }
        Ok(())
    }

    fn panel<DB: DrawingBackend>(
        &self,
        area: &DrawingArea<DB, Shift>,
        name: &str,
        values: Range<f64>,
        lines: &[(Vec<Point>, RGBColor)],
        is_last: bool,
    ) -> Drawn<DB> {
        let (unit, unit_name) = match self.figure.end {
            ..900.0 => (1.0, "time, s"),
            ..14_400.0 => (60.0, "time, minutes"),
            _ => (3600.0, "time, hours"),
        };
        let times = match self.figure.end / unit {
            // A single sample has room around it.
            ..=0.0 => -0.5..0.5,
            end => 0.0..end,
        };
        let bottom = self.size(if is_last { 50 } else { 12 });
        let mut chart = ChartBuilder::on(area)
            .margin_top(self.size(8))
            .y_label_area_size(self.size(80))
            .x_label_area_size(bottom)
            .build_cartesian_2d(times.clone(), values.clone())?;
        self.shade(&mut chart, &times, &values, unit)?;
        let text = (FONT, self.size(16)).into_font().color(&TEXT);
        let decimals = |range: &Range<f64>| match range.end - range.start {
            ..0.5 => 2,
            ..8.0 => 1,
            _ => 0,
        };
        let (x, y) = (decimals(&times), decimals(&values));
        let as_time = |value: &f64| match is_last {
            true => number(*value, x),
            false => String::new(),
        };
        let height = area.dim_in_pixel().1;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(self.stroke(RGBColor(225, 225, 225), 1.0))
            .axis_style(self.stroke(RGBColor(120, 120, 120), 1.0))
            .set_all_tick_mark_size(self.px(5))
            .x_labels(10)
            .y_labels((height / self.size(45)).max(2) as usize)
            .x_label_formatter(&as_time)
            .y_label_formatter(&|&value| number(value, y))
            .label_style(text.clone())
            .axis_desc_style(text)
            .y_desc(name)
            .x_desc(if is_last { unit_name } else { "" })
            .draw()?;
        for (line, colour) in lines {
            let points: Vec<Point> = line
                .iter()
                .map(|&(time, value)| (time / unit, value))
                .collect();
            let style = self.stroke(*colour, 1.4);
            match points.as_slice() {
                &[point] => {
                    let dot = Circle::new(point, self.px(3), colour.filled());
                    chart.draw_series([dot])?;
                }
                _ if self.pieces == Pieces::Whole => {
                    chart.draw_series(LineSeries::new(points, style))?;
                }
                points => {
                    let steps = points.windows(2);
                    chart.draw_series(steps.map(|step| PathElement::new(step.to_vec(), style)))?;
                }
            }
        }
        Ok(())
    }

    /// Where there is nothing, and where it began anew.
    fn shade<DB: DrawingBackend>(
        &self,
        chart: &mut Chart<'_, DB>,
        times: &Range<f64>,
        values: &Range<f64>,
        unit: f64,
    ) -> Drawn<DB> {
        // What is narrower could not be seen.
        let least = (times.end - times.start) / 800.0;
        let bands = self.figure.gaps.iter().map(|&(from, to)| {
            let (from, to) = (from / unit, to / unit);
            let grow = ((least - (to - from)) / 2.0).max(0.0);
            let from = (from - grow).max(times.start);
            let to = (to + grow).min(times.end);
            let corners = [(from, values.start), (to, values.end)];
            Rectangle::new(corners, GAP.filled())
        });
        chart.draw_series(bands)?;
        let marks = self.figure.restarts.iter().map(|&time| {
            let ends = [(time / unit, values.start), (time / unit, values.end)];
            PathElement::new(ends, self.stroke(RESTART, 1.5))
        });
        chart.draw_series(marks)?;
        Ok(())
    }

    /// A length on the sheet.
    fn px(&self, length: i32) -> i32 {
        (f64::from(length) * self.scale).round() as i32
    }

    fn size(&self, length: u32) -> u32 {
        (f64::from(length) * self.scale).round() as u32
    }

    fn stroke(&self, colour: RGBColor, width: f64) -> ShapeStyle {
        colour.stroke_width((width * self.scale).round().max(1.0) as u32)
    }
}

/// With some room around it, and never empty: at least so much from end to end.
fn roomy(range: Option<(f64, f64)>, least: f64) -> Range<f64> {
    let (low, high) = range.unwrap_or((0.0, 0.0));
    let room = ((high - low) * 0.05).max((least - (high - low)) / 2.0);
    low - room..high + room
}

fn union(ranges: impl IntoIterator<Item = Option<(f64, f64)>>) -> Option<(f64, f64)> {
    let both = |(a, b): (f64, f64), (c, d): (f64, f64)| (a.min(c), b.max(d));
    ranges.into_iter().flatten().reduce(both)
}

/// As text; what is rounded to zero has no sign.
fn number(value: f64, decimals: usize) -> String {
    let unit = 10_f64.powi(decimals as i32);
    format!("{:.decimals$}", (value * unit).round() / unit + 0.0)
}
