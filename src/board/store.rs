//! Keeps a few bytes over power cycles, in the last 512 bytes of the chip's EEPROM.
//!
//! A Teensyduino sketch's EEPROM library begins at address 0, so what a sketch keeps in the first 1536
//! bytes is left alone, and outlives us.
//!
//! There are two slots, and a save goes into the one that is not the newest whole one. Without power in
//! the middle of it, or with a word half written, its checksum is wrong and the other slot still holds
//! what was kept before. One slot with a checksum would be refused as well, but would leave nothing.
//!
//! A save is done a word at a time, one in each turn of the main program: nothing waits, no sample is
//! late and the watchdog is fed as always. A record of 140 bytes takes 38 turns at most. Words that are
//! right already are not written, for each write wears the EEPROM.

mod eeprom;
mod slot;

use core::fmt;

use mk20dx_hal::pac;

use eeprom::Eeprom;
pub use slot::CAPACITY;
use slot::Slot;

/// Turns of the main program may be late, and now and then a word takes an erased sector; after this
/// long it will not come any more.
const WORD_MS: u32 = 200;

/// Why bytes could not be kept, or found again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreError {
    /// FlexNVM is partitioned for something else, or for less.
    NoRoom,
    /// Making the EEPROM did not end in the life before.
    Hung,
    /// The EEPROM does not get ready.
    NotReady,
    /// A command or a word was refused, with these flags in FSTAT.
    Refused(u8),
    /// What was written reads back otherwise.
    NotKept,
    /// Nothing was ever kept.
    Empty,
    /// What is there is damaged, or somebody else's.
    Damaged,
    /// So many bytes do not fit.
    TooLong(usize),
    /// A save is under way.
    Busy,
}

impl fmt::Display for StoreError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoRoom => f.write_str("FlexNVM is partitioned otherwise: erase the whole chip"),
            Self::Hung => f.write_str("making the EEPROM hung: switch the board off and on"),
            Self::NotReady => {
                f.write_str("the EEPROM does not answer: switch the board off and on")
            }
            Self::Refused(flags) => write!(f, "the EEPROM refuses (FSTAT {flags:#04x})"),
            Self::NotKept => f.write_str("the EEPROM is worn out: it reads back otherwise"),
            Self::Empty => f.write_str("nothing kept yet"),
            Self::Damaged => f.write_str("what was kept is damaged: calibrate again"),
            Self::TooLong(bytes) => write!(f, "{bytes} bytes, and {CAPACITY} fit"),
            Self::Busy => f.write_str("still at the one before"),
        }
    }
}

/// What was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Loaded {
    /// Bytes of it.
    pub length: usize,
    /// Whether there was something else that is damaged: most likely a newer save without power.
    pub other_damaged: bool,
}

/// The store.
pub struct Store {
    eeprom: Result<Eeprom, StoreError>,
    saving: Option<Saving>,
}

impl Store {
    /// Gets the EEPROM ready. On a chip that never had one it is made first, if `may_partition`: that
    /// takes 70 ms, in which no interrupt comes through. To be called when the clocks have been set and
    /// nothing else has started.
    pub fn new(registers: pac::Ftfl, sim: &pac::Sim, may_partition: bool) -> Store {
        let eeprom = Eeprom::new(registers, sim, may_partition).and_then(|eeprom| {
            if eeprom.length() >= 2 * slot::LENGTH {
                Ok(eeprom)
            } else {
                Err(StoreError::NoRoom)
            }
        });
        Store {
            eeprom,
            saving: None,
        }
    }

    /// Copies what was kept last to the beginning of `bytes`.
    pub fn load(&mut self, bytes: &mut [u8]) -> Result<Loaded, StoreError> {
        let slots = Slots::read(self.ready()?);
        let Some(newest) = slots.newest() else {
            let blank = slots.0.iter().all(Slot::is_blank);
            return Err(if blank {
                StoreError::Empty
            } else {
                StoreError::Damaged
            });
        };
        let content = slots.0[newest].content().ok_or(StoreError::Damaged)?;
        let other = &slots.0[1 - newest];
        bytes
            .get_mut(..content.len())
            .ok_or(StoreError::TooLong(content.len()))?
            .copy_from_slice(content);
        Ok(Loaded {
            length: content.len(),
            other_damaged: !other.is_blank() && other.number().is_none(),
        })
    }

    /// Begins to keep `bytes`; [`serve`](Self::serve) does it, and tells when it is done.
    pub fn save(&mut self, bytes: &[u8]) -> Result<(), StoreError> {
        if bytes.len() > CAPACITY {
            return Err(StoreError::TooLong(bytes.len()));
        }
        let eeprom = self.ready()?;
        eeprom.clear();
        let slots = Slots::read(eeprom);
        let newest = slots.newest();
        let number = newest.and_then(|newest| slots.0[newest].number());
        // What is kept already is found so, word by word.
        let kept = newest.filter(|&newest| slots.0[newest].content() == Some(bytes));
        let (index, number) = match (kept, newest) {
            (Some(kept), _) => (kept, number.unwrap_or(0)),
            (None, Some(newest)) => (
                1 - newest,
                number.map_or(0, |number| number.saturating_add(1)),
            ),
            (None, None) => (0, 0),
        };
        self.saving = Some(Saving {
            start: Slots::start(eeprom, index),
            slot: Slot::new(number, bytes),
            done: 0,
            since: None,
        });
        Ok(())
    }

    /// Whether a save is under way.
    pub fn is_saving(&self) -> bool {
        self.saving.is_some()
    }

    /// Goes on with a save, if there is one, and tells how it ended. To be called once in each turn of
    /// the main program; `now` is in milliseconds.
    pub fn serve(&mut self, now: u32) -> Option<Result<(), StoreError>> {
        let (Ok(eeprom), Some(saving)) = (&mut self.eeprom, &mut self.saving) else {
            return None;
        };
        let end = saving.step(eeprom, now)?;
        self.saving = None;
        Some(end)
    }

    fn ready(&mut self) -> Result<&mut Eeprom, StoreError> {
        if self.saving.is_some() {
            return Err(StoreError::Busy);
        }
        match &mut self.eeprom {
            Ok(eeprom) if eeprom.is_ready() => Ok(eeprom),
            Ok(_) => Err(StoreError::NotReady),
            Err(error) => Err(*error),
        }
    }
}

/// Both slots, at the end of the EEPROM.
struct Slots([Slot; 2]);

impl Slots {
    fn read(eeprom: &Eeprom) -> Slots {
        Slots([0, 1].map(|index| {
            let start = Slots::start(eeprom, index);
            Slot::read(|n| eeprom.word(start + 4 * n))
        }))
    }

    fn start(eeprom: &Eeprom, index: usize) -> usize {
        eeprom.length() - (2 - index) * slot::LENGTH
    }

    fn newest(&self) -> Option<usize> {
        let numbers = [self.0[0].number(), self.0[1].number()];
        match numbers {
            [None, None] => None,
            [first, second] => Some(usize::from(second > first)),
        }
    }
}

/// A save that is under way.
struct Saving {
    start: usize,
    slot: Slot,
    /// Words that are right.
    done: usize,
    /// Since when the present word is waited for, in milliseconds.
    since: Option<u32>,
}

impl Saving {
    /// One word more, if the EEPROM is ready for it; the end, once it has come to it.
    fn step(&mut self, eeprom: &mut Eeprom, now: u32) -> Option<Result<(), StoreError>> {
        if !eeprom.is_ready() {
            let since = *self.since.get_or_insert(now);
            return (now.wrapping_sub(since) > WORD_MS).then_some(Err(StoreError::NotReady));
        }
        self.since = None;
        if let Err(refused) = eeprom.check() {
            return Some(Err(refused));
        }
        let words = self.slot.words();
        while self.done < words {
            // The checksum, which makes the rest valid, comes last.
            let n = (self.done + 1) % words;
            self.done += 1;
            if eeprom.word(self.start + 4 * n) != self.slot.word(n) {
                eeprom.write(self.start + 4 * n, self.slot.word(n));
                return None;
            }
        }
        let kept = (0..words).all(|n| eeprom.word(self.start + 4 * n) == self.slot.word(n));
        Some(if kept {
            Ok(())
        } else {
            Err(StoreError::NotKept)
        })
    }
}
