//! The board in a terminal.
//!
//! ```text
//! hub ──updates──► model ──► draw ──► terminal
//!  ▲                 │  └─ scene: what is seen, through the library's matrices
//!  └──── wishes ◄── keys
//! ```
//!
//! What is known and how it is drawn are apart, so that tests draw what they like where they like.

pub mod strips;

pub mod model;

pub mod keys;

pub mod scene;

pub mod draw;
