//! What is typed: key by key where there is a terminal, else as it comes.

use std::io::{self, IsTerminal, Read};
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

/// The keyboard, or what stands for it.
#[derive(Debug)]
pub enum Keyboard {
    /// A terminal that gives every key at once.
    #[cfg(feature = "tui")]
    Terminal(terminal::Terminal),
    /// A pipe or a file.
    Pipe(Receiver<Vec<u8>>),
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
        let (sender, receiver) = mpsc::channel();
        // It cannot be called back from reading: it ends with the program.
        thread::spawn(move || {
            let mut buffer = [0; 256];
            while let Ok(count @ 1..) = io::stdin().read(&mut buffer) {
                if sender.send(buffer[..count].to_vec()).is_err() {
                    return;
                }
            }
        });
        if is_terminal {
            Self::Lines(receiver)
        } else {
            Self::Pipe(receiver)
        }
    }

    /// The next, if it comes within this time.
    pub fn next(&mut self, patience: Duration) -> Option<Typed> {
        match self {
            #[cfg(feature = "tui")]
            Self::Terminal(terminal) => terminal.next(patience),
            Self::Pipe(bytes) => match bytes.recv_timeout(patience) {
                Ok(bytes) => Some(Typed::Bytes(bytes)),
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
            Self::Pipe(_) | Self::Lines(_) => "\n",
        }
    }
}

#[cfg(feature = "tui")]
mod terminal {
    use std::time::Duration;
    use std::{io, thread};

    use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
    use ratatui::crossterm::terminal::{disable_raw_mode, enable_raw_mode};

    use super::Typed;

    /// A terminal without echo and without Enter; as it was before when this is dropped.
    #[derive(Debug)]
    pub struct Terminal {
        /// Within a line that began with a colon every key belongs to it.
        in_line: bool,
    }

    impl Terminal {
        pub fn open() -> io::Result<Self> {
            enable_raw_mode()?;
            Ok(Self { in_line: false })
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
                KeyCode::Enter => {
                    self.in_line = false;
                    Some(Typed::Bytes(b"\n".into()))
                }
                KeyCode::Char('d') if !self.in_line => Some(Typed::Print),
                KeyCode::Char(key) => {
                    self.in_line |= key == ':';
                    Some(Typed::Bytes(key.to_string().into_bytes()))
                }
                _ => None,
            }
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
            let mut terminal = std::mem::ManuallyDrop::new(Terminal { in_line: false });
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
            let line: Vec<_> = ":d\n".chars().map(|key| bytes(&key.to_string())).collect();
            assert_eq!(type_in(":d\nd"), [line, vec![Typed::Print]].concat());
        }
    }
}
