//! Recorded motions, whose fields were calibrated already: where enough was seen the result is near the
//! identity, and with a magnet standing beside it there is none.

use crate::array;
use crate::matrices::length;
use nalgebra::{Matrix3, Vector3};
use std::path::Path;
use vrduino::calibration::ellipsoid::{EllipsoidFit, Magnetometer, Refusal};
use vrduino::units::MagneticField;
use vrduino_emulator::motion;

/// Of the fields as recorded, 100 a second.
fn recorded(name: &str) -> Result<Magnetometer<f32>, Refusal<f32>> {
    let folder = std::env::var_os("VRDUINO_MOTIONS").expect("VRDUINO_MOTIONS names a folder");
    let motion = motion::open(&Path::new(&folder).join(name)).expect("a recording");
    let seconds = motion.duration().expect("it ends");
    let mut fit = EllipsoidFit::new();
    for k in 0..(seconds * 100.0) as u32 {
        let field = motion.at(f64::from(k) / 100.0).field.expect("nine axes");
        let field = Vector3::from(field).cast::<f32>();
        fit.push(Ok(MagneticField::from_microtesla(field)));
    }
    fit.result(21.0)
}

#[test]
// Ignored without the recordings: they are a benchmark's data, which this repository does not carry.
#[ignore = "needs VRDUINO_MOTIONS, a folder of recorded motions, which are not kept here"]
fn what_is_calibrated_already_stays_as_it_is() {
    for name in [
        "01_undisturbed_slow_rotation_A.imub",
        "02_undisturbed_slow_rotation_B.imub",
        "08_undisturbed_fast_rotation_with_breaks_A.imub",
        "21_undisturbed_fast_combined.imub",
    ] {
        let found = recorded(name).unwrap_or_else(|refusal| panic!("{name}: {refusal}"));
        let hard_iron = length(array(found.hard_iron.microtesla()));
        assert!(hard_iron < 1.2, "{name}: {hard_iron}");
        let soft_iron = (found.soft_iron - Matrix3::identity()).amax();
        assert!(soft_iron < 0.02, "{name}: {soft_iron}");
        let strength = found.strength_microtesla;
        assert!((43.5..45.0).contains(&strength), "{name}: {strength}");
    }
}

#[test]
// Ignored without the recordings: they are a benchmark's data, which this repository does not carry.
#[ignore = "needs VRDUINO_MOTIONS, a folder of recorded motions, which are not kept here"]
fn a_magnet_that_stands_beside_it_is_refused() {
    let refusal = recorded("28_disturbed_stationary_magnet_A.imub").expect_err("disturbed");
    assert!(matches!(refusal, Refusal::Disturbed(_)), "{refusal}");
}

#[test]
// Ignored without the recordings: they are a benchmark's data, which this repository does not carry.
#[ignore = "needs VRDUINO_MOTIONS, a folder of recorded motions, which are not kept here"]
fn a_board_that_is_carried_without_being_turned_is_refused() {
    let refusal = recorded("15_undisturbed_fast_translation_A.imub").expect_err("one direction");
    assert!(matches!(refusal, Refusal::Flat), "{refusal}");
}
