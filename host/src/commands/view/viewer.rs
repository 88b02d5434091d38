//! One page that looks on: what it is told, and what is done for it.

use std::thread;
use std::time::{Duration, Instant};

use tungstenite::Message;

use super::messages::{self, Asked, BATCH};
use crate::hub::{Hold, Hub, State, Subscription, Update};
use crate::source::{Choice, Emulation, Kind, Order};
use crate::stream::{Item, Sample};
use crate::web::server::Server;
use crate::web::websocket::{Over, Socket};

/// Between two batches of samples: shorter than a picture of any screen.
const BATCHES: Duration = Duration::from_millis(8);

/// How long the page's own words wait at most while the board says nothing.
const LOOK: Duration = Duration::from_millis(20);

/// Updates that wait for a slow page: about two seconds of the fastest stream.
const HOLD: usize = 4000;

/// Messages that are taken at a time, and sent at a time.
const MESSAGES: usize = 16;

/// A page.
pub struct Viewer<'a> {
    hub: &'a Hub,
    choice: &'a Choice,
    socket: Socket,
    updates: Subscription,
    /// What goes out next, in the order in which it came,
    messages: Vec<Message>,
    /// and behind it these.
    samples: Vec<Sample>,
}

impl<'a> Viewer<'a> {
    pub fn new(hub: &'a Hub, choice: &'a Choice, socket: Socket) -> Self {
        Self {
            hub,
            choice,
            socket,
            updates: hub.subscribe(Hold::Newest(HOLD)),
            messages: Vec::new(),
            samples: Vec::new(),
        }
    }

    /// Until the page leaves, takes nothing any more, or the server ends.
    pub fn run(mut self, server: &Server) {
        while !server.is_ending() {
            if self.turn().is_err() {
                return;
            }
        }
        self.socket.close("vrduino view has ended");
    }

    fn turn(&mut self) -> Result<(), Over> {
        let began = Instant::now();
        for _ in 0..MESSAGES {
            match self.socket.receive()? {
                Some(message) => self.hear(&message),
                None => break,
            }
        }
        // What a page does not take waits in its queue, where the oldest is dropped and counted.
        if self.socket.is_clear()? {
            self.gather();
            self.pass_on()?;
        }
        thread::sleep(BATCHES.saturating_sub(began.elapsed()));
        Ok(())
    }

    fn gather(&mut self) {
        let mut patience = LOOK;
        while let Some(update) = self.updates.next(patience) {
            patience = Duration::ZERO;
            self.take(&update);
            if self.messages.len() >= MESSAGES || self.samples.len() >= BATCH {
                break;
            }
        }
    }

    fn take(&mut self, update: &Update) {
        match update {
            Update::Stream(items) => {
                for item in items.iter() {
                    match item {
                        Item::Sample(sample) => self.samples.push(*sample),
                        Item::Line(line) => self.add(messages::line(line)),
                        Item::Registers(_) => {}
                    }
                }
            }
            Update::Truth(truth) => self.add(messages::truth(truth)),
            Update::Status(status) => {
                let dropped = self.updates.dropped();
                self.add(messages::status(status, dropped));
            }
            // The status has told it.
            Update::Ended(_) | Update::Bytes(_) => {}
        }
    }

    /// Behind the samples that came before.
    fn add(&mut self, text: String) {
        self.seal();
        self.messages.push(Message::Text(text.into()));
    }

    fn seal(&mut self) {
        for samples in self.samples.chunks(BATCH) {
            let batch = messages::batch(samples);
            self.messages.push(Message::Binary(batch.into()));
        }
        self.samples.clear();
    }

    fn pass_on(&mut self) -> Result<(), Over> {
        self.seal();
        for message in self.messages.drain(..) {
            self.socket.send(message)?;
        }
        Ok(())
    }

    fn hear(&mut self, message: &str) {
        let refused = match messages::understand(message) {
            Ok(asked) => self.act(asked).err().map(Into::into),
            Err(line) => Some(line),
        };
        if let Some(line) = refused {
            self.add(messages::line(&line));
        }
    }

    /// Does it, or says in a line why not.
    fn act(&self, asked: Asked) -> Result<(), &'static str> {
        let status = self.hub.status();
        let is_emulated = status.kind == Some(Kind::Emulated);
        match asked {
            Asked::Line(_) | Asked::Key(_) if status.state != State::Connected => {
                return Err("error: not sent: no board is connected");
            }
            Asked::Line(line) => self.hub.say(&line),
            Asked::Key(key) => self.hub.press(&[key]),
            Asked::Emulate if is_emulated && status.state != State::Ended => {}
            Asked::Emulate if status.state == State::Connected => {
                return Err(
                    "error: a board is connected: unplug it before you take the emulated one",
                );
            }
            Asked::Emulate => self.hub.switch(self.emulation()),
            Asked::Stop if is_emulated => self.hub.switch(self.after_emulation()),
            Asked::Motion(name) if is_emulated => {
                // Not any file of this computer's: only what has been offered.
                if !status.motions.contains(&name.as_str()) {
                    return Err("error: the emulated board has no such motion");
                }
                self.hub.order(Order::Motion(name));
            }
            Asked::Turn(orientation) if is_emulated => self.hub.order(Order::Turn(orientation)),
            Asked::Unplug(unplug) if is_emulated => self.hub.order(Order::Plug(!unplug)),
            Asked::Stop | Asked::Motion(_) | Asked::Turn(_) | Asked::Unplug(_) => {
                return Err("error: only the emulated board can do that");
            }
        }
        Ok(())
    }

    /// The emulated board that was asked for, or the usual one.
    fn emulation(&self) -> Choice {
        match self.choice {
            Choice::Emulated(emulation) => Choice::Emulated(emulation.clone()),
            _ => Choice::Emulated(Emulation::default()),
        }
    }

    /// The port that was asked for, or any.
    fn after_emulation(&self) -> Choice {
        match self.choice {
            Choice::Port(port) => Choice::Port(port.clone()),
            _ => Choice::Port(None),
        }
    }
}
