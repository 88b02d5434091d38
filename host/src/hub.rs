//! One source, many who look at it: reads the stream once and passes it on.
//!
//! ```text
//! source ──bytes──► stream ──items──► subscriptions: page, terminal, recorder, …
//!    ▲                                     │
//!    └──────── conversation ◄── keys and lines
//! ```
//!
//! Who is too slow loses the oldest, which is counted; who records loses nothing.

mod conversation;

mod status;

mod subscription;

use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use crate::failure::{Failure, Kind};
use crate::source::{self, Choice, Event, Order, Source, Truth};
use crate::stream::{Item, Stream};
use conversation::Conversation;
pub use conversation::{Wish, answer};
pub use status::{State, Status};
use subscription::Queue;
pub use subscription::{Hold, Subscription};

/// Between two looks at what nobody has told.
const TICK: Duration = Duration::from_millis(20);

/// How often the status is told, when nothing has changed.
const STATUS: Duration = Duration::from_secs(1);

/// How long an answer of the board's is waited for, questions before it included.
const ANSWER: Duration = Duration::from_secs(6);

/// What is passed on.
#[derive(Clone, Debug)]
pub enum Update {
    /// Orientations, registers and lines, in their order.
    Stream(Arc<[Item]>),
    /// The bytes as they came, before the same as [`Update::Stream`].
    Bytes(Arc<[u8]>),
    /// How the emulated sensor really stands.
    Truth(Truth),
    /// How things are: on every change, and once a second.
    Status(Arc<Status>),
    /// Nothing more will come.
    Ended(Result<(), Failure>),
}

/// What the hub is told.
enum Input {
    /// By the source of this number.
    Source(u32, Event),
    /// By whoever has the hub.
    Wish(Wish),
    /// To take another source.
    Switch(Choice),
    /// To say how things are.
    Status(Sender<Arc<Status>>),
    /// That nobody wants it any more.
    End,
}

/// The hub; it ends when this is dropped.
#[derive(Debug)]
pub struct Hub {
    inputs: Sender<Input>,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

/// What the hub's thread shares with those who have the hub.
#[derive(Debug, Default)]
struct Shared {
    queues: Mutex<Vec<Arc<Queue>>>,
    status: Mutex<Arc<Status>>,
}

impl Hub {
    /// Takes the source, and asks the board for this stream (`text`, `timed`, `binary`, `counts`), if it
    /// knows such things; what it streamed before is asked for again at the end. Without one, nothing is
    /// sent to the board.
    pub fn start(choice: Choice, stream: Option<&'static str>) -> Self {
        Self::with(choice, stream, Arc::new(Shared::default()))
    }

    /// The same, and everything from its very beginning.
    pub fn open(choice: Choice, stream: Option<&'static str>, hold: Hold) -> (Self, Subscription) {
        let shared = Arc::new(Shared::default());
        let (subscription, queue) = Subscription::new(hold);
        lock(&shared.queues).push(queue);
        (Self::with(choice, stream, shared), subscription)
    }

    fn with(choice: Choice, stream: Option<&'static str>, shared: Arc<Shared>) -> Self {
        let (inputs, received) = mpsc::channel();
        let worker = Worker::new(choice, stream, inputs.clone(), Arc::clone(&shared));
        let thread = thread::spawn(move || worker.run(&received));
        Self {
            inputs,
            shared,
            thread: Some(thread),
        }
    }

    /// What comes from now on.
    pub fn subscribe(&self, hold: Hold) -> Subscription {
        let (subscription, queue) = Subscription::new(hold);
        // Nobody is told anything meanwhile, so that nothing falls between.
        let mut queues = lock(&self.shared.queues);
        let status = self.status();
        queue.push(Update::Status(Arc::clone(&status)));
        if status.state == State::Ended {
            let result = status.trouble.clone().map_or(Ok(()), Err);
            queue.push(Update::Ended(result));
        }
        queues.push(queue);
        drop(queues);
        subscription
    }

    /// How things were when it was last told.
    pub fn status(&self) -> Arc<Status> {
        Arc::clone(&lock(&self.shared.status))
    }

    /// How things are at this moment, with all that came until now.
    pub fn status_now(&self) -> Arc<Status> {
        let (reply, answer) = mpsc::channel();
        self.tell(Input::Status(reply));
        answer
            .recv_timeout(STATUS)
            .unwrap_or_else(|_| self.status())
    }

    /// Types a key, or several, which the board does not answer.
    pub fn press(&self, keys: &[u8]) {
        self.tell(Input::Wish(Wish::Order(Order::Send(keys.to_vec()))));
    }

    /// Types a line, without its end, whose answer appears in the stream.
    pub fn say(&self, line: &str) {
        self.tell(Input::Wish(Wish::Say(line.to_owned())));
    }

    /// Types a line and waits for its answer, without its `OK`.
    ///
    /// # Errors
    ///
    /// The board says `ERR`, or nothing.
    pub fn ask(&self, line: &str) -> Result<String, Failure> {
        let (reply, answer) = mpsc::channel();
        self.tell(Input::Wish(Wish::Ask(line.to_owned(), reply)));
        match answer.recv_timeout(ANSWER) {
            Ok(Ok(answer)) => Ok(answer),
            Ok(Err(answer)) => Err(Failure::new(
                Kind::Stream,
                format!("the board refuses {line}: {answer}"),
            )),
            Err(_) => Err(Failure::new(
                Kind::Stream,
                format!(
                    "the board does not answer {line}: is it flashed with vrduino? (`vrduino doctor` looks closer)"
                ),
            )),
        }
    }

    /// Gives the source an order.
    pub fn order(&self, order: Order) {
        self.tell(Input::Wish(Wish::Order(order)));
    }

    /// Takes another source in the place of this one.
    pub fn switch(&self, choice: Choice) {
        self.tell(Input::Switch(choice));
    }

    fn tell(&self, input: Input) {
        // The worker lives as long as the hub.
        let _ = self.inputs.send(input);
    }
}

impl Drop for Hub {
    fn drop(&mut self) {
        self.tell(Input::End);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// A thread that panicked has left nothing half done here.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The hub's thread.
struct Worker {
    inputs: Sender<Input>,
    shared: Arc<Shared>,
    source: Source,
    /// Which source it is: what one that was left still says is passed over.
    number: u32,
    stream: Stream,
    conversation: Conversation,
    status: Status,
    /// The latest moment on the source's clock, and when that was here.
    latest: (f64, Instant),
    told: Instant,
}

impl Worker {
    fn new(
        choice: Choice,
        stream: Option<&'static str>,
        inputs: Sender<Input>,
        shared: Arc<Shared>,
    ) -> Self {
        let status = Status::of(&choice);
        *lock(&shared.status) = Arc::new(status.clone());
        Self {
            source: listen(choice, 0, inputs.clone()),
            inputs,
            shared,
            number: 0,
            stream: Stream::new(),
            conversation: Conversation::new(stream),
            status,
            latest: (0.0, Instant::now()),
            told: Instant::now(),
        }
    }

    fn run(mut self, inputs: &Receiver<Input>) {
        loop {
            match inputs.recv_timeout(TICK) {
                Ok(Input::Source(number, event)) if number == self.number => self.hear(event),
                Ok(Input::Source(..)) | Err(RecvTimeoutError::Timeout) => {}
                Ok(Input::Wish(wish)) => self.conversation.wish(wish),
                Ok(Input::Switch(choice)) => self.switch(choice),
                Ok(Input::Status(reply)) => {
                    self.tell_status();
                    // Who asked may have lost patience.
                    let _ = reply.send(Arc::new(self.status.clone()));
                }
                Ok(Input::End) | Err(RecvTimeoutError::Disconnected) => break,
            }
            self.converse();
            if self.told.elapsed() >= STATUS {
                self.tell_status();
            }
        }
        self.take_leave();
    }

    fn take_leave(&mut self) {
        for order in self.conversation.farewell() {
            self.source.order(order);
        }
    }

    fn hear(&mut self, event: Event) {
        match event {
            Event::Connected(name) => {
                self.stream.reconnect();
                let listens = self.status.kind != Some(source::Kind::Replay);
                self.conversation.begin(listens);
                self.status.connected(name);
                self.tell_status();
            }
            Event::Waiting(failure) => self.absent(State::Waiting, failure),
            Event::Lost(failure) => self.absent(State::Lost, failure),
            Event::Bytes { at, bytes } => self.take(at, bytes),
            Event::Truth(truth) => self.tell(&Update::Truth(truth)),
            Event::Ended(result) => {
                self.status.ended(&result);
                self.tell_status();
                self.tell(&Update::Ended(result));
            }
        }
    }

    fn absent(&mut self, state: State, failure: Failure) {
        self.conversation.end();
        self.status.absent(state, failure);
        self.tell_status();
    }

    fn take(&mut self, at: f64, bytes: Vec<u8>) {
        self.latest = (at, Instant::now());
        let mut items = Vec::new();
        self.stream.take(at, &bytes, &mut items);
        let mut changed = false;
        for item in &items {
            if let Item::Line(line) = item {
                changed |= self.status.learn(line);
                self.conversation.hear(line);
            }
        }
        self.tell(&Update::Bytes(bytes.into()));
        if !items.is_empty() {
            self.tell(&Update::Stream(items.into()));
        }
        if changed {
            self.tell_status();
        }
    }

    fn converse(&mut self) {
        for order in self.conversation.orders() {
            if let Order::Motion(name) = &order {
                self.status.motion = Some(name.clone());
            }
            self.source.order(order);
        }
        if self.conversation.is_stranger() && self.status.estrange() {
            self.tell_status();
        }
    }

    fn switch(&mut self, choice: Choice) {
        self.number += 1;
        self.take_leave();
        self.conversation.end();
        self.status = Status::of(&choice);
        self.stream = Stream::new();
        let next = listen(choice, self.number, self.inputs.clone());
        let before = std::mem::replace(&mut self.source, next);
        // It may have to end something first, as the building of an image.
        thread::spawn(move || drop(before));
        self.tell_status();
    }

    fn tell_status(&mut self) {
        self.told = Instant::now();
        let (at, heard) = self.latest;
        // The clock of what is emulated or replayed stands still while nothing comes of it.
        let is_its_own = self.status.kind != Some(source::Kind::Port);
        let since = match self.status.state {
            State::Connected if is_its_own => Duration::ZERO,
            _ => heard.elapsed(),
        };
        self.status.report = self.stream.report(at + since.as_secs_f64());
        let status = Arc::new(self.status.clone());
        *lock(&self.shared.status) = Arc::clone(&status);
        self.tell(&Update::Status(status));
    }

    fn tell(&self, update: &Update) {
        lock(&self.shared.queues).retain(|queue| {
            queue.is_wanted() && {
                queue.push(update.clone());
                true
            }
        });
    }
}

/// Starts a source that tells the hub under this number.
fn listen(choice: Choice, number: u32, inputs: Sender<Input>) -> Source {
    Source::start(choice, move |event: source::Event| {
        inputs.send(Input::Source(number, event)).is_ok()
    })
}
