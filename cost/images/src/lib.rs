//! What the programs feed their filters with, and the filters that are only there to be counted. The same on the
//! host, where the references run.
//!
//! | file | what it is |
//! |---|---|
//! | `head` | the motion that every filter is counted on |
//! | `filter` | what a filter has to do to be counted |
//! | `ours` | the library's filters behind it |
//! | `textbook` | the course's filter as a student writes it, with sine, cosine and arc cosine |
//! | `straightforward` | the same by the types of nalgebra |
//! | `motion`, `fusion` | motions that go to every end, for the two filters in fixed point |
//! | `run` | runs a filter on the chip |

#![no_std]
#![forbid(unsafe_code)]

pub mod head;

pub mod filter;

pub mod ours;

pub mod textbook;

pub mod straightforward;

pub mod motion;

pub mod fusion;

#[cfg(target_os = "none")]
pub mod run;
