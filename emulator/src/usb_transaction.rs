//! USB transactions: what a host sends and how a device answers (USB 2.0, 8.4 and 8.5).

/// A transaction the host begins.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Token {
    /// SETUP with its eight bytes, always DATA0.
    Setup([u8; 8]),
    /// OUT with its data and toggle.
    Out(Vec<u8>, bool),
    /// IN.
    In,
}

/// What the device answers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// Data, with its toggle; the host acknowledges it.
    Data(Vec<u8>, bool),
    /// Accepted.
    Ack,
    /// Accepted on the wire, but dropped: the toggle says that it was taken before.
    Dropped,
    /// Not now.
    Nak,
    /// Never.
    Stall,
    /// Nothing at all.
    Silence,
}
