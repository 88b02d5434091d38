//! What a line that begins with a colon asks for: `:verb words`. `docs/commands.md` lists them all.

use core::fmt;
use heapless::String;

use super::number;
use crate::sampling::Lock;
use crate::wire::Decimals;

pub use super::setting::Setting;

/// A line understood.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Request {
    /// `:help`: which verbs there are.
    Help,
    /// `:version`.
    Version,
    /// `:estimator` asks, `:estimator default` and `:estimator notes` choose.
    Estimator(Option<Choice>),
    /// `:get NAME`.
    Get(Setting),
    /// `:set NAME VALUE`, in the setting's unit and range.
    Set(Setting, f32),
    /// `:defaults`: every setting as it was, the default estimator, the compass on.
    Defaults,
    /// `:compass` asks, `:compass auto`, `:compass on` and `:compass off` choose.
    Compass(Option<UseCompass>),
    /// `:compass adjustment`: how sensitive each axis of the magnetometer is.
    CompassAdjustment,
    /// `:calibration`: what is known of the sensor's faults.
    Calibration,
    /// `:keep AT HEX`: some bytes of a [`Record`](crate::calibration::record::Record).
    Keep(Piece),
    /// `:keep done`: they are all there; check, use and keep them.
    KeepDone,
    /// `:forget`: keep none.
    Forget,
    /// `:decimals` asks, `:decimals 3` to `:decimals 6` choose: of a quaternion in the stream.
    Decimals(Option<Decimals>),
    /// `:stream` asks, `:stream text`, `:stream timed`, `:stream binary` and `:stream counts` choose.
    Stream(Option<Format>),
    /// `:every` asks, `:every 1` to `:every 1000` choose: how many samples lead to one line or frame.
    Every(Option<u16>),
    /// `:bias`: what the gyro reads at rest, and how that is known.
    Bias,
    /// `:core` asks, `:core 72` and `:core 36` choose: the processor's clock in MHz.
    Core(Option<CoreClock>),
    /// `:lock` asks, `:lock sensor` and `:lock usb` choose: what decides when the sensor is read.
    Lock(Option<Lock>),
}

/// How the fused orientation is put on the wire.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Format {
    /// The course's line.
    #[default]
    Text,
    /// The same with a sequence number, the time and a checksum.
    Timed,
    /// A frame.
    Binary,
    /// A frame, and in the same packet one of the sensor's counts.
    Counts,
}

impl Format {
    /// As it is typed.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Timed => "timed",
            Self::Binary => "binary",
            Self::Counts => "counts",
        }
    }
}

/// Most samples a line or frame may stand for: a second.
const MOST_EVERY: u16 = 1000;

/// How fast the processor runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CoreClock {
    /// 72 MHz.
    #[default]
    Full,
    /// 36 MHz: the load doubles and the current falls.
    Half,
}

impl CoreClock {
    /// In MHz.
    pub const fn mhz(self) -> u32 {
        match self {
            Self::Full => 72,
            Self::Half => 36,
        }
    }
}

/// When the heading follows the magnetometer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UseCompass {
    /// If the board's iron is known from a calibration.
    #[default]
    Auto,
    /// Even so.
    On,
    /// Never.
    Off,
}

/// Most bytes of a record in one line.
const PIECE: usize = 24;

/// Some bytes of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece {
    at: u8,
    length: u8,
    bytes: [u8; PIECE],
}

impl Piece {
    /// From hexadecimal digits, two a byte, either case.
    fn parse(at: u8, digits: &str) -> Option<Self> {
        let (pairs, rest) = digits.as_bytes().as_chunks::<2>();
        if pairs.is_empty() || pairs.len() > PIECE || !rest.is_empty() {
            return None;
        }
        let mut bytes = [0; PIECE];
        for (byte, pair) in bytes.iter_mut().zip(pairs) {
            let [high, low] = pair.map(|digit| char::from(digit).to_digit(16));
            *byte = (high? << 4 | low?) as u8;
        }
        Some(Self {
            at,
            length: pairs.len() as u8,
            bytes,
        })
    }

    /// Where they belong.
    pub fn at(&self) -> usize {
        usize::from(self.at)
    }

    /// Themselves.
    pub fn bytes(&self) -> &[u8] {
        self.bytes
            .get(..usize::from(self.length))
            .unwrap_or_default()
    }
}

/// Which estimator makes the orientation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// [`Fusion`](crate::fusion::Fusion).
    #[default]
    Default,
    /// [`Complementary`](crate::orientation::complementary::Complementary), eq. 24 of the course notes.
    Notes,
}

impl Choice {
    /// As it is typed.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Default => "default",
            Self::Notes => "notes",
        }
    }
}

/// The word a line was refused for; what is too long for an answer is cut off.
pub type Word = String<20>;

/// Why a line was not understood.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    word: Word,
    reason: Reason,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Reason {
    UnknownVerb,
    /// One of these is wanted.
    Wanted(&'static str),
    UnknownSetting,
    NotANumber,
    OutOfRange(Setting),
    TooMany,
    TooLong,
}

impl fmt::Display for Refusal {
    /// The offending word first, then what to do: at most 90 bytes.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.word)?;
        f.write_str(": ")?;
        match self.reason {
            Reason::UnknownVerb => f.write_str("no such verb, :help lists them"),
            Reason::Wanted(words) => write!(f, "{words} is wanted"),
            Reason::UnknownSetting => f.write_str("no such setting, :set lists them"),
            Reason::NotANumber => f.write_str("a number like 0.98 is wanted"),
            Reason::OutOfRange(setting) => {
                let [least, greatest] = setting.range();
                let (name, unit) = (setting.name(), setting.unit());
                write!(
                    f,
                    "{name} is {} to {} {unit}",
                    Short(least),
                    Short(greatest)
                )
            }
            Reason::TooMany => f.write_str("one word too many"),
            Reason::TooLong => f.write_str("the line is too long"),
        }
    }
}

/// A range's end without the machinery for floats: tens of thousandths at most.
struct Short(f32);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hundredths = (self.0 * 100.0 + 0.5) as u32;
        match (hundredths / 100, hundredths % 100) {
            (whole, 0) => write!(f, "{whole}"),
            (whole, tens) if tens % 10 == 0 => write!(f, "{whole}.{}", tens / 10),
            (whole, tens) => write!(f, "{whole}.{tens:02}"),
        }
    }
}

impl Refusal {
    fn new(word: &str, reason: Reason) -> Self {
        let mut cut = Word::new();
        for c in word.chars().take_while(|c| !c.is_control()) {
            if cut.push(c).is_err() {
                break;
            }
        }
        Self { word: cut, reason }
    }

    /// For a line that began like this and found no end.
    pub(super) fn too_long(line: &str) -> Self {
        let first = line.split(' ').next().unwrap_or_default();
        Self::new(first, Reason::TooLong)
    }
}

/// A line without its colon and its end. Words are separated by spaces, any number of them.
///
/// # Errors
///
/// [`Refusal`] names the first word that is wrong.
pub fn parse(line: &str) -> Result<Request, Refusal> {
    let mut words = line.split(' ').filter(|word| !word.is_empty());
    let verb = words.next().unwrap_or_default();
    let mut next = || words.next();
    let request = match verb {
        "help" => Request::Help,
        "version" => Request::Version,
        "defaults" => Request::Defaults,
        "bias" => Request::Bias,
        "estimator" => Request::Estimator(match next() {
            None => None,
            Some("default") => Some(Choice::Default),
            Some("notes") => Some(Choice::Notes),
            Some(other) => return refuse(other, Reason::Wanted("default or notes")),
        }),
        "compass" => match next() {
            None => Request::Compass(None),
            Some("auto") => Request::Compass(Some(UseCompass::Auto)),
            Some("on") => Request::Compass(Some(UseCompass::On)),
            Some("off") => Request::Compass(Some(UseCompass::Off)),
            Some("adjustment") => Request::CompassAdjustment,
            Some(other) => return refuse(other, Reason::Wanted("auto, on, off or adjustment")),
        },
        "calibration" => Request::Calibration,
        "forget" => Request::Forget,
        "keep" => match next() {
            None => return refuse(verb, Reason::Wanted("an offset and bytes, or done,")),
            Some("done") => Request::KeepDone,
            Some(offset) => {
                let Ok(at) = offset.parse() else {
                    return refuse(offset, Reason::Wanted("an offset from 0 or done"));
                };
                let Some(digits) = next() else {
                    return refuse(offset, Reason::Wanted("an offset and bytes, or done,"));
                };
                let Some(piece) = Piece::parse(at, digits) else {
                    return refuse(digits, Reason::Wanted("1 to 24 bytes in hexadecimal"));
                };
                Request::Keep(piece)
            }
        },
        "decimals" => Request::Decimals(match next() {
            None => None,
            Some(word) => {
                let digit = word.parse().ok().and_then(Decimals::new);
                let Some(decimals) = digit else {
                    return refuse(word, Reason::Wanted("3 to 6"));
                };
                Some(decimals)
            }
        }),
        "stream" => Request::Stream(match next() {
            None => None,
            Some("text") => Some(Format::Text),
            Some("timed") => Some(Format::Timed),
            Some("binary") => Some(Format::Binary),
            Some("counts") => Some(Format::Counts),
            Some(other) => return refuse(other, Reason::Wanted("text, timed, binary or counts")),
        }),
        "every" => Request::Every(match next() {
            None => None,
            Some(word) => match word.parse() {
                Ok(samples @ 1..=MOST_EVERY) => Some(samples),
                _ => return refuse(word, Reason::Wanted("1 to 1000")),
            },
        }),
        "core" => Request::Core(match next() {
            None => None,
            Some("72") => Some(CoreClock::Full),
            Some("36") => Some(CoreClock::Half),
            Some(other) => return refuse(other, Reason::Wanted("72 or 36")),
        }),
        "lock" => Request::Lock(match next() {
            None => None,
            Some("sensor") => Some(Lock::Sensor),
            Some("usb") => Some(Lock::Usb),
            Some(other) => return refuse(other, Reason::Wanted("sensor or usb")),
        }),
        "get" => Request::Get(setting(verb, next())?),
        "set" => {
            let setting = setting(verb, next())?;
            let Some(word) = next() else {
                return refuse(setting.name(), Reason::NotANumber);
            };
            let Some(value) = number::parse(word) else {
                return refuse(word, Reason::NotANumber);
            };
            let [least, greatest] = setting.range();
            if !(least..=greatest).contains(&value) {
                return refuse(word, Reason::OutOfRange(setting));
            }
            Request::Set(setting, value)
        }
        other => return refuse(other, Reason::UnknownVerb),
    };
    match words.next() {
        Some(word) => refuse(word, Reason::TooMany),
        None => Ok(request),
    }
}

fn refuse<T>(word: &str, reason: Reason) -> Result<T, Refusal> {
    Err(Refusal::new(word, reason))
}

fn setting(verb: &str, word: Option<&str>) -> Result<Setting, Refusal> {
    let Some(word) = word else {
        return refuse(verb, Reason::Wanted(Setting::NAMES));
    };
    let found = Setting::ALL.into_iter().find(|s| s.name() == word);
    found.ok_or_else(|| Refusal::new(word, Reason::UnknownSetting))
}
