//! What this computer tells of ports and programs, where it tells it: mostly Linux, by files. Elsewhere
//! these things are not known, and whoever asks has to do without.

pub mod access;

pub mod halfkay;

pub mod programs;

pub mod udev;
