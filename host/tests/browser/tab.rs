//! One page in the browser: what a person does there, what they see, and what goes wrong meanwhile.

use std::io::ErrorKind;
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use data_encoding::BASE64;
use libtest_mimic::Failed;
use serde_json::{Value, json};
use tungstenite::{Error, Message, WebSocket};

/// Between two looks at the page.
const LOOK: Duration = Duration::from_millis(100);

/// Width and height in CSS pixels, and pixels of the screen to one of these.
#[derive(Clone, Copy, Debug)]
pub struct Size(pub u32, pub u32, pub u32);

impl Size {
    /// A small laptop's.
    pub const DESK: Self = Self(1280, 800, 1);
    /// A phone's.
    pub const PHONE: Self = Self(390, 844, 2);
    /// The same, on its side.
    pub const SIDEWAYS: Self = Self(844, 390, 2);
    /// The smallest there are.
    pub const SMALL_PHONE: Self = Self(320, 568, 2);

    fn is_phone(self) -> bool {
        self.0.min(self.1) < 500
    }
}

/// A page. Whatever the browser reports as an error in it fails the test that closes it.
pub struct Tab {
    socket: WebSocket<TcpStream>,
    last: u64,
    wrong: Vec<String>,
    /// What the browser is allowed to report, since the test brings it about.
    expected: Vec<&'static str>,
}

impl Tab {
    /// By the browser's own socket, and what connects to a page's.
    pub fn open(
        browser: WebSocket<TcpStream>,
        connect: impl Fn(&str) -> Result<WebSocket<TcpStream>, Failed>,
        url: &str,
        size: Size,
        script: &str,
    ) -> Result<Self, Failed> {
        let new = |socket| Self {
            socket,
            last: 0,
            wrong: Vec::new(),
            expected: Vec::new(),
        };
        let target = new(browser).call(
            "Target.createTarget",
            &json!({"url": "about:blank", "newWindow": true}),
        )?;
        let id = target["targetId"].as_str().ok_or("a page without an id")?;
        let mut tab = new(connect(&format!("/devtools/page/{id}"))?);
        for domain in ["Runtime.enable", "Log.enable", "Page.enable"] {
            tab.call(domain, &json!({}))?;
        }
        tab.resize(size)?;
        tab.call(
            "Emulation.setFocusEmulationEnabled",
            &json!({"enabled": true}),
        )?;
        if size.is_phone() {
            tab.call(
                "Emulation.setTouchEmulationEnabled",
                &json!({"enabled": true}),
            )?;
        }
        tab.theme("dark")?;
        tab.call(
            "Page.addScriptToEvaluateOnNewDocument",
            &json!({"source": script}),
        )?;
        tab.call("Page.navigate", &json!({"url": url}))?;
        tab.until("the page has started", "'vrduino' in window", 60)?;
        Ok(tab)
    }

    /// Another screen, or the same held otherwise.
    pub fn resize(&mut self, size: Size) -> Result<(), Failed> {
        let Size(width, height, scale) = size;
        let metrics = json!({
            "width": width, "height": height, "deviceScaleFactor": scale, "mobile": size.is_phone(),
        });
        self.call("Emulation.setDeviceMetricsOverride", &metrics)?;
        Ok(())
    }

    /// What the system is set to, light or dark.
    pub fn theme(&mut self, theme: &str) -> Result<(), Failed> {
        let features = json!({"features": [{"name": "prefers-color-scheme", "value": theme}]});
        self.call("Emulation.setEmulatedMedia", &features)?;
        Ok(())
    }

    /// The browser may report errors with this in them.
    pub fn expect(&mut self, part: &'static str) {
        self.expected.push(part);
    }

    /// Asks the browser for something and waits for its answer.
    pub fn call(&mut self, method: &str, params: &Value) -> Result<Value, Failed> {
        self.last += 1;
        let id = self.last;
        let request = json!({"id": id, "method": method, "params": params});
        self.socket.send(Message::text(request.to_string()))?;
        loop {
            let text = match self.socket.read() {
                Ok(Message::Text(text)) => text,
                Ok(_) => continue,
                // By a pause of this program.
                Err(Error::Io(error)) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => return Err(error.into()),
            };
            let mut message: Value = serde_json::from_str(&text)?;
            if message["id"] == id {
                return match message.get("error") {
                    Some(error) => Err(format!("{method}: {error}").into()),
                    None => Ok(message["result"].take()),
                };
            }
            self.notice(&message);
        }
    }

    fn notice(&mut self, event: &Value) {
        let params = &event["params"];
        let what = match event["method"].as_str() {
            Some("Runtime.exceptionThrown") => &params["exceptionDetails"],
            Some("Runtime.consoleAPICalled") if params["type"] == "error" => &params["args"],
            Some("Log.entryAdded") if params["entry"]["level"] == "error" => &params["entry"],
            _ => return,
        };
        let what = what.to_string();
        if !self.expected.iter().any(|part| what.contains(part)) {
            self.wrong.push(what);
        }
    }

    /// The value of an expression in the page, which may be a promise.
    pub fn eval(&mut self, expression: &str) -> Result<Value, Failed> {
        let params = json!({
            "expression": expression, "awaitPromise": true, "returnByValue": true, "userGesture": true,
        });
        let mut result = self.call("Runtime.evaluate", &params)?;
        match result.get("exceptionDetails") {
            Some(details) => Err(format!("{expression}: {details}").into()),
            None => Ok(result["result"]["value"].take()),
        }
    }

    /// Makes `window.given` of a long text, without its being part of a script, which the browser would keep.
    pub fn give(&mut self, text: &str) -> Result<(), Failed> {
        let window = self.call("Runtime.evaluate", &json!({"expression": "window"}))?;
        let params = json!({
            "objectId": window["result"]["objectId"],
            "functionDeclaration": "function (text) { this.given = text; }",
            "arguments": [{"value": text}],
        });
        self.call("Runtime.callFunctionOn", &params)?;
        Ok(())
    }

    /// The value of an expression, as numbers.
    pub fn numbers(&mut self, expression: &str) -> Result<Vec<f64>, Failed> {
        Ok(serde_json::from_value(self.eval(expression)?)?)
    }

    /// Waits until an expression is true: for so many seconds, and on a busy machine for a minute.
    pub fn until(&mut self, what: &str, expression: &str, seconds: u64) -> Result<(), Failed> {
        let seconds = seconds.max(60);
        let began = Instant::now();
        // A page that is being loaded has nothing yet.
        let guarded = format!(
            "(() => {{ try {{ return Boolean({expression}); }} catch {{ return false; }} }})()"
        );
        while self.eval(&guarded)? != true {
            if began.elapsed().as_secs() > seconds {
                let state = self.eval("document.body.innerText.slice(0, 2000)")?;
                return Err(format!(
                    "waited {seconds} s in vain until {what}: {expression}\nthe page shows {state}\nwrong: {:?}",
                    self.wrong
                )
                .into());
            }
            thread::sleep(LOOK);
        }
        Ok(())
    }

    /// Clicks on an element as a person does, where it is.
    pub fn click(&mut self, selector: &str) -> Result<(), Failed> {
        let place = self.numbers(&format!(
            "(() => {{ const e = document.querySelector({selector:?}); e.scrollIntoView({{block: 'center'}});
               const r = e.getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; }})()"
        ))?;
        for kind in ["mouseMoved", "mousePressed", "mouseReleased"] {
            let event = json!({
                "type": kind, "x": place[0], "y": place[1], "button": "left", "clickCount": 1,
            });
            self.call("Input.dispatchMouseEvent", &event)?;
        }
        Ok(())
    }

    /// Drags from one place in the window to another, in steps.
    pub fn drag(&mut self, from: [f64; 2], to: [f64; 2]) -> Result<(), Failed> {
        const STEPS: u32 = 10;
        let mut mouse = |kind: &str, part: f64| {
            let [x, y] = [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * part);
            let event = json!({"type": kind, "x": x, "y": y, "button": "left", "buttons": 1});
            self.call("Input.dispatchMouseEvent", &event)
        };
        mouse("mousePressed", 0.0)?;
        for step in 1..=STEPS {
            mouse("mouseMoved", f64::from(step) / f64::from(STEPS))?;
        }
        mouse("mouseReleased", 1.0)?;
        Ok(())
    }

    /// Presses a key.
    pub fn press(&mut self, key: &str) -> Result<(), Failed> {
        let text = if key == "Enter" { "\r" } else { key };
        let down = json!({"type": "keyDown", "key": key, "text": text});
        self.call("Input.dispatchKeyEvent", &down)?;
        self.call(
            "Input.dispatchKeyEvent",
            &json!({"type": "keyUp", "key": key}),
        )?;
        Ok(())
    }

    /// Moves a slider to this place of its own scale.
    pub fn slide(&mut self, id: &str, place: f64) -> Result<(), Failed> {
        self.eval(&format!(
            "(() => {{ const e = document.getElementById({id:?}); e.value = {place};
               e.dispatchEvent(new Event('input', {{bubbles: true}})); }})()"
        ))?;
        Ok(())
    }

    /// What the page looks like, kept in `target/pictures`; returns how many bytes it takes.
    pub fn picture(&mut self, name: &str) -> Result<usize, Failed> {
        let folder = pictures();
        let png = self.png()?;
        std::fs::create_dir_all(&folder)?;
        std::fs::write(folder.join(name), &png)?;
        Ok(png.len())
    }

    /// What the page looks like.
    pub fn png(&mut self) -> Result<Vec<u8>, Failed> {
        let shot = self.call("Page.captureScreenshot", &json!({"format": "png"}))?;
        let data = shot["data"].as_str().ok_or("a picture without data")?;
        Ok(BASE64.decode(data.as_bytes())?)
    }

    /// Leaves the page; fails if anything went wrong while it was open.
    pub fn close(mut self) -> Result<(), Failed> {
        // What is still on its way is told before the answer.
        self.eval("0")?;
        // The page goes with the answer, or before it.
        let _ = self.call("Page.close", &json!({}));
        if self.wrong.is_empty() {
            return Ok(());
        }
        Err(format!("the browser reports errors: {:#?}", self.wrong).into())
    }
}

/// Where pictures are kept.
pub fn pictures() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("../pictures")
}
