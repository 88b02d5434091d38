//! The figure in pixels.

use plotters::prelude::{BitMapBackend, IntoDrawingArea};

use super::drawing::{Pieces, SIZE, draw};
use super::figure::Figure;
use crate::failure::{Failure, Kind};

/// Pixels of the picture to one of the sheet: 8 by 5.3 inches have 300 to the inch.
const SCALE: usize = 2;

/// It is drawn so many times as large and then made smaller, for smooth lines.
const SMOOTH: usize = 2;

/// Red, green, blue.
const CHANNELS: usize = 3;

/// As PNG.
pub fn png(figure: &Figure) -> Result<Vec<u8>, Failure> {
    let (width, height) = (SIZE.0 as usize * SCALE, SIZE.1 as usize * SCALE);
    let drawn = (width * SMOOTH, height * SMOOTH);
    let mut pixels = vec![0; drawn.0 * drawn.1 * CHANNELS];
    let size = (drawn.0 as u32, drawn.1 as u32);
    let sheet = BitMapBackend::with_buffer(&mut pixels, size).into_drawing_area();
    draw(figure, sheet, (SCALE * SMOOTH) as f64, Pieces::Steps)?;
    let pixels = shrink(&pixels, width, height);
    let encoded = encode(&pixels, width as u32, height as u32);
    encoded.map_err(|error| {
        Failure::new(
            Kind::Computer,
            format!("the picture cannot be made: {error}"),
        )
    })
}

/// Each pixel is the mean of those it was.
fn shrink(pixels: &[u8], width: usize, height: usize) -> Vec<u8> {
    let row = width * SMOOTH * CHANNELS;
    let mut small = Vec::with_capacity(width * height * CHANNELS);
    for y in 0..height {
        for x in 0..width {
            for channel in 0..CHANNELS {
                let first = y * SMOOTH * row + x * SMOOTH * CHANNELS + channel;
                let sum: usize = (0..SMOOTH)
                    .flat_map(|down| (0..SMOOTH).map(move |right| down * row + right * CHANNELS))
                    .map(|step| usize::from(pixels[first + step]))
                    .sum();
                small.push((sum / (SMOOTH * SMOOTH)) as u8);
            }
        }
    }
    small
}

fn encode(pixels: &[u8], width: u32, height: u32) -> Result<Vec<u8>, png::EncodingError> {
    /// 300 to the inch.
    const PER_METRE: u32 = 11_811;
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_pixel_dims(Some(png::PixelDimensions {
        xppu: PER_METRE,
        yppu: PER_METRE,
        unit: png::Unit::Meter,
    }));
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}
