//! Makes README's picture of the terminal: what `vrduino tui --emulate` shows after some seconds, as SVG.
//!
//! ```console
//! $ cargo run -p vrduino-host --example terminal_picture
//! $ cargo run -p vrduino-host --example terminal_picture -- FILE 100x30 v
//! ```
//!
//! The second makes it elsewhere, of another size, after these keys were pressed. Nothing in it is made
//! up: the emulated board runs, and what is drawn goes to cells instead of a terminal.

mod svg;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use vrduino_host::hub::{Hold, Hub};
use vrduino_host::source::{Choice, Emulation};
use vrduino_host::tui::draw::draw;
use vrduino_host::tui::keys::{Wish, press};
use vrduino_host::tui::model::Model;

/// The picture is of this moment of the emulated board (s): the head has looked around for a while.
const MOMENT: f64 = 13.3;

/// How long that may take, the image to be built included.
const PATIENCE: Duration = Duration::from_secs(600);

fn main() -> ExitCode {
    match make(std::env::args().skip(1).collect()) {
        Ok(path) => {
            eprintln!("{}", path.display());
            ExitCode::SUCCESS
        }
        Err(sentence) => {
            eprintln!("terminal_picture: {sentence}");
            ExitCode::FAILURE
        }
    }
}

fn make(arguments: Vec<String>) -> Result<PathBuf, String> {
    let mut arguments = arguments.into_iter();
    let path = arguments.next().map_or_else(usual, PathBuf::from);
    let [width, height] = match arguments.next() {
        Some(text) => size(&text)?,
        None => [118, 38],
    };
    let keys = arguments.next().unwrap_or_default();
    let model = watch(&keys)?;
    let mut terminal = Terminal::new(TestBackend::new(width, height))
        .map_err(|error| format!("the cells cannot be drawn on: {error}"))?;
    terminal
        .draw(|frame| draw(frame, &model))
        .map_err(|error| format!("the cells cannot be drawn on: {error}"))?;
    let picture = svg::picture(terminal.backend().buffer(), "vrduino tui --emulate");
    std::fs::write(&path, picture)
        .map_err(|error| format!("{} cannot be written: {error}", path.display()))?;
    Ok(path)
}

fn usual() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/pictures/terminal.svg")
}

fn size(text: &str) -> Result<[u16; 2], String> {
    let parts = text.split_once('x');
    let numbers =
        parts.and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    numbers
        .filter(|size| size.iter().all(|side| (1..=500).contains(side)))
        .ok_or_else(|| format!("{text} is no size: give columns and rows, as 118x36"))
}

/// Runs the emulated board up to the moment.
fn watch(keys: &str) -> Result<Model, String> {
    let hub = Hub::start(Choice::Emulated(Emulation::default()), Some("binary"));
    let updates = hub.subscribe(Hold::All);
    let mut model = Model::new();
    let mut pressed = false;
    let until = Instant::now() + PATIENCE;
    while Instant::now() < until {
        if let Some(update) = updates.next(Duration::from_millis(100)) {
            model.take(&update);
        }
        let Some(sample) = model.sample else {
            continue;
        };
        if !pressed {
            pressed = true;
            for key in keys.chars() {
                let key = KeyEvent::new(KeyCode::Char(key), KeyModifiers::NONE);
                match press(&mut model, key) {
                    Some(Wish::Press(key)) => hub.press(&[key]),
                    Some(Wish::Say(line)) => hub.say(&line),
                    Some(Wish::Order(order)) => hub.order(order),
                    Some(Wish::Switch(_) | Wish::Quit) | None => {}
                }
            }
        }
        if sample.arrival >= MOMENT {
            return Ok(model);
        }
    }
    let status = hub.status();
    let trouble = status.trouble.as_ref().map(ToString::to_string);
    Err(trouble.unwrap_or_else(|| "the emulated board sends nothing".into()))
}
