//! Consistent overhead byte stuffing (S. Cheshire and M. Baker, 1999): bytes without a zero among them,
//! so that a zero can stand between them.
//!
//! Every zero is replaced by how many bytes further on the next one is, or the end; a byte in front says where
//! the first one is. Here a message is short enough for that to be all: the original algorithm has a
//! special case beyond.

/// Most bytes that can be stuffed, the one in front included.
pub const LONGEST: usize = 254;

/// In place: the first byte is the one in front, whatever it was, and the others are the message.
///
/// # Errors
///
/// There are more than [`LONGEST`], and all are as they were.
pub fn stuff(bytes: &mut [u8]) -> Result<(), TooLong> {
    if bytes.len() > LONGEST {
        return Err(TooLong);
    }
    let Some((front, message)) = bytes.split_first_mut() else {
        return Ok(());
    };
    let mut distance = 1;
    for byte in message.iter_mut().rev() {
        if *byte == 0 {
            *byte = distance;
            distance = 0;
        }
        distance += 1;
    }
    *front = distance;
    Ok(())
}

/// In place: returns the message, if these bytes are one that was stuffed.
pub fn unstuff(bytes: &mut [u8]) -> Option<&[u8]> {
    let mut at = 0;
    while let Some(place) = bytes.get_mut(at) {
        let distance = usize::from(core::mem::take(place));
        let next = at + distance;
        if distance == 0 || bytes.get(at + 1..next)?.contains(&0) {
            return None;
        }
        at = next;
    }
    let (_, message) = bytes.split_first()?;
    (at == message.len() + 1).then_some(message)
}

/// There are too many bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong;
