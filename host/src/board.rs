//! A board to work with: waited for, and asked who it is.

use std::io::{self, Write};
use std::time::{Duration, Instant};

use crate::failure::{Failure, Kind};
use crate::hub::{Hold, Hub, State, Status, Subscription, Update};
use crate::source::Choice;

/// How long a port is waited for that is not there; the emulated board takes the time it is built in.
const PATIENCE: Duration = Duration::from_secs(3);

/// How long an image may take to build: on the slowest of computers.
const LONGEST: Duration = Duration::from_secs(1800);

/// How long a board that is there may take to say who it is: it is asked five times.
const INTRODUCTION: Duration = Duration::from_secs(8);

/// A board that answers.
pub struct Acquaintance {
    /// Speaks to it.
    pub hub: Hub,
    /// What comes from it.
    pub updates: Subscription,
}

/// Waits for the board and until it has said who it is, and has it stream this.
///
/// # Errors
///
/// It is not there, or its program is another.
pub fn meet(choice: Choice, stream: &'static str) -> Result<Acquaintance, Failure> {
    let patience = patience(&choice);
    let hub = Hub::start(choice, Some(stream));
    let updates = hub.subscribe(Hold::All);
    let status = reach(&updates, patience)?;
    let name = status.source.clone();
    let met = |status: &Status| {
        let wanted = |now: &String| now.split(' ').next() == Some(stream);
        status.version.is_some() && status.stream.as_ref().is_some_and(wanted)
    };
    match wait(&updates, INTRODUCTION, |status| {
        met(status).then_some(Ok(())).or_else(|| trouble(status))
    }) {
        Some(Ok(())) => Ok(Acquaintance { hub, updates }),
        Some(Err(failure)) => Err(failure),
        None => Err(Failure::new(
            Kind::Stream,
            format!(
                "what is on {name} does not answer as vrduino does: flash it (`vrduino flash`), or see what it is (`vrduino doctor`)"
            ),
        )),
    }
}

/// Waits so long for the board, and asks who it is: what it says, if it answers.
///
/// # Errors
///
/// It is not there.
pub fn greet(choice: Choice, patience: Duration) -> Result<Option<String>, Failure> {
    let hub = Hub::start(choice, Some("text"));
    let updates = hub.subscribe(Hold::All);
    reach(&updates, Some(patience))?;
    let answer = wait(&updates, INTRODUCTION, |status| {
        let version = status.version.clone();
        // A stranger has been asked often enough.
        (version.is_some() || status.trouble.is_some()).then_some(version)
    });
    Ok(answer.flatten())
}

/// For how long it is worth waiting.
pub fn patience(choice: &Choice) -> Option<Duration> {
    matches!(choice, Choice::Port(_)).then_some(PATIENCE)
}

/// Waits until the source is there; as long as an image may take to build if that is none.
///
/// # Errors
///
/// Why it is not there.
pub fn reach(
    updates: &Subscription,
    patience: Option<Duration>,
) -> Result<std::sync::Arc<Status>, Failure> {
    let connected = |status: &Status| {
        (status.state == State::Connected).then(|| std::sync::Arc::new(status.clone()))
    };
    let mut trouble = None;
    let mut has_ended = false;
    let mut found = wait(updates, patience.unwrap_or(PATIENCE), |status| {
        trouble.clone_from(&status.trouble);
        has_ended = status.state == State::Ended;
        connected(status)
    });
    if found.is_none() && patience.is_none() && !has_ended {
        if let Some(trouble) = &trouble {
            // Where nobody can read it, it need not be said.
            let _ = writeln!(io::stderr(), "{trouble}");
        }
        found = wait(updates, LONGEST, |status| {
            trouble.clone_from(&status.trouble);
            connected(status)
        });
    }
    found.ok_or_else(|| {
        trouble.unwrap_or_else(|| {
            Failure::new(Kind::Board, "the board is not there: see `vrduino doctor`")
        })
    })
}

/// What is wrong with it, now that it was there: it is gone, or a stranger.
fn trouble<T>(status: &Status) -> Option<Result<T, Failure>> {
    status.trouble.clone().map(Err)
}

/// Looks at every status until one will do, the source has ended, or the time is up.
fn wait<T>(
    updates: &Subscription,
    patience: Duration,
    mut look: impl FnMut(&Status) -> Option<T>,
) -> Option<T> {
    let until = Instant::now() + patience;
    loop {
        let left = until.saturating_duration_since(Instant::now());
        match updates.next(left)? {
            Update::Status(status) => {
                let found = look(&status);
                if found.is_some() || status.state == State::Ended {
                    return found;
                }
            }
            Update::Stream(_) | Update::Bytes(_) | Update::Truth(_) | Update::Ended(_) => {}
        }
    }
}
