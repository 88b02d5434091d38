//! A conversation with a debugger.

use std::io;

use super::description;
use super::packet::{Connection, LONGEST, Word};
use crate::board::Board;
use crate::board::debug::{Halt, Stops, Watchpoint};
use crate::cpu::debug::PC;
use crate::time::{self, Ticks};

/// Most breakpoints and watchpoints of each kind. The chip has six and four (DDI 0439, chapters 10 and 9).
const MOST_STOPS: usize = 64;

/// What the program does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Halted,
    /// It goes on, from where it had stopped if `leaving`.
    Running {
        leaving: bool,
    },
    /// One instruction, once there is one.
    Stepping,
}

/// The conversation.
#[derive(Debug)]
pub(super) struct Session {
    connection: Connection,
    state: State,
    stops: Stops,
    /// The last reason for stopping, as a packet.
    reason: String,
    ended: bool,
}

/// `text` as the two digits of each byte.
fn hex(bytes: impl IntoIterator<Item = u8>) -> String {
    bytes
        .into_iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

fn unhex(text: &str) -> Option<Vec<u8>> {
    let digits = text.as_bytes();
    if !digits.len().is_multiple_of(2) {
        return None;
    }
    digits
        .chunks(2)
        .map(|pair| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok())
        .collect()
}

/// Two hexadecimal numbers with a comma between.
fn pair(text: &str) -> Option<(u32, usize)> {
    let (address, length) = text.split_once(',')?;
    let address = u32::from_str_radix(address, 16).ok()?;
    Some((address, usize::from_str_radix(length, 16).ok()?))
}

const OK: &str = "OK";
const INVALID: &str = "E16";
const NO_MEMORY: &str = "E0e";

impl Session {
    /// The debugger finds the program halted.
    pub fn new(connection: Connection) -> Session {
        Session {
            connection,
            state: State::Halted,
            stops: Stops::default(),
            reason: "S05".into(),
            ended: false,
        }
    }

    /// Whether the debugger has taken its leave.
    pub fn has_ended(&self) -> bool {
        self.ended
    }

    /// The run ends. A debugger that has gone need not hear of it.
    pub fn end(&mut self) {
        let _ = self.connection.send("W00");
    }

    /// Answers what was asked, and runs the board for `span` if it may run.
    pub fn serve(&mut self, board: &mut Board, span: Ticks) -> io::Result<()> {
        while let Some(word) = self.connection.word(self.state == State::Halted)? {
            match word {
                Word::Interrupt if self.state != State::Halted => self.halt("S02".into())?,
                Word::Interrupt => {}
                Word::Packet(packet) => {
                    let text = String::from_utf8_lossy(&packet).into_owned();
                    if let Some(answer) = self.answer(board, &text)? {
                        self.connection.send(&answer)?;
                    }
                }
            }
            if self.ended {
                return Ok(());
            }
        }
        let halt = match self.state {
            State::Halted => None,
            State::Running { leaving } => {
                self.state = State::Running { leaving: false };
                board.run_with(span, &self.stops, leaving)
            }
            State::Stepping => board.step_instruction(span),
        };
        match halt {
            Some(halt) => self.report(board, halt),
            None => Ok(()),
        }
    }

    fn halt(&mut self, reason: String) -> io::Result<()> {
        self.state = State::Halted;
        self.connection.send(&reason)?;
        self.reason = reason;
        Ok(())
    }

    fn report(&mut self, board: &Board, halt: Halt) -> io::Result<()> {
        let reason = match halt {
            Halt::Step => "S05".into(),
            Halt::Breakpoint => "T05hwbreak:;".into(),
            Halt::Watchpoint(Watchpoint {
                address,
                reads,
                writes,
                ..
            }) => {
                let kind = match (reads, writes) {
                    (true, true) => "awatch",
                    (true, false) => "rwatch",
                    _ => "watch",
                };
                format!("T05{kind}:{address:x};")
            }
            Halt::Trap => {
                self.tell(&why(board))?;
                "S06".into()
            }
        };
        self.halt(reason)
    }

    /// Text for the debugger's console.
    fn tell(&mut self, text: &str) -> io::Result<()> {
        for line in text.lines() {
            let line = hex(line.bytes().chain([b'\n']).take(LONGEST / 2 - 1));
            self.connection.send(&format!("O{line}"))?;
        }
        Ok(())
    }

    /// The answer to a packet; none to one that lets the program go on.
    fn answer(&mut self, board: &mut Board, packet: &str) -> io::Result<Option<String>> {
        let Some(command) = packet.chars().next() else {
            return Ok(Some(String::new()));
        };
        let rest = &packet[command.len_utf8()..];
        Ok(Some(match command {
            '?' => self.reason.clone(),
            'g' => hex(board.registers().into_iter().flat_map(u32::to_le_bytes)),
            'G' => write_registers(board, rest),
            'p' => read_register(board, rest),
            'P' => write_register(board, rest),
            'm' => read_memory(board, rest),
            'M' => write_memory(board, rest),
            'c' | 's' => return self.go_on(board, command, rest),
            'Z' | 'z' => self.change_stops(command == 'Z', rest),
            'D' => {
                self.connection.send(OK)?;
                self.ended = true;
                return Ok(None);
            }
            'k' => {
                self.ended = true;
                return Ok(None);
            }
            'H' | 'T' => OK.into(),
            'q' => return self.query(board, rest),
            'Q' if rest == "StartNoAckMode" => {
                self.connection.stop_acknowledging();
                OK.into()
            }
            'v' if rest == "Cont?" => "vCont;c;C;s;S".into(),
            'v' => {
                let action = rest.strip_prefix("Cont;").and_then(|a| a.chars().next());
                match action {
                    Some('c' | 'C') => return self.go_on(board, 'c', ""),
                    Some('s' | 'S') => return self.go_on(board, 's', ""),
                    _ => String::new(),
                }
            }
            _ => String::new(),
        }))
    }

    fn go_on(&mut self, board: &mut Board, how: char, from: &str) -> io::Result<Option<String>> {
        if let Ok(address) = u32::from_str_radix(from, 16) {
            let mut registers = board.registers();
            registers[PC] = address;
            board.set_registers(&registers);
        }
        self.state = if how == 's' {
            State::Stepping
        } else {
            State::Running { leaving: true }
        };
        Ok(None)
    }

    fn query(&mut self, board: &mut Board, query: &str) -> io::Result<Option<String>> {
        let (name, rest) = query.split_once([':', ',']).unwrap_or((query, ""));
        Ok(Some(match name {
            "Supported" => format!(
                "PacketSize={LONGEST:x};qXfer:features:read+;qXfer:memory-map:read+;swbreak-;hwbreak+;\
                 vContSupported+;QStartNoAckMode+"
            ),
            "Xfer" => match rest.split_once(":read:") {
                Some(("features", part)) => {
                    piece(&description::target(), part.strip_prefix("target.xml:"))
                }
                Some(("memory-map", part)) => piece(description::MEMORY, part.strip_prefix(':')),
                _ => String::new(),
            },
            "Rcmd" => {
                let command = unhex(rest).and_then(|bytes| String::from_utf8(bytes).ok());
                let said = monitor(board, command.as_deref().unwrap_or("").trim());
                self.tell(&said)?;
                OK.into()
            }
            "Attached" => "1".into(),
            "C" => "QC1".into(),
            "fThreadInfo" => "m1".into(),
            "sThreadInfo" => "l".into(),
            "Symbol" => OK.into(),
            _ => String::new(),
        }))
    }

    fn change_stops(&mut self, insert: bool, what: &str) -> String {
        let Some((kind, place)) = what.split_once(',') else {
            return INVALID.into();
        };
        let place = place.split(';').next().unwrap_or(place);
        let Some((address, length)) = pair(place) else {
            return INVALID.into();
        };
        match kind {
            "0" | "1" => {
                let breakpoints = &mut self.stops.breakpoints;
                breakpoints.retain(|&other| other != address);
                if insert {
                    breakpoints.push(address);
                }
                if breakpoints.len() > MOST_STOPS {
                    breakpoints.pop();
                    return NO_MEMORY.into();
                }
            }
            "2" | "3" | "4" => {
                let watchpoint = Watchpoint {
                    address,
                    length: length as u32,
                    reads: kind != "2",
                    writes: kind != "3",
                };
                let watchpoints = &mut self.stops.watchpoints;
                watchpoints.retain(|&other| other != watchpoint);
                if insert {
                    watchpoints.push(watchpoint);
                }
                if watchpoints.len() > MOST_STOPS {
                    watchpoints.pop();
                    return NO_MEMORY.into();
                }
            }
            _ => return String::new(),
        }
        OK.into()
    }
}

/// Part of a description: `m` and the text if more follows, `l` for the last.
fn piece(text: &str, part: Option<&str>) -> String {
    let Some((offset, length)) = part.and_then(pair) else {
        return INVALID.into();
    };
    let text = text.get(offset as usize..).unwrap_or("");
    let length = length.min(LONGEST / 2);
    match text.get(..length) {
        Some(part) if part.len() < text.len() => format!("m{part}"),
        _ => format!("l{text}"),
    }
}

fn read_register(board: &Board, number: &str) -> String {
    let index = usize::from_str_radix(number, 16)
        .ok()
        .and_then(description::index);
    index.map_or(INVALID.into(), |index| {
        hex(board.registers()[index].to_le_bytes())
    })
}

fn write_register(board: &mut Board, text: &str) -> String {
    let parsed = text.split_once('=').and_then(|(number, value)| {
        let index = description::index(usize::from_str_radix(number, 16).ok()?)?;
        let value = u32::from_le_bytes(unhex(value)?.try_into().ok()?);
        Some((index, value))
    });
    let Some((index, value)) = parsed else {
        return INVALID.into();
    };
    let mut registers = board.registers();
    registers[index] = value;
    board.set_registers(&registers);
    OK.into()
}

fn write_registers(board: &mut Board, text: &str) -> String {
    let mut registers = board.registers();
    let Some(bytes) = unhex(text).filter(|bytes| bytes.len() == 4 * registers.len()) else {
        return INVALID.into();
    };
    for (register, bytes) in registers.iter_mut().zip(bytes.as_chunks::<4>().0) {
        *register = u32::from_le_bytes(*bytes);
    }
    board.set_registers(&registers);
    OK.into()
}

fn read_memory(board: &Board, text: &str) -> String {
    let Some((address, length)) = pair(text) else {
        return INVALID.into();
    };
    let bytes = board.peek(address, length.min(LONGEST / 2 - 4));
    if bytes.is_empty() && length > 0 {
        return NO_MEMORY.into();
    }
    hex(bytes)
}

fn write_memory(board: &mut Board, text: &str) -> String {
    let parsed = text.split_once(':').and_then(|(place, bytes)| {
        let (address, length) = pair(place)?;
        let bytes = unhex(bytes).filter(|bytes| bytes.len() == length)?;
        Some((address, bytes))
    });
    match parsed {
        None => INVALID.into(),
        Some((address, bytes)) if board.poke(address, &bytes) => OK.into(),
        Some(_) => NO_MEMORY.into(),
    }
}

fn why(board: &Board) -> String {
    board
        .stop()
        .map_or("the board has not stopped".into(), |stop| stop.to_string())
}

/// A command for the board itself.
fn monitor(board: &mut Board, command: &str) -> String {
    match command {
        "reset" => {
            board.reset_for_debugger();
            "the chip was reset".into()
        }
        "why" => why(board),
        "time" => format!("{:.7} s", time::seconds(board.now())),
        "hash" => format!("{:016x}", board.state_hash()),
        _ => "reset: reset the chip\nwhy: why it has stopped\ntime: the moment, since power-on\nhash: a fingerprint \
              of its state"
            .into(),
    }
}
