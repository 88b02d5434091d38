//! The pictures of the page in the README, from the running program.

use std::io::Cursor;
use std::path::Path;

use libtest_mimic::Failed;
use png::{Compression, Decoder, Encoder, Filter};

use super::chromium::Chromium;
use super::moving::START;
use super::server::Server;
use super::tab::Size;

/// Bytes of a picture: large enough to read, small enough to keep. The moment makes a tenth of it.
const LARGEST: usize = 300_000;

pub fn for_the_readme(chromium: &Chromium) -> Result<(), Failed> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = match std::env::var_os("VRDUINO_PICTURES") {
        // Tests run in their package's folder, and people in the workspace's.
        Some(folder) => root.join(folder),
        None => super::tab::pictures(),
    };
    std::fs::create_dir_all(&folder)?;
    let program = Server::view(&["--emulate"]);
    for (name, size, theme, mode) in [
        ("page.png", Size::DESK, "dark", "board"),
        ("stereo.png", Size::DESK, "light", "stereo"),
        ("phone.png", Size::PHONE, "dark", "board"),
    ] {
        let mut tab = chromium.open_as(&program.url(), size, "")?;
        tab.theme(theme)?;
        tab.eval(&format!("document.getElementById('view-{mode}').click()"))?;
        // The charts are full, and the head is turned.
        tab.until("ten seconds have come", "vrduino.count > 10500", START)?;
        let turned = "((yaw, pitch) => Math.abs(yaw) > 8 && Math.abs(yaw) < 30 && pitch < -3 && pitch > -20)(...vrduino.angles)";
        tab.until("the head is turned", turned, 60)?;
        let png = smaller(&tab.png()?)?;
        if png.len() > LARGEST {
            return Err(format!("{name} has {} bytes", png.len()).into());
        }
        std::fs::write(folder.join(name), png)?;
        tab.close()?;
    }
    Ok(())
}

/// Half as large. The last bit of a colour is the dithering of the backgrounds, which nobody sees and
/// nothing compresses; what is left are rows that repeat, better without a filter.
fn smaller(png: &[u8]) -> Result<Vec<u8>, Failed> {
    let mut reader = Decoder::new(Cursor::new(png)).read_info()?;
    let size = reader.output_buffer_size().ok_or("a picture of no size")?;
    let mut pixels = vec![0; size];
    let info = reader.next_frame(&mut pixels)?;
    pixels
        .iter_mut()
        .for_each(|value| *value = *value & !1 | *value >> 7);
    let mut written = Vec::new();
    let mut encoder = Encoder::new(&mut written, info.width, info.height);
    encoder.set_color(info.color_type);
    encoder.set_depth(info.bit_depth);
    encoder.set_compression(Compression::High);
    encoder.set_filter(Filter::NoFilter);
    encoder.write_header()?.write_image_data(&pixels)?;
    Ok(written)
}
