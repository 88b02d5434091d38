//! A Chromium without a window, told what to do over its DevTools protocol.

use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::thread;
use std::time::{Duration, Instant};

use libtest_mimic::Failed;
use tungstenite::{Message, WebSocket};

use super::tab::{Size, Tab};

/// Under what names it is installed.
const NAMES: [&str; 4] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
];

/// Software rendering, nothing of the network, nothing of a person's own settings.
const FLAGS: [&str; 13] = [
    "--headless=new",
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--remote-debugging-port=0",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--no-default-browser-check",
    "--hide-scrollbars",
    // Several pages at once are all in front.
    "--disable-backgrounding-occluded-windows",
    "about:blank",
];

/// An answer that takes longer will not come.
const PATIENCE: Duration = Duration::from_secs(120);

/// So long it may take to end.
const FAREWELL: Duration = Duration::from_secs(10);

/// One for all tests, started by the first.
pub struct Chromium {
    program: PathBuf,
    running: OnceLock<Result<Running, String>>,
}

struct Running {
    child: Child,
    profile: PathBuf,
    /// `127.0.0.1:PORT`
    address: String,
    /// Path of the whole browser's socket.
    path: String,
}

impl Chromium {
    /// The one that is installed; `CHROMIUM` names another.
    pub fn installed() -> Option<Self> {
        let named = std::env::var_os("CHROMIUM").map(PathBuf::from);
        let program = named
            .into_iter()
            .chain(NAMES.map(PathBuf::from))
            .find(|program| {
                let version = Command::new(program).arg("--version").output();
                version.is_ok_and(|output| output.status.success())
            })?;
        Some(Self {
            program,
            running: OnceLock::new(),
        })
    }

    /// A new window with this page.
    pub fn open(&self, url: &str) -> Result<Tab, Failed> {
        self.open_as(url, Size::DESK, "")
    }

    /// The same of a size, and with a script that runs before any of the page's own.
    pub fn open_as(&self, url: &str, size: Size, script: &str) -> Result<Tab, Failed> {
        let running = self.running.get_or_init(|| self.start());
        let running = running.as_ref().map_err(String::as_str)?;
        let browser = running.connect(&running.path)?;
        Tab::open(browser, |path| running.connect(path), url, size, script)
    }

    fn start(&self) -> Result<Running, String> {
        let profile = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
            .join(format!("chromium-{}", std::process::id()));
        let mut child = Command::new(&self.program)
            .arg(format!("--user-data-dir={}", profile.display()))
            .args(FLAGS)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| error.to_string())?;
        let stderr = child.stderr.take().ok_or("Chromium has no stderr")?;
        let mut lines = BufReader::new(stderr).lines().map_while(Result::ok);
        let found = lines.find_map(|line| {
            let url = line.strip_prefix("DevTools listening on ws://")?;
            let (address, path) = url.split_once('/')?;
            Some((address.to_owned(), format!("/{path}")))
        });
        // What it says from now on is for nobody, but must not fill the pipe.
        thread::spawn(move || lines.for_each(drop));
        let Some((address, path)) = found else {
            let _ = child.kill();
            return Err("Chromium ended before it said where its DevTools are".into());
        };
        Ok(Running {
            child,
            profile,
            address,
            path,
        })
    }
}

impl Running {
    fn connect(&self, path: &str) -> Result<WebSocket<TcpStream>, Failed> {
        let stream = TcpStream::connect(&self.address)?;
        stream.set_read_timeout(Some(PATIENCE))?;
        let url = format!("ws://{}{path}", self.address);
        let (socket, _) = tungstenite::client(url, stream).map_err(|error| error.to_string())?;
        Ok(socket)
    }

    /// Asked to, it ends its own processes, which would go on writing into the profile.
    fn end(&mut self) {
        if let Ok(mut socket) = self.connect(&self.path) {
            let _ = socket.send(Message::text(r#"{"id": 1, "method": "Browser.close"}"#));
            let _ = socket.read();
        }
        let until = Instant::now() + FAREWELL;
        while matches!(self.child.try_wait(), Ok(None)) && Instant::now() < until {
            thread::sleep(Duration::from_millis(20));
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = std::fs::remove_dir_all(&self.profile);
    }
}

impl Drop for Chromium {
    fn drop(&mut self) {
        if let Some(Ok(running)) = self.running.get_mut() {
            running.end();
        }
    }
}
