//! A recording, played as it came: what stands behind it cannot tell it from a board that listens to nobody.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use vrduino::wire;

use super::{Event, Gone, Listener, Order};
use crate::failure::Failure;
use crate::recording::{Batch, Entry, Format, Head, Player, encode};

/// Which recording, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// The file.
    pub path: PathBuf,
    /// So many times as fast as it came.
    pub speed: f64,
    /// When it is over it begins again.
    pub repeats: bool,
}

impl Replay {
    /// Once, as fast as it came.
    pub fn new(path: PathBuf) -> Self {
        Self {
            path,
            speed: 1.0,
            repeats: false,
        }
    }
}

/// Plays it.
pub(super) fn run(replay: &Replay, listener: &mut Listener) -> Result<(), Gone> {
    let mut end = 0.0;
    loop {
        let player = match Player::open(&replay.path, replay.speed) {
            Ok(player) => player,
            Err(failure) => return listener.tell(Event::Ended(Err(failure))),
        };
        listener.tell(Event::Connected(replay.path.display().to_string()))?;
        let mut performance = Performance {
            listener,
            replay,
            began: Instant::now(),
            now: end,
            ahead: None,
            sequence: None,
        };
        performance.introduce(player.head())?;
        match performance.play(player)? {
            // Nothing over and over again would take no time at all.
            Ok(()) if replay.repeats && performance.ahead.is_some() => end = performance.now,
            result => return listener.tell(Event::Ended(result)),
        }
    }
}

/// Once from the beginning to the end.
struct Performance<'a> {
    listener: &'a mut Listener,
    replay: &'a Replay,
    began: Instant,
    /// In s on this source's clock, which goes on when the recording is repeated.
    now: f64,
    /// By how much that clock is ahead of the recording's.
    ahead: Option<f64>,
    /// Of the latest sample, if it had one.
    sequence: Option<u16>,
}

impl Performance<'_> {
    /// What the board said it is, as it would say it.
    fn introduce(&mut self, head: &Head) -> Result<(), Gone> {
        let facts = [
            head.board.clone(),
            head.estimator
                .as_ref()
                .map(|name| format!("estimator {name}")),
            head.stream
                .as_ref()
                .map(|stream| format!("stream {stream}")),
        ];
        let settings = head.settings.iter();
        let settings = settings.map(|(name, value)| format!("{name} {value}"));
        for fact in facts.into_iter().flatten().chain(settings) {
            self.say(&format!("OK {fact}"))?;
        }
        Ok(())
    }

    fn play(&mut self, mut player: Player) -> Result<Result<(), Failure>, Gone> {
        loop {
            match player.next_batch() {
                Ok(Some(batch)) => self.pass_on(&batch)?,
                Ok(None) => break,
                Err(failure) => return Ok(Err(failure)),
            }
        }
        let farewell = player.farewell();
        self.say(&farewell)?;
        Ok(Ok(()))
    }

    fn pass_on(&mut self, batch: &Batch) -> Result<(), Gone> {
        self.wait(batch.due)?;
        let rows = || {
            batch.entries.iter().filter_map(|entry| match entry {
                Entry::Row(row) => Some(row.sample.sequence),
                Entry::Remark(_) => None,
            })
        };
        if let Some(first) = rows().next() {
            let is_new = self.ahead.is_none();
            let ahead = *self.ahead.get_or_insert(self.now - batch.at);
            // Unless the numbers tell that the board has started again, it was the connection.
            let goes_back = matches!((self.sequence, first), (Some(before), Some(now))
                if !(1..0x8000).contains(&now.wrapping_sub(before)));
            if batch.is_first && !is_new && !goes_back {
                let name = self.replay.path.display().to_string();
                self.listener.tell(Event::Connected(name))?;
            }
            self.now = batch.at + ahead;
        }
        self.sequence = rows().next_back().unwrap_or(self.sequence);
        let mut bytes = Vec::new();
        for entry in &batch.entries {
            encode(entry, Format::AsItCame, &mut bytes);
        }
        self.send(bytes)
    }

    /// Until so long after the beginning; whoever asks for something meanwhile is answered.
    fn wait(&mut self, due: Duration) -> Result<(), Gone> {
        loop {
            let left = due.saturating_sub(self.began.elapsed());
            match self.listener.order_within(left)? {
                Some(Order::Send(bytes)) => self.refuse(&bytes)?,
                Some(_) => {}
                None => return Ok(()),
            }
        }
    }

    /// A board answers every line.
    fn refuse(&mut self, bytes: &[u8]) -> Result<(), Gone> {
        let text = String::from_utf8_lossy(bytes);
        for line in text.lines().filter_map(|line| line.strip_prefix(':')) {
            let verb = line.split(' ').next().unwrap_or_default();
            self.say(&format!(
                "ERR {verb}: this is a recording, which cannot be told anything"
            ))?;
        }
        Ok(())
    }

    fn say(&mut self, text: &str) -> Result<(), Gone> {
        self.send(wire::text(text).as_bytes().to_vec())
    }

    fn send(&mut self, bytes: Vec<u8>) -> Result<(), Gone> {
        if bytes.is_empty() {
            return Ok(());
        }
        let at = self.now;
        self.listener.tell(Event::Bytes { at, bytes })
    }
}
