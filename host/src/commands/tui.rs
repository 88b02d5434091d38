//! `vrduino tui`: the board in a terminal.

use std::env;
use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use clap::Args;
use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event};

use crate::arguments::SourceArguments;
use crate::failure::{Failure, Kind};
use crate::hub::{Hold, Hub, Subscription};
use crate::interrupt::Interrupt;
use crate::tui::draw::draw;
use crate::tui::keys::{Wish, press};
use crate::tui::model::Model;

/// Between two pictures.
const PICTURE: Duration = Duration::from_millis(40);

/// Updates that are taken between two pictures: many more than a stream has.
const AT_ONCE: usize = 4096;

/// What is asked for.
#[derive(Clone, Debug, Args)]
#[command(after_help = "\
Keys: r ahead, b bias, e estimator, + and - its weight, v stereo, h head and neck, m board turned round, p pause, n next motion \
and u plug of the emulated board, arrows turn it if its motion is hand, ? explains them, q quits.

Examples:
  vrduino tui                            the board that is plugged in
  vrduino tui --emulate --motion hand    the emulated one, turned by the arrow keys
  vrduino tui --replay FILE              a recording")]
pub struct Arguments {
    /// Where from.
    #[command(flatten)]
    pub source: SourceArguments,
}

/// Shows it until the user has seen enough.
///
/// # Errors
///
/// There is no terminal to draw in.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if !(io::stdout().is_terminal() && io::stdin().is_terminal() && can_draw()) {
        return Err(Failure::new(
            Kind::Computer,
            "tui draws in a terminal and takes its keys from there, and this is none: `vrduino monitor` prints lines wherever it is",
        ));
    }
    let interrupt = Interrupt::listen();
    let hub = Hub::start(arguments.source.choice(), Some("binary"));
    let updates = hub.subscribe(Hold::Newest(AT_ONCE));
    // Given back before the hub has ended, which may take the source a while.
    let mut screen = Screen::open()?;
    show(&mut screen.0, &hub, &updates, &interrupt).map_err(|error| lost(&error))
}

/// One that only prints says so, where a terminal says what it is.
fn can_draw() -> bool {
    let name = env::var("TERM").unwrap_or_default();
    cfg!(windows) || !matches!(name.as_str(), "" | "dumb")
}

/// The terminal, which is given back as it was, however this ends; a panic gives it back by ratatui's hook.
struct Screen(DefaultTerminal);

impl Screen {
    fn open() -> Result<Self, Failure> {
        ratatui::try_init().map(Self).map_err(|error| lost(&error))
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        // Where it cannot be given back there is nobody left to be told.
        let _ = ratatui::try_restore();
    }
}

fn lost(error: &io::Error) -> Failure {
    Failure::new(
        Kind::Computer,
        format!("the terminal cannot be drawn on: {error}; `vrduino monitor` wants less of it"),
    )
}

fn show(
    terminal: &mut DefaultTerminal,
    hub: &Hub,
    updates: &Subscription,
    interrupt: &Interrupt,
) -> io::Result<()> {
    let mut model = Model::new();
    while !interrupt.has_come() {
        for _ in 0..AT_ONCE {
            match updates.next(Duration::ZERO) {
                Some(update) => model.take(&update),
                None => break,
            }
        }
        terminal.draw(|frame| draw(frame, &model))?;
        let next = Instant::now() + PICTURE;
        while event::poll(next.saturating_duration_since(Instant::now()))? {
            if let Event::Key(key) = event::read()?
                && let Some(wish) = press(&mut model, key)
            {
                match wish {
                    Wish::Press(key) => hub.press(&[key]),
                    Wish::Say(line) => hub.say(&line),
                    Wish::Order(order) => hub.order(order),
                    Wish::Switch(choice) => hub.switch(choice),
                    Wish::Quit => return Ok(()),
                }
            }
            if Instant::now() >= next {
                break;
            }
        }
    }
    Ok(())
}
