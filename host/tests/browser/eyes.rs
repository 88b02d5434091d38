//! Algorithms 2 and 3: the page's views are the library's, whatever is switched.

use libtest_mimic::Failed;
use vrduino::units::Millimetres;
use vrduino::view::eyes::{Eye, InterpupillaryDistance};
use vrduino::view::head_neck::HeadNeck;
use vrduino::view::mounting::Mounting;
use vrduino::view::projection::{Depth, Projection, Window};
use vrduino::view::viewer::Viewer;

use super::chromium::Chromium;
use super::moving::{START, close_to, rotation};
use super::server::Server;
use super::tab::Tab;

/// Planes of the page's lenses, and where the eyes' windows are one, in millimetres.
const NEAR: f64 = 60.0;
const FAR: f64 = 90_000.0;
const SCREEN: f64 = 2500.0;

/// Views are of millimetres: a ten-thousandth of one.
const TOLERANCE: f64 = 1e-4;

/// One picture's quaternion, two views and two lenses.
const PICTURE: &str = "(({ quaternion, left, right, leftLens, rightLens }) =>
    [...quaternion, ...left, ...right, ...leftLens, ...rightLens])(vrduino.picture)";

pub fn matrices(chromium: &Chromium) -> Result<(), Failed> {
    let program = Server::view(&["--emulate"]);
    let mut tab = chromium.open(&program.url())?;
    tab.until("samples arrive", "vrduino.count > 1000", START)?;
    tab.press("v")?;
    tab.until("both eyes are drawn", "vrduino.mode === 'stereo'", 5)?;
    tab.until("the head moves", "vrduino.time > 4.5", 60)?;
    let mut neck = true;
    let mut turned = false;
    for ipd in [64.0, 50.0, 75.0] {
        tab.slide("ipd", ipd)?;
        for _ in 0..4 {
            check(&mut tab, ipd, turned, neck)?;
            // By click and by key in turns, through all four.
            tab.click(".switch:has(#neck)")?;
            neck = !neck;
            check(&mut tab, ipd, turned, neck)?;
            tab.press("m")?;
            turned = !turned;
        }
    }
    tab.press("]")?;
    tab.until("75 mm is the most", "vrduino.viewer.ipd === 75", 5)?;
    tab.press("[")?;
    tab.until("eyes come nearer", "vrduino.viewer.ipd === 74", 5)?;
    let bytes = tab.picture("page-eyes.png")?;
    if bytes < 50_000 {
        return Err(format!("{bytes} bytes of picture: it shows nothing").into());
    }
    tab.close()
}

fn check(tab: &mut Tab, ipd: f64, turned: bool, neck: bool) -> Result<(), Failed> {
    let viewer = Viewer {
        mounting: if turned {
            Mounting::TurnedAround
        } else {
            Mounting::Aligned
        },
        eyes: InterpupillaryDistance::new(Millimetres(ipd))?,
        neck: if neck {
            HeadNeck::new(Millimetres(150.0), Millimetres(100.0))?
        } else {
            HeadNeck::none()
        },
        position: [0.0, 1700.0, 0.0].into(),
    };
    let shown = format!(
        "vrduino.viewer.ipd === {ipd} && vrduino.viewer.turnedAround === {turned}
         && (vrduino.viewer.neck > 0) === {neck}"
    );
    tab.until("it is switched", &shown, 5)?;
    let frames = tab.eval("vrduino.picture.frames")?;
    tab.until(
        "it is drawn",
        &format!("vrduino.picture.frames > {frames} + 1"),
        20,
    )?;
    let picture = tab.numbers(PICTURE)?;
    let (quaternion, matrices) = picture.split_at(4);
    let head = rotation(quaternion)?;
    let mut matrices = matrices.chunks(16);
    for eye in [Eye::Left, Eye::Right] {
        let found = matrices.next().ok_or("no view")?;
        close_to(found, &viewer.view(head, eye)?.to_homogeneous(), TOLERANCE)?;
    }
    for eye in [Eye::Left, Eye::Right] {
        let found = matrices.next().ok_or("no lens")?;
        close_to(found, &lens(found, viewer.eyes.position(eye).x)?, 1e-9)?;
    }
    Ok(())
}

/// The library's projection with the field of view of this one, for an eye so far to the right.
fn lens(found: &[f64], aside: f64) -> Result<vrduino::nalgebra::Matrix4<f64>, Failed> {
    let (right, top) = (NEAR / found[0], NEAR / found[5]);
    let middle = -aside * NEAR / SCREEN;
    let window = Window {
        left: Millimetres(middle - right),
        right: Millimetres(middle + right),
        bottom: Millimetres(-top),
        top: Millimetres(top),
    };
    let depth = Depth {
        near: Millimetres(NEAR),
        far: Millimetres(FAR),
    };
    Ok(Projection::through(window, depth)?.matrix())
}
