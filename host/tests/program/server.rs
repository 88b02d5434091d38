//! The program where it serves.

// Every test file compiles a copy of this and calls what it needs of it: the rest is unused there, not everywhere.
#![allow(dead_code, reason = "not every test asks for everything")]

use std::ops::{Deref, DerefMut};
use std::process::{Command, Stdio};

use super::program::{Ended, Program, command};

/// `view` or `serve`, at work.
pub struct Server {
    program: Program,
    /// Of this computer.
    pub port: u16,
}

impl Server {
    /// `vrduino view` at any free port.
    pub fn view(arguments: &[&str]) -> Self {
        Self::view_at(0, arguments)
    }

    /// `vrduino view` at this port.
    pub fn view_at(port: u16, arguments: &[&str]) -> Self {
        let port = port.to_string();
        Self::spawn(
            command()
                .args(["view", "--no-open", "--http-port", &port])
                .args(arguments),
        )
    }

    /// `vrduino serve` at any free port, to be typed to.
    pub fn serve(arguments: &[&str]) -> Self {
        let mut command = command();
        command.stdin(Stdio::piped());
        Self::spawn(command.args(["serve", "--ws-port", "0"]).args(arguments))
    }

    /// Whatever serves, once it has said where.
    pub fn spawn(command: &mut Command) -> Self {
        let program = Program::spawn(command);
        let address = program.until("its address", |line| line.contains("://"));
        let port = address.trim_end_matches('/').rsplit(':').next();
        Self {
            port: port.and_then(|port| port.parse().ok()).expect("a port"),
            program,
        }
    }

    /// Of its page.
    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}/", self.port)
    }

    /// Waits for its end.
    pub fn end(self) -> Ended {
        self.program.end()
    }
}

impl Deref for Server {
    type Target = Program;

    fn deref(&self) -> &Program {
        &self.program
    }
}

impl DerefMut for Server {
    fn deref_mut(&mut self) -> &mut Program {
        &mut self.program
    }
}
