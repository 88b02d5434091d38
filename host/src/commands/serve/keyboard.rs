//! What is typed: key by key where there is a terminal, else as it comes.

use std::io::{self, IsTerminal, Read};
use std::mem;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::Duration;

/// What was typed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Typed {
    /// Something for the board.
    Bytes(Vec<u8>),
    /// To begin to print, or to stop.
    Print,
    /// To end.
    End,
}

/// Bytes a pipe may hold at a time, and the time for them: more than a person types, and no more than a board
/// that obeys a key a millisecond keeps up with.
const PIECE: usize = 16;
const A_PIECE: Duration = Duration::from_millis(16);

/// No line of the board's is longer.
const LONGEST_LINE: usize = 256;

/// Gives keys at once, and a line that begins with a colon as a whole: what else is sent to the board would
/// fall into it.
#[derive(Debug, Default)]
pub struct Lines {
    line: Option<Vec<u8>>,
}

impl Lines {
    /// What goes to the board with this byte.
    pub fn take(&mut self, byte: u8) -> Option<Vec<u8>> {
        const ERASE: [u8; 2] = [0x08, 0x7F];
        match (&mut self.line, byte) {
            (None, b':') => self.line = Some(vec![byte]),
            (None, _) => return Some(vec![byte]),
            (Some(line), b'\n' | b'\r') => {
                let mut line = mem::take(line);
                self.line = None;
                line.push(b'\n');
                return Some(line);
            }
            (Some(line), _) if ERASE.contains(&byte) => {
                line.pop();
                if line.is_empty() {
                    self.line = None;
                }
            }
            (Some(line), _) if line.len() < LONGEST_LINE => line.push(byte),
            (Some(_), _) => {}
        }
        None
    }

    /// Whether a line has begun.
    #[cfg(feature = "tui")]
    pub fn is_within(&self) -> bool {
        self.line.is_some()
    }
}

/// The keyboard, or what stands for it.
#[derive(Debug)]
pub enum Keyboard {
    /// A terminal that gives every key at once.
    #[cfg(feature = "tui")]
    Terminal(terminal::Terminal),
    /// A pipe or a file.
    Pipe(Receiver<Vec<u8>>, Lines),
    /// A terminal that gives whole lines: what is typed in one belongs together.
    Lines(Receiver<Vec<u8>>),
}

impl Keyboard {
    /// The standard input.
    pub fn open() -> Self {
        let is_terminal = io::stdin().is_terminal();
        #[cfg(feature = "tui")]
        if is_terminal && let Ok(terminal) = terminal::Terminal::open() {
            return Self::Terminal(terminal);
        }
        // Who types faster than the board takes is made to wait.
        let (sender, receiver) = mpsc::sync_channel(1);
        // It cannot be called back from reading: it ends with the program.
        thread::spawn(move || {
            let mut buffer = [0; LONGEST_LINE];
            let size = if is_terminal { LONGEST_LINE } else { PIECE };
            while let Ok(count @ 1..) = io::stdin().read(&mut buffer[..size]) {
                if sender.send(buffer[..count].to_vec()).is_err() {
                    return;
                }
                thread::sleep(A_PIECE);
            }
        });
        if is_terminal {
            Self::Lines(receiver)
        } else {
            Self::Pipe(receiver, Lines::default())
        }
    }

    /// The next, if it comes within this time.
    pub fn next(&mut self, patience: Duration) -> Option<Typed> {
        match self {
            #[cfg(feature = "tui")]
            Self::Terminal(terminal) => terminal.next(patience),
            Self::Pipe(bytes, lines) => match bytes.recv_timeout(patience) {
                Ok(bytes) => {
                    let whole = bytes.into_iter().filter_map(|byte| lines.take(byte));
                    Some(Typed::Bytes(whole.flatten().collect()))
                }
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => {
                    thread::sleep(patience);
                    None
                }
            },
            Self::Lines(lines) => match lines.recv_timeout(patience) {
                Ok(line) if line.trim_ascii() == b"d" => Some(Typed::Print),
                Ok(line) => Some(Typed::Bytes(line)),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => Some(Typed::End),
            },
        }
    }

    /// What ends a line on this terminal.
    pub fn line_end(&self) -> &'static str {
        match self {
            #[cfg(feature = "tui")]
            Self::Terminal(_) => "\r\n",
            Self::Pipe(..) | Self::Lines(_) => "\n",
        }
    }
}

#[cfg(feature = "tui")]
mod terminal {
    use std::time::Duration;
    use std::{io, thread};

    use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
    use ratatui::crossterm::terminal::{disable_raw_mode, enable_raw_mode};

    use super::{Lines, Typed};

    /// A terminal without echo and without Enter; as it was before when this is dropped.
    #[derive(Debug)]
    pub struct Terminal {
        /// Within one every key belongs to it.
        lines: Lines,
    }

    impl Terminal {
        pub fn open() -> io::Result<Self> {
            enable_raw_mode()?;
            Ok(Self {
                lines: Lines::default(),
            })
        }

        pub fn next(&mut self, patience: Duration) -> Option<Typed> {
            let event = match event::poll(patience) {
                Ok(true) => event::read(),
                Ok(false) => return None,
                Err(error) => Err(error),
            };
            match event {
                Ok(Event::Key(key)) if key.kind != KeyEventKind::Release => self.take(key),
                Ok(_) => None,
                Err(_) => {
                    // A terminal that is gone is no reason to be busy.
                    thread::sleep(patience);
                    None
                }
            }
        }

        fn take(&mut self, key: KeyEvent) -> Option<Typed> {
            let control = key.modifiers.contains(KeyModifiers::CONTROL);
            match key.code {
                KeyCode::Char('c') if control => Some(Typed::End),
                KeyCode::Char(_) if control => None,
                KeyCode::Char('d') if !self.lines.is_within() => Some(Typed::Print),
                KeyCode::Enter => self.byte(b'\n'),
                KeyCode::Backspace => self.byte(0x08),
                // A line of the board's has no other letters.
                KeyCode::Char(key) => u8::try_from(key).ok().and_then(|byte| self.byte(byte)),
                _ => None,
            }
        }

        fn byte(&mut self, byte: u8) -> Option<Typed> {
            self.lines.take(byte).map(Typed::Bytes)
        }
    }

    impl Drop for Terminal {
        fn drop(&mut self) {
            // A terminal that is gone needs no restoring.
            let _ = disable_raw_mode();
        }
    }

    #[cfg(test)]
    mod tests {
        use super::{KeyCode, KeyEvent, KeyModifiers, Terminal, Typed};

        fn type_in(text: &str) -> Vec<Typed> {
            let mut terminal = std::mem::ManuallyDrop::new(Terminal {
                lines: super::Lines::default(),
            });
            let keys = text.chars().map(|key| match key {
                '\n' => KeyCode::Enter,
                key => KeyCode::Char(key),
            });
            keys.filter_map(|key| terminal.take(KeyEvent::new(key, KeyModifiers::NONE)))
                .collect()
        }

        #[test]
        fn d_prints_but_belongs_to_a_line_within_one() {
            let bytes = |text: &str| Typed::Bytes(text.into());
            assert_eq!(type_in("0d"), [bytes("0"), Typed::Print]);
            assert_eq!(type_in(":d\nd"), [bytes(":d\n"), Typed::Print]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Lines;

    #[test]
    fn a_line_goes_as_a_whole_and_keys_at_once() {
        let mut lines = Lines::default();
        let mut typed = |text: &str| -> Vec<Vec<u8>> {
            text.bytes().filter_map(|byte| lines.take(byte)).collect()
        };
        assert_eq!(typed("0r"), [b"0", b"r"]);
        assert_eq!(typed(":get damp"), [b""; 0]);
        assert_eq!(
            typed("x\x08ing\n5"),
            [b":get damping\n".to_vec(), b"5".to_vec()]
        );
        assert_eq!(typed(":\x7F5"), [b"5"]);
    }
}
