//! The emulated board, in this very program: boots the image that is flashed, at the pace of a real one.

mod hand;

mod motions;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::ValueEnum;
use vrduino_emulator::board::{Board, Setup};
use vrduino_emulator::firmware::{self, BuildOptions};
use vrduino_emulator::image::Image;
use vrduino_emulator::motion::Motion;
use vrduino_emulator::mpu9250::Part;
use vrduino_emulator::time::{self, MILLISECOND, Ticks};

use super::{Event, Gone, Listener, Order, Truth};
use crate::failure::{Failure, Kind};
use hand::Hand;
pub use motions::NAMES as MOTIONS;

/// What it is called.
pub const NAME: &str = "emulated board";

/// Looks at what has come in a millisecond: as finely its arrival is known.
const STEPS: Ticks = 20;

/// Between two looks at how the sensor really stands.
const TRUTH: Ticks = 100 * MILLISECOND;

/// How the board is emulated.
#[derive(Clone, Debug, PartialEq)]
pub struct Emulation {
    /// What is flashed on it; the firmware of this repository if nothing is named.
    pub image: Option<PathBuf>,
    /// What the sensor is carried through: one of [`MOTIONS`], or a file.
    pub motion: String,
    /// The individual sensor.
    pub part: PartKind,
    /// Which of its kind, and which noise.
    pub seed: u64,
    /// As fast as a real board; else as fast as this computer allows.
    pub paced: bool,
}

/// How well a sensor was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum PartKind {
    /// No error but quantisation
    #[default]
    Perfect,
    /// Errors drawn within the data sheet's limits
    Typical,
    /// Errors at the data sheet's limits
    Worst,
}

impl Emulation {
    fn part(&self) -> Part {
        match self.part {
            PartKind::Perfect => Part::perfect(),
            PartKind::Typical => Part::typical(self.seed),
            PartKind::Worst => Part::worst(self.seed),
        }
    }
}

impl Default for Emulation {
    fn default() -> Self {
        Self {
            image: None,
            motion: MOTIONS[0].to_owned(),
            part: PartKind::default(),
            seed: 1,
            paced: true,
        }
    }
}

/// Builds the image and runs the board until nobody listens.
pub(super) fn run(mut emulation: Emulation, listener: &mut Listener) -> Result<(), Gone> {
    let mut hand = Hand::default();
    let started = prepare(&emulation, listener)?.and_then(|image| {
        let motion = motions::open(&emulation.motion, &hand)?;
        Ok((image, motion))
    });
    let (image, mut motion) = match started {
        Ok(started) => started,
        Err(failure) => return listener.tell(Event::Ended(Err(failure))),
    };
    loop {
        let mut session = Session::new(image.clone(), motion, hand, &emulation);
        let name = session.run(listener)?;
        // Asked for another motion: the board is switched off and on again.
        hand = Hand::default();
        motion = match motions::open(&name, &hand) {
            Ok(other) => {
                listener.tell(Event::Lost(Failure::new(
                    Kind::Board,
                    "the emulated board starts again with another motion",
                )))?;
                emulation.motion = name;
                other
            }
            Err(failure) => {
                listener.tell(Event::Waiting(failure))?;
                match motions::open(&emulation.motion, &hand) {
                    Ok(same) => same,
                    Err(failure) => return listener.tell(Event::Ended(Err(failure))),
                }
            }
        };
    }
}

/// The image, built if none was named.
fn prepare(emulation: &Emulation, listener: &mut Listener) -> Result<Result<Image, Failure>, Gone> {
    let path = match &emulation.image {
        Some(path) => path.clone(),
        None => {
            let sentence = if firmware::is_built() {
                "the emulated board is switched on"
            } else {
                "the board's image is being built, which takes a minute the first time"
            };
            listener.tell(Event::Waiting(Failure::new(Kind::Computer, sentence)))?;
            match firmware::build(BuildOptions { quiet: true }) {
                Ok(path) => path,
                Err(error) => return Ok(Err(Failure::new(Kind::Computer, error.to_string()))),
            }
        }
    };
    Ok(Image::open(&path).map_err(|error| Failure::new(Kind::File, error.to_string())))
}

/// One time between switching the board on and off.
struct Session {
    board: Board,
    motion: std::sync::Arc<dyn Motion>,
    hand: Hand,
    plugged: bool,
    /// Whether its port has been opened since it was last plugged in.
    open: bool,
    next_truth: Ticks,
    /// Wall and emulated time from which on it is held to real time, if it is.
    pace: Option<(Instant, Ticks)>,
}

impl Session {
    fn new(image: Image, motion: Box<dyn Motion>, hand: Hand, emulation: &Emulation) -> Self {
        let motion: std::sync::Arc<dyn Motion> = motion.into();
        let mut setup = Setup::new(Box::new(motions::Shared(motion.clone())));
        setup.part = emulation.part();
        Self {
            board: Board::new(image, setup),
            motion,
            hand,
            plugged: true,
            open: false,
            next_truth: 0,
            pace: emulation.paced.then(|| (Instant::now(), 0)),
        }
    }

    /// Runs until another motion is wanted: which.
    fn run(&mut self, listener: &mut Listener) -> Result<String, Gone> {
        loop {
            while let Some(order) = listener.order()? {
                match order {
                    Order::Send(bytes) => self.board.chip_quietly().host.send(&bytes),
                    Order::Motion(name) => return Ok(name),
                    Order::Turn(orientation) => self.hand.turn_to(orientation),
                    Order::Plug(plugged) => self.plug(plugged, listener)?,
                }
            }
            for _ in 0..STEPS {
                self.board.run(MILLISECOND / STEPS);
                self.pass_on(listener)?;
            }
            if let Some(stop) = self.board.stop() {
                let sentence = format!("the emulated board has stopped: {stop}");
                let failure = Failure::new(Kind::Stream, sentence);
                listener.tell(Event::Ended(Err(failure)))?;
                return Err(Gone);
            }
            self.keep_pace();
        }
    }

    fn plug(&mut self, plugged: bool, listener: &mut Listener) -> Result<(), Gone> {
        if plugged == self.plugged {
            return Ok(());
        }
        self.plugged = plugged;
        self.board.chip().host.set_plugged(plugged);
        if !plugged {
            self.open = false;
            let sentence = "the emulated board's plug is out: put it back";
            listener.tell(Event::Lost(Failure::new(Kind::Board, sentence)))?;
        }
        Ok(())
    }

    fn pass_on(&mut self, listener: &mut Listener) -> Result<(), Gone> {
        let now = self.board.now();
        let (open, bytes) = {
            let mut chip = self.board.chip_quietly();
            (chip.host.is_open(), chip.host.take_received())
        };
        if open && !self.open && self.plugged {
            self.open = true;
            listener.tell(Event::Connected(NAME.into()))?;
        }
        if !bytes.is_empty() {
            let at = time::seconds(now);
            listener.tell(Event::Bytes { at, bytes })?;
        }
        if now >= self.next_truth {
            self.next_truth = now + TRUTH;
            let time = time::seconds(now);
            if let Some(orientation) = self.motion.at(time).truth {
                listener.tell(Event::Truth(Truth { time, orientation }))?;
            }
        }
        Ok(())
    }

    /// Waits until real time has caught up with emulated time.
    fn keep_pace(&mut self) {
        let Some((wall, emulated)) = self.pace else {
            return;
        };
        let ran = Duration::from_secs_f64(time::seconds(self.board.now() - emulated));
        let ahead = ran.saturating_sub(wall.elapsed());
        if ahead.is_zero() {
            // Behind: do not make up for it later by running too fast.
            self.pace = Some((Instant::now(), self.board.now()));
        } else {
            std::thread::sleep(ahead);
        }
    }
}
