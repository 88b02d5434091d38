//! Where a stream comes from: a serial port, the emulated board, a recording.
//!
//! Each runs in a thread of its own, tells what happens as [`Event`]s and is told what to do by
//! [`Order`]s. A source that is not there is waited for; one that goes is waited for again.

pub mod emulated;

pub mod port;

pub mod replay;

use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use crate::failure::Failure;
pub use emulated::Emulation;
pub use replay::Replay;

/// Which source.
#[derive(Clone, Debug, PartialEq)]
pub enum Choice {
    /// The board on this serial port, `tcp:HOST:PORT` included; without a name the one board there is.
    Port(Option<String>),
    /// The emulated board.
    Emulated(Emulation),
    /// A recording, as it came.
    Replay(Replay),
}

/// What a source is, for those who treat them differently.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A serial port or what stands for one.
    Port,
    /// The emulated board.
    Emulated,
    /// A recording.
    Replay,
}

impl Choice {
    /// What it is.
    pub fn kind(&self) -> Kind {
        match self {
            Self::Port(_) => Kind::Port,
            Self::Emulated(_) => Kind::Emulated,
            Self::Replay(_) => Kind::Replay,
        }
    }
}

/// What happens at a source.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// It is there; its name.
    Connected(String),
    /// It is not there (yet): why, and what to do.
    Waiting(Failure),
    /// It was there, and is gone; it is looked for again.
    Lost(Failure),
    /// Bytes of the stream.
    Bytes {
        /// When they came, in s on the source's clock.
        at: f64,
        /// In whatever chunks.
        bytes: Vec<u8>,
    },
    /// How the emulated sensor really stands.
    Truth(Truth),
    /// Nothing more will come: the end of a recording, or what makes it pointless to wait.
    Ended(Result<(), Failure>),
}

/// How the emulated sensor really stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Device time (s).
    pub time: f64,
    /// Body to world, y up: w, x, y, z.
    pub orientation: [f64; 4],
}

/// What a source can be asked to do. One that cannot, does not.
#[derive(Clone, Debug, PartialEq)]
pub enum Order {
    /// Send this to the board.
    Send(Vec<u8>),
    /// Start the emulated board again with its sensor carried through another motion.
    Motion(String),
    /// Turn the emulated sensor there, if its motion is `hand`: body to world, w, x, y, z.
    Turn([f64; 4]),
    /// Pull the emulated board's plug, or put it back.
    Plug(bool),
}

/// Where a source tells what happens.
pub struct Listener {
    tell: Box<dyn FnMut(Event) -> bool + Send>,
    orders: Receiver<Order>,
}

/// Nobody listens any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gone;

impl Listener {
    /// Tells it.
    ///
    /// # Errors
    ///
    /// [`Gone`]: the source ends.
    pub fn tell(&mut self, event: Event) -> Result<(), Gone> {
        if (self.tell)(event) {
            Ok(())
        } else {
            Err(Gone)
        }
    }

    /// An order, if there is one.
    ///
    /// # Errors
    ///
    /// [`Gone`]: the source ends.
    pub fn order(&self) -> Result<Option<Order>, Gone> {
        match self.orders.try_recv() {
            Ok(order) => Ok(Some(order)),
            Err(mpsc::TryRecvError::Empty) => Ok(None),
            Err(mpsc::TryRecvError::Disconnected) => Err(Gone),
        }
    }

    /// An order, if there is one within this time.
    ///
    /// # Errors
    ///
    /// [`Gone`]: the source ends.
    pub fn order_within(&self, span: Duration) -> Result<Option<Order>, Gone> {
        match self.orders.recv_timeout(span) {
            Ok(order) => Ok(Some(order)),
            Err(mpsc::RecvTimeoutError::Timeout) => Ok(None),
            Err(mpsc::RecvTimeoutError::Disconnected) => Err(Gone),
        }
    }

    /// Waits so long, or until nobody listens; orders that come meanwhile are for nobody.
    ///
    /// # Errors
    ///
    /// [`Gone`]: the source ends.
    pub fn wait(&self, span: Duration) -> Result<(), Gone> {
        let until = Instant::now() + span;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            match self.orders.recv_timeout(left) {
                Ok(_) => {}
                Err(mpsc::RecvTimeoutError::Timeout) => return Ok(()),
                Err(mpsc::RecvTimeoutError::Disconnected) => return Err(Gone),
            }
        }
    }
}

/// What a source may take for the orders it has when it is left: as long as a board may take for them.
const LAST_ORDERS: Duration = Duration::from_millis(1500);

/// A source at work; it ends when this is dropped.
#[derive(Debug)]
pub struct Source {
    orders: Option<Sender<Order>>,
    thread: Option<JoinHandle<()>>,
}

impl Source {
    /// Starts it. `tell` says whether anybody still listens.
    pub fn start(choice: Choice, tell: impl FnMut(Event) -> bool + Send + 'static) -> Self {
        let (orders, received) = mpsc::channel();
        let mut listener = Listener {
            tell: Box::new(tell),
            orders: received,
        };
        let thread = thread::spawn(move || {
            let _gone = match choice {
                Choice::Port(name) => port::run(name.as_deref(), &mut listener),
                Choice::Emulated(emulation) => emulated::run(emulation, &mut listener),
                Choice::Replay(replay) => replay::run(&replay, &mut listener),
            };
        });
        Self {
            orders: Some(orders),
            thread: Some(thread),
        }
    }

    /// Gives it an order.
    pub fn order(&self, order: Order) {
        if let Some(orders) = &self.orders {
            // A source that has ended has told so.
            let _ = orders.send(order);
        }
    }
}

impl Drop for Source {
    fn drop(&mut self) {
        // Without anybody to give orders it ends, once it has carried out those it has.
        self.orders = None;
        let until = Instant::now() + LAST_ORDERS;
        if let Some(thread) = self.thread.take() {
            // One that builds an image just now is not waited for.
            while !thread.is_finished() && Instant::now() < until {
                thread::sleep(Duration::from_millis(2));
            }
        }
    }
}
