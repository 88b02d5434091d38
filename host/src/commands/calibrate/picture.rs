//! The map as a picture: what was seen as dots, what is missing as crosses.

use std::fmt::Write;

use super::map::{Map, angles};

/// Two pixels to a degree, and what is written around the map.
const SCALE: f32 = 2.0;
const LEFT: f32 = 60.0;
const TOP: f32 = 44.0;
const WIDTH: f32 = 360.0 * SCALE + LEFT + 20.0;
const HEIGHT: f32 = 180.0 * SCALE + TOP + 56.0;

/// The picture.
pub fn svg(map: &Map, title: &str) -> String {
    let mut svg = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="12">
<rect width="100%" height="100%" fill="#fff"/>
<text x="{LEFT}" y="24" font-size="15" fill="#111">{title}</text>
"##
    );
    // Into a string nothing fails.
    let _ = grid(&mut svg);
    let _ = marks(&mut svg, map);
    svg.push_str("</svg>\n");
    svg
}

/// Where a direction lies.
fn place([about, above]: [f32; 2]) -> [f32; 2] {
    [LEFT + (about + 180.0) * SCALE, TOP + (90.0 - above) * SCALE]
}

fn grid(svg: &mut String) -> std::fmt::Result {
    for about in (-180..=180).step_by(45) {
        let [x, y] = place([about as f32, 90.0]);
        let below = y + 180.0 * SCALE;
        writeln!(
            svg,
            r##"<path d="M{x} {y}V{below}" stroke="#ddd"/><text x="{x}" y="{}" text-anchor="middle" fill="#555">{about}°</text>"##,
            below + 18.0
        )?;
    }
    for above in (-90..=90).step_by(45) {
        let [x, y] = place([-180.0, above as f32]);
        writeln!(
            svg,
            r##"<path d="M{x} {y}H{}" stroke="#ddd"/><text x="{}" y="{}" text-anchor="end" fill="#555">{above}°</text>"##,
            x + 360.0 * SCALE,
            x - 8.0,
            y + 4.0
        )?;
    }
    let [x, y] = place([0.0, -90.0]);
    writeln!(
        svg,
        r##"<text x="{x}" y="{}" text-anchor="middle" fill="#555">where the field comes from: about the board's y, from z towards x; up: above its x-z plane</text>"##,
        y + 40.0
    )
}

fn marks(svg: &mut String, map: &Map) -> std::fmt::Result {
    for seen in map.seen() {
        let [x, y] = place(angles(seen));
        writeln!(
            svg,
            r##"<circle cx="{x:.1}" cy="{y:.1}" r="1.5" fill="#1668b8" fill-opacity="0.6"/>"##
        )?;
    }
    for missing in map.missing() {
        let [x, y] = place(angles(&missing));
        writeln!(
            svg,
            r##"<path d="M{x:.1} {y:.1}m-6 -6l12 12m0 -12l-12 12" stroke="#c1272d" stroke-width="2"/>"##
        )?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{Map, svg};
    use nalgebra::Vector3;

    #[test]
    fn what_was_seen_is_a_dot_and_what_is_missing_a_cross() {
        let map = Map::of([Vector3::z(), Vector3::x()].into_iter());
        let picture = svg(&map, "two");
        // z in the middle, x a quarter of the way round to the right.
        assert!(picture.contains(r#"<circle cx="420.0" cy="224.0""#));
        assert!(picture.contains(r#"<circle cx="600.0" cy="224.0""#));
        let crosses = picture.matches("m-6 -6").count();
        assert_eq!(crosses, map.missing().len());
        assert!((60..96).contains(&crosses), "{crosses}");
    }
}
