//! Consistent overhead byte stuffing (S. Cheshire and M. Baker, 1999): bytes without a zero among them,
//! so that a zero can stand between them.
//!
//! Every run of bytes up to a zero, or to the end, is written behind a byte that says how long it
//! is, itself included. Only runs of up to 253 bytes are known here, which is more than any message has: one
//! byte is added, whatever the message.

use heapless::Vec;

/// Longest run that is written as the original algorithm writes it.
const LONGEST_RUN: usize = 253;

/// Appends `message`, stuffed. What does not fit, or has too long a run, leaves `out` as it was.
///
/// # Errors
///
/// It does not fit.
pub fn stuff<const N: usize>(message: &[u8], out: &mut Vec<u8, N>) -> Result<(), TooLong> {
    let before = out.len();
    for run in message.split(|&byte| byte == 0) {
        let fits = run.len() <= LONGEST_RUN
            && out.push(run.len() as u8 + 1).is_ok()
            && out.extend_from_slice(run).is_ok();
        if !fits {
            out.truncate(before);
            return Err(TooLong);
        }
    }
    Ok(())
}

/// The message that was stuffed. None if these bytes are no stuffed message of at most `N` bytes.
pub fn unstuff<const N: usize>(mut stuffed: &[u8]) -> Option<Vec<u8, N>> {
    let mut message = Vec::new();
    while let Some((&length, rest)) = stuffed.split_first() {
        let length = usize::from(length).checked_sub(1)?;
        let (run, rest) = rest.split_at_checked(length)?;
        if length > LONGEST_RUN || run.contains(&0) {
            return None;
        }
        message.extend_from_slice(run).ok()?;
        if !rest.is_empty() {
            message.push(0).ok()?;
        }
        stuffed = rest;
    }
    Some(message)
}

/// There is no room for so many bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong;
