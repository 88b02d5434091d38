//! Other screens, other themes, and graphics that fail.

use libtest_mimic::Failed;
use serde_json::json;

use super::chromium::Chromium;
use super::moving::START;
use super::server::Server;
use super::tab::Size;

pub fn lost_context(chromium: &Chromium) -> Result<(), Failed> {
    let program = Server::view(&["--emulate"]);
    let mut tab = chromium.open(&program.url())?;
    tab.until("samples arrive", "vrduino.count > 1000", START)?;
    tab.eval(
        "window.loser = document.getElementById('picture').getContext('webgl2').getExtension('WEBGL_lose_context');
         loser.loseContext()",
    )?;
    tab.until("the picture is lost", "vrduino.graphics === 'lost'", 10)?;
    let [frames, count] = tab.numbers("[vrduino.picture.frames, vrduino.count]")?[..] else {
        return Err("not two numbers".into());
    };
    tab.until(
        "samples go on",
        &format!("vrduino.count > {count} + 500"),
        20,
    )?;
    tab.eval("loser.restoreContext()")?;
    let drawn = format!("vrduino.graphics === 'drawn' && vrduino.picture.frames > {frames} + 5");
    tab.until("it comes back", &drawn, 20)?;
    let bytes = tab.picture("page-restored.png")?;
    if bytes < 50_000 {
        return Err(format!("{bytes} bytes of picture: it shows nothing").into());
    }
    tab.close()
}

pub fn no_webgl(chromium: &Chromium) -> Result<(), Failed> {
    let program = Server::view(&["--emulate"]);
    let script = "const get = HTMLCanvasElement.prototype.getContext;
        HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
            return kind === 'webgl2' ? null : get.call(this, kind, ...rest);
        };";
    let mut tab = chromium.open_as(&program.url(), Size::DESK, script)?;
    tab.until(
        "it says so",
        "!document.getElementById('no-webgl').hidden",
        10,
    )?;
    tab.until("samples arrive", "vrduino.count > 1000", START)?;
    let shown = "/^−?\\d+\\.\\d$/.test(document.getElementById('yaw').textContent)";
    tab.until("there are numbers", shown, 10)?;
    let inked = "(({ width, height }, pen) => pen.getImageData(width >> 1, 0, width >> 1, height).data
        .some((value) => value > 0))(document.getElementById('chart-rate'), document.getElementById('chart-rate').getContext('2d'))";
    tab.until("there are charts", inked, 10)?;
    tab.close()
}

pub fn phone(chromium: &Chromium) -> Result<(), Failed> {
    let program = Server::view(&["--emulate"]);
    let mut tab = chromium.open_as(&program.url(), Size::PHONE, "")?;
    tab.until("samples arrive", "vrduino.count > 1000", START)?;
    for (size, name) in [
        (Size::SMALL_PHONE, "page-phone-small.png"),
        (Size::SIDEWAYS, "page-phone-sideways.png"),
        (Size::PHONE, "page-phone.png"),
    ] {
        tab.resize(size)?;
        let Size(width, height, _) = size;
        let fits =
            format!("innerWidth === {width} && document.documentElement.scrollWidth <= {width}");
        tab.until("nothing is wider than the screen", &fits, 5)?;
        let whole =
            format!("document.getElementById('stage').getBoundingClientRect().bottom <= {height}");
        tab.until("the picture is on it as a whole", &whole, 5)?;
        tab.picture(name)?;
    }
    // A finger goes round the board: the label of ahead is where it leads.
    let place = "document.querySelector('#labels [data-axis=ahead]').style.transform";
    let before = tab.eval(place)?;
    for (kind, x) in [
        ("touchStart", Some(120)),
        ("touchMove", Some(220)),
        ("touchEnd", None),
    ] {
        let points: Vec<_> = x.map(|x| json!({"x": x, "y": 350})).into_iter().collect();
        tab.call(
            "Input.dispatchTouchEvent",
            &json!({"type": kind, "touchPoints": points}),
        )?;
    }
    tab.until("a finger turns it", &format!("{place} !== {before}"), 10)?;
    // As the system has it, until a person says otherwise.
    tab.theme("light")?;
    let theme = |name: &str| format!("document.documentElement.dataset.theme === '{name}'");
    tab.until("it is light", &theme("light"), 5)?;
    tab.picture("page-phone-light.png")?;
    tab.click("button[data-act=theme]")?;
    tab.until("it is dark", &theme("dark"), 5)?;
    tab.close()
}
