//! What was found, what is left over, and what was refused.

use nalgebra::Vector3;

use super::procedure::{Procedure, Residual};
use crate::output::Output;

/// Says it. What was refused, if anything was.
pub fn tell(procedure: &Procedure, output: &mut Output) -> Option<String> {
    let mut refused = Vec::new();
    output.say("");
    match procedure.gyro() {
        Some(gyro) => {
            let celsius = gyro.temperature_celsius;
            let bias = vector(&gyro.bias.dps(), 3);
            output.say(format!("gyro           bias {bias} °/s at {celsius:.1} °C"));
            let Residual { before, after } = procedure.gyro_residual(&gyro);
            output.say(format!(
                "               at rest it reads {before:.3} °/s, corrected {after:.3}"
            ));
        }
        None => refused.push((
            "gyro",
            "never still: lay the board down and take the hand away".to_owned(),
        )),
    }
    match procedure.accelerometer() {
        Ok(found) => {
            let bias = vector(&found.bias.m_per_s2(), 3);
            let scale = vector(&found.matrix.diagonal(), 4);
            output.say(format!(
                "accelerometer  bias {bias} m/s², factors {scale}, laid {:.1}° off",
                found.placing.degrees()
            ));
            let Residual { before, after } = procedure.force_residual(&found);
            output.say(format!(
                "               at rest it is {before:.3} m/s² off 1 g, corrected {after:.3}"
            ));
        }
        Err(refusal) => refused.push(("accelerometer", refusal.to_string())),
    }
    if procedure.has_magnetometer() {
        match procedure.magnetometer() {
            Ok(found) => {
                let iron = vector(&found.hard_iron.microtesla(), 2);
                output.say(format!(
                    "magnetometer   hard iron {iron} µT, field {:.1} µT, {:.0} % of all directions, largest hole {:.0}°",
                    found.strength_microtesla,
                    100.0 * found.coverage,
                    found.largest_hole.degrees()
                ));
                let Residual { before, after } = procedure.field_residual(&found);
                output.say(format!(
                    "               its strength varies by {before:.1} %, corrected {after:.1}"
                ));
            }
            Err(refusal) => refused.push(("magnetometer", refusal.to_string())),
        }
    } else {
        output.say("magnetometer   none on this board");
    }
    for (name, reason) in &refused {
        output.say(format!("{name:14} refused: {reason}"));
    }
    let names: Vec<_> = refused.iter().map(|(name, _)| *name).collect();
    (!names.is_empty()).then(|| {
        format!(
            "refused: {}; see above what is missing, and run it again",
            names.join(", ")
        )
    })
}

fn vector(v: &Vector3<f32>, decimals: usize) -> String {
    let [x, y, z] = [v.x, v.y, v.z];
    format!("{x:.decimals$} {y:.decimals$} {z:.decimals$}")
}
