//! What is typed to the board, and its answers: one question at a time.
//!
//! A board whose program is another than ours takes single letters for keys (`b` measures its bias, `r`
//! turns it round), so it is asked something that holds none of them before anything else: `:help`.

pub mod answer;

use std::collections::VecDeque;
use std::sync::mpsc::Sender;
use std::time::Duration;

use vrduino::command::request::Setting;

use crate::patience::Patience;
use crate::source::Order;

/// How long an answer may take; the board's start-up takes a second.
const PATIENCE: Duration = Duration::from_millis(1200);

/// A board that has not answered so often is a stranger: it is asked less often from then on, and sent no lines.
const ATTEMPTS: u32 = 5;

/// How long it is left alone then.
const LEFT_ALONE: Duration = Duration::from_secs(5);

const WHO: &str = ":help";

/// What a board streams after power-on.
const USUAL: &str = "stream text every 10";

/// Questions that may wait: a page that asks faster than a board answers is not heard.
const WAITING: usize = 200;

/// What somebody wants of the board.
#[derive(Debug)]
pub enum Wish {
    /// An order for the source, at once.
    Order(Order),
    /// A line to be typed.
    Say(String),
    /// A line to be typed, and its answer: without `OK`, or the whole `ERR`.
    Ask(String, Sender<Result<String, String>>),
}

/// How far a board is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Acquaintance {
    /// Nobody is there.
    Nobody,
    /// It has been asked who it is so often and has not answered.
    New(u32),
    /// It answers.
    Known,
}

#[derive(Debug)]
struct Question {
    line: String,
    reply: Option<Sender<Result<String, String>>>,
}

impl Question {
    fn own(line: impl Into<String>) -> Self {
        Self {
            line: line.into(),
            reply: None,
        }
    }
}

/// The conversation.
#[derive(Debug)]
pub struct Conversation {
    /// What is to be streamed; without it the board is not spoken to unasked.
    stream: Option<&'static str>,
    board: Acquaintance,
    waiting: VecDeque<Question>,
    asked: Option<(Question, Patience)>,
    orders: Vec<Order>,
    /// One that does not, as a recording, answers nothing but `ERR`: its `OK` was said to another.
    listens: bool,
    /// What the board streamed before it was asked for something else.
    before: Option<String>,
}

impl Conversation {
    pub(super) fn new(stream: Option<&'static str>) -> Self {
        Self {
            stream,
            board: Acquaintance::Nobody,
            waiting: VecDeque::new(),
            asked: None,
            orders: Vec::new(),
            before: None,
            listens: true,
        }
    }

    /// A board is there. What was wanted of it before waits until it is known.
    /// One that listens to nobody is not asked who it is.
    pub(super) fn begin(&mut self, listens: bool) {
        self.asked = None;
        self.before = None;
        self.listens = listens;
        self.board = if self.stream.is_some() && listens {
            Acquaintance::New(0)
        } else {
            Acquaintance::Known
        };
    }

    /// It is gone, and what it was asked.
    pub(super) fn end(&mut self) {
        self.board = Acquaintance::Nobody;
        self.waiting.clear();
        self.asked = None;
        self.before = None;
    }

    /// Takes a wish.
    pub(super) fn wish(&mut self, wish: Wish) {
        let (line, reply) = match wish {
            Wish::Order(order) => return self.orders.push(order),
            Wish::Say(line) => (line, None),
            Wish::Ask(line, reply) => (line, Some(reply)),
        };
        if self.waiting.len() < WAITING {
            self.waiting.push_back(Question { line, reply });
        }
    }

    /// What is to be done now.
    pub(super) fn orders(&mut self) -> Vec<Order> {
        let patience = if self.is_stranger() {
            LEFT_ALONE
        } else {
            PATIENCE
        };
        if self
            .asked
            .as_mut()
            .is_some_and(|(_, unanswered)| unanswered.look() > patience)
        {
            // Its reply goes with it: who waits is told that nothing came.
            self.asked = None;
        }
        if self.is_stranger() {
            self.waiting.clear();
        }
        if self.asked.is_none() {
            match self.board {
                Acquaintance::Nobody => {}
                Acquaintance::New(attempts) => {
                    self.board = Acquaintance::New(attempts.saturating_add(1));
                    self.ask(Question::own(WHO));
                }
                Acquaintance::Known => {
                    if let Some(question) = self.waiting.pop_front() {
                        self.ask(question);
                    }
                }
            }
        }
        std::mem::take(&mut self.orders)
    }

    fn ask(&mut self, question: Question) {
        // What half a line there may be ends here.
        let line = format!("\n{}\n", question.line);
        self.orders.push(Order::Send(line.into_bytes()));
        self.asked = Some((question, Patience::new()));
    }

    /// Whether a board is there that does not answer: its program is another.
    pub(super) fn is_stranger(&self) -> bool {
        matches!(self.board, Acquaintance::New(attempts) if attempts > ATTEMPTS)
    }

    /// A line has come.
    pub(super) fn hear(&mut self, line: &str) {
        if !self.listens && line.starts_with("OK ") {
            return;
        }
        let Some((question, _)) = &self.asked else {
            return;
        };
        // One that comes too late, or from another program, answers nothing.
        let Some(answer) = answer::to(&question.line, line) else {
            return;
        };
        let Some((question, _)) = self.asked.take() else {
            return;
        };
        if matches!(self.board, Acquaintance::New(_)) {
            self.board = Acquaintance::Known;
            self.introduce();
            return;
        }
        if let (":stream", Ok(answer)) = (question.line.as_str(), &answer)
            && question.reply.is_none()
        {
            // Frames are what a program has left that was cut off: nobody reads them by chance.
            let frames = ["stream binary", "stream counts"];
            let left = frames.iter().any(|frame| answer.starts_with(frame));
            let found = if left { USUAL } else { answer };
            self.before.get_or_insert_with(|| found.to_owned());
        }
        if answer.is_ok() {
            self.ask_what_changed(&question.line);
        }
        if let Some(reply) = question.reply {
            // Who asked may have lost patience.
            let _ = reply.send(answer);
        }
    }

    /// What is asked of every board, before what anybody wanted meanwhile.
    fn introduce(&mut self) {
        let stream = self.stream.unwrap_or_default();
        let settings = Setting::ALL.map(|setting| format!(":get {}", setting.name()));
        let lines = [
            ":stream".into(),
            format!(":stream {stream}"),
            ":version".into(),
            ":estimator".into(),
        ];
        for line in lines.into_iter().chain(settings).rev() {
            self.waiting.push_front(Question::own(line));
        }
    }

    /// One setting may move another, and `:defaults` moves all.
    fn ask_what_changed(&mut self, line: &str) {
        let all = line == ":defaults";
        let siblings = |name: &str| matches!(name, "notes-time" | "notes-alpha");
        let of_notes = line
            .strip_prefix(":set ")
            .is_some_and(|rest| rest.starts_with("notes-"));
        for setting in Setting::ALL {
            let line = format!(":get {}", setting.name());
            let wanted = all || of_notes && siblings(setting.name());
            if wanted && self.waiting.iter().all(|question| question.line != line) {
                self.waiting.push_back(Question::own(line));
            }
        }
        if all {
            self.waiting.push_back(Question::own(":estimator"));
            self.waiting.push_back(Question::own(":stream"));
        }
    }

    /// The board is left as it was found; one that was left in frames, as it is after power-on.
    pub(super) fn farewell(&mut self) -> Vec<Order> {
        let mut orders = std::mem::take(&mut self.orders);
        if let Some(before) = self.before.take() {
            let mut lines = String::from("\n");
            // As `text every 10`.
            let mut words = before.strip_prefix("stream ").unwrap_or(&before).split(' ');
            if let Some(stream) = words.next() {
                lines += &format!(":stream {stream}\n");
            }
            if let Some(every) = words.nth(1) {
                lines += &format!(":every {every}\n");
            }
            orders.push(Order::Send(lines.into_bytes()));
        }
        orders
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is typed to a board that says these lines, one after another.
    fn typed(lines: &[&str]) -> String {
        let mut conversation = Conversation::new(Some("binary"));
        conversation.begin(true);
        let mut orders = conversation.orders();
        for line in lines {
            conversation.hear(line);
            orders.extend(conversation.orders());
        }
        orders.extend(conversation.farewell());
        let bytes = orders.into_iter().flat_map(|order| match order {
            Order::Send(bytes) => bytes,
            other => panic!("{other:?}"),
        });
        String::from_utf8(bytes.collect())
            .expect("text")
            .replace("\n\n", "\n")
    }

    const VERBS: &str = "OK verbs: help version";

    #[test]
    fn a_board_is_left_as_it_was_found() {
        let all = typed(&[VERBS, "OK stream timed every 7", "OK stream binary every 1"]);
        assert_eq!(
            all,
            "\n:help\n:stream\n:stream binary\n:version\n:stream timed\n:every 7\n"
        );
    }

    #[test]
    fn one_that_was_left_in_frames_is_put_back() {
        let all = typed(&[VERBS, "OK stream binary every 1"]);
        assert!(all.ends_with(":stream text\n:every 10\n"), "{all}");
    }

    #[test]
    fn an_answer_that_comes_late_is_not_taken_for_another() {
        let all = typed(&[VERBS, VERBS, "OK stream timed every 7", VERBS]);
        assert_eq!(
            all,
            "\n:help\n:stream\n:stream binary\n:stream timed\n:every 7\n"
        );
    }

    /// Their letters are keys of other programs.
    #[test]
    fn another_program_is_not_known_by_its_errors() {
        assert_eq!(
            typed(&["ERR no SD card", "OK", "OK ready", "ERR: x"]),
            "\n:help\n"
        );
    }
}
