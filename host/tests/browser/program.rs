//! `vrduino view`, as a person starts it.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

use libtest_mimic::Failed;

/// Ends with this value.
pub struct Program {
    child: Child,
    /// Of its page.
    pub url: String,
}

impl Program {
    /// On a port that is free, with these further arguments.
    pub fn start(arguments: &[&str]) -> Result<Self, Failed> {
        Self::on_port("0", arguments)
    }

    /// On this port.
    pub fn on_port(port: &str, arguments: &[&str]) -> Result<Self, Failed> {
        let mut child = Command::new(env!("CARGO_BIN_EXE_vrduino"))
            .args(["view", "--no-open", "--http-port", port])
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()?;
        let stdout = child.stdout.take().ok_or("the program has no stdout")?;
        let mut lines = BufReader::new(stdout).lines().map_while(Result::ok);
        let url = lines.find_map(|line| {
            let start = line.find("http://")?;
            Some(line[start..].split_whitespace().next()?.to_owned())
        });
        std::thread::spawn(move || lines.for_each(drop));
        match url {
            Some(url) => Ok(Self { child, url }),
            None => {
                let _ = child.kill();
                Err("vrduino view has not printed the address of its page".into())
            }
        }
    }

    /// The port of its page.
    pub fn port(&self) -> &str {
        let address = self.url.trim_end_matches('/');
        address.rsplit(':').next().unwrap_or_default()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
