//! Cells of a terminal as SVG.
//!
//! Fonts differ in what they make of braille and of frames, so those are drawn as dots and lines; words
//! are words. It is dark where the reader's page is, and light elsewhere.

use std::collections::BTreeMap;
use std::fmt::Write;

use ratatui::buffer::{Buffer, Cell};
use ratatui::style::{Color, Modifier};

/// Of a character: width and height. Its braille dots are then as far apart across as along.
const CELL: [u32; 2] = [8, 16];

/// About the characters, and above them for the window's title.
const MARGIN: u32 = 12;
const TITLE: u32 = 30;

const STYLE: &str = "\
svg{--paper:#ffffff;--bar:#e9ecef;--edge:#ced4da;--ink:#24292f;--red:#cf222e;--green:#116329;--magenta:#8250df;--cyan:#1b7c83;--blue:#0969da;--grey:#8c959f}\
@media (prefers-color-scheme:dark){svg{--paper:#0d1117;--bar:#161b22;--edge:#30363d;--ink:#e6edf3;--red:#ff7b72;--green:#56d364;--magenta:#d2a8ff;--cyan:#56d4dd;--blue:#79c0ff;--grey:#6e7681}}\
text{font:13px ui-monospace,SFMono-Regular,Menlo,Consolas,'DejaVu Sans Mono',monospace;white-space:pre}\
path{fill:none}.dots{stroke-width:2.6;stroke-linecap:round}.frames{stroke-width:1}.bold{font-weight:700}.dim{opacity:.62}";

/// The picture.
pub fn picture(buffer: &Buffer, title: &str) -> String {
    let area = buffer.area;
    let width = u32::from(area.width) * CELL[0] + 2 * MARGIN;
    let height = u32::from(area.height) * CELL[1] + 2 * MARGIN + TITLE;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" role=\"img\">\n\
         <title>{title}</title>\n<style>{STYLE}</style>\n\
         <rect x=\".5\" y=\".5\" width=\"{}\" height=\"{}\" rx=\"9\" fill=\"var(--paper)\" stroke=\"var(--edge)\"/>\n\
         <path d=\"M1 {TITLE}V9.5A8.5 8.5 0 0 1 9.5 1H{}a8.5 8.5 0 0 1 8.5 8.5V{TITLE}z\" style=\"fill:var(--bar)\"/>\n\
         <text x=\"{}\" y=\"20\" text-anchor=\"middle\" fill=\"var(--grey)\">{title}</text>\n",
        width - 1,
        height - 1,
        f64::from(width) - 9.5,
        width / 2,
    );
    let mut dots: BTreeMap<&str, String> = BTreeMap::new();
    let mut frames: BTreeMap<(&str, bool), String> = BTreeMap::new();
    for y in 0..area.height {
        for x in 0..area.width {
            let cell = &buffer[(x, y)];
            let [left, top] = place(x, y);
            let symbol = cell.symbol().chars().next().unwrap_or(' ');
            if let Some(bits) = braille(symbol) {
                let path = dots.entry(colour(cell.fg)).or_default();
                dot_by_dot(path, bits, left, top);
            } else if let Some(line) = frame(symbol) {
                let dim = cell.modifier.contains(Modifier::DIM);
                let path = frames.entry((colour(cell.fg), dim)).or_default();
                let _ = write!(path, "M{left} {top}{line}");
            }
        }
    }
    for (ink, path) in dots {
        let _ = writeln!(
            svg,
            "<path class=\"dots\" stroke=\"var(--{ink})\" d=\"{path}\"/>"
        );
    }
    for ((ink, dim), path) in frames {
        let dim = if dim { " dim" } else { "" };
        let _ = writeln!(
            svg,
            "<path class=\"frames{dim}\" stroke=\"var(--{ink})\" d=\"{path}\"/>"
        );
    }
    words(buffer, &mut svg);
    svg.push_str("</svg>\n");
    svg
}

fn place(x: u16, y: u16) -> [u32; 2] {
    [
        u32::from(x) * CELL[0] + MARGIN,
        u32::from(y) * CELL[1] + MARGIN + TITLE,
    ]
}

/// Which dots, as Unicode counts them.
fn braille(symbol: char) -> Option<u32> {
    let bits = u32::from(symbol).checked_sub(0x2800)?;
    (bits < 0x100).then_some(bits)
}

fn dot_by_dot(path: &mut String, bits: u32, left: u32, top: u32) {
    /// Column and row of each bit.
    const PLACES: [[u32; 2]; 8] = [
        [0, 0],
        [0, 1],
        [0, 2],
        [1, 0],
        [1, 1],
        [1, 2],
        [0, 3],
        [1, 3],
    ];
    for (bit, [column, row]) in PLACES.into_iter().enumerate() {
        if bits >> bit & 1 == 1 {
            // Nothing long, but with round ends.
            let _ = write!(path, "M{} {}h0", left + 2 + 4 * column, top + 2 + 4 * row);
        }
    }
}

/// From the upper left of a character, the lines of a frame.
fn frame(symbol: char) -> Option<&'static str> {
    Some(match symbol {
        '─' => "m0 8h8",
        '│' => "m4 0v16",
        '╭' => "m4 16v-4q0-4 4-4",
        '╮' => "m0 8q4 0 4 4v4",
        '╰' => "m4 0v4q0 4 4 4",
        '╯' => "m0 8q4 0 4-4v-4",
        _ => return None,
    })
}

/// Whatever else there is, in runs of one look.
fn words(buffer: &Buffer, svg: &mut String) {
    let area = buffer.area;
    for y in 0..area.height {
        let mut x = 0;
        while x < area.width {
            let look = &buffer[(x, y)];
            let run: String = (x..area.width)
                .map(|x| &buffer[(x, y)])
                .take_while(|cell| is_word(cell) && looks_like(cell, look))
                .map(Cell::symbol)
                .collect();
            let length = run.chars().count().max(1);
            let text = run.trim();
            if !text.is_empty() {
                let indent = run.chars().take_while(|letter| *letter == ' ').count();
                let [left, top] = place(x, y);
                let left = left + indent as u32 * CELL[0];
                let wide = text.chars().count() as u32 * CELL[0];
                let _ = writeln!(
                    svg,
                    "<text x=\"{left}\" y=\"{}\" textLength=\"{wide}\"{} fill=\"var(--{})\">{}</text>",
                    top + 12,
                    class(look.modifier),
                    colour(look.fg),
                    escaped(text)
                );
            }
            x += length as u16;
        }
    }
}

fn is_word(cell: &Cell) -> bool {
    let symbol = cell.symbol().chars().next().unwrap_or(' ');
    braille(symbol).is_none() && frame(symbol).is_none()
}

fn looks_like(cell: &Cell, other: &Cell) -> bool {
    cell.fg == other.fg && cell.modifier == other.modifier
}

fn class(modifier: Modifier) -> &'static str {
    if modifier.contains(Modifier::BOLD) {
        " class=\"bold\""
    } else if modifier.contains(Modifier::DIM) {
        " class=\"dim\""
    } else {
        ""
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

/// Name of a colour of the style above.
fn colour(colour: Color) -> &'static str {
    match colour {
        Color::Red => "red",
        Color::Green => "green",
        Color::Magenta => "magenta",
        Color::Cyan => "cyan",
        Color::LightBlue => "blue",
        Color::DarkGray => "grey",
        _ => "ink",
    }
}
