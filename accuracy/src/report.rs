//! What a reader gets: tables on standard output, results and pictures in a folder.

use std::io::{self, Write};
use std::path::Path;

use nalgebra::UnitQuaternion;

#[path = "../../examples/picture/mod.rs"]
mod picture;

use crate::estimators::{Axes, Estimator};
use crate::evaluation::{Outcome, scores};
use crate::score::{self, Score};
use crate::trial::{GROUPS, Trial};
use crate::variant::Variant;
use picture::{Line, Picture};

/// What a picture shows, by how the name begins: more lines hide each other.
const PICTURED: [&str; 4] = ["course notes", "madgwick", "vqf", "vrduino"];
/// Points of a line.
const POINTS: usize = 800;

/// Mean errors of every estimator, one table for six axes and one for nine.
///
/// # Errors
///
/// Those of `out`.
pub fn summary(
    out: &mut impl Write,
    estimators: &[Estimator],
    outcomes: &[Vec<Outcome>],
) -> io::Result<()> {
    for axes in [Axes::Six, Axes::Nine] {
        let (title, last) = match axes {
            Axes::Six => ("Six axes: gyro and accelerometer", "aligned"),
            Axes::Nine => ("Nine axes: and magnetometer", "heading"),
        };
        writeln!(
            out,
            "\n{title:34} inclination      worst      total    {last}   (°, mean RMSE of the trials)"
        )?;
        for (estimator, scores) in estimators.iter().zip(scores(outcomes)) {
            if estimator.axes != axes {
                continue;
            }
            let mean = Score::mean(&scores);
            let worst = scores
                .iter()
                .map(|score| score.inclination)
                .fold(0.0, f64::max);
            let (total, last) = match axes {
                // Without a compass the heading begins anywhere: the total means nothing.
                Axes::Six => ("–".to_owned(), mean.aligned),
                Axes::Nine => (format!("{:.3}", mean.total), mean.heading),
            };
            writeln!(
                out,
                "{:34} {:>11.3} {worst:>10.3} {total:>10} {last:>10.3}",
                estimator.name, mean.inclination
            )?;
        }
    }
    Ok(())
}

/// What counts for this many axes.
fn counted(axes: Axes, score: &Score) -> f64 {
    match axes {
        Axes::Six => score.inclination,
        Axes::Nine => score.total,
    }
}

/// One line per estimator, one column per variant: inclination with six axes, total with nine.
///
/// # Errors
///
/// Those of `out`.
pub fn variants(
    out: &mut impl Write,
    estimators: &[Estimator],
    columns: &[(Variant, Vec<Vec<Score>>)],
) -> io::Result<()> {
    for (axes, title) in [
        (Axes::Six, "Six axes, inclination"),
        (Axes::Nine, "Nine axes, total"),
    ] {
        write!(out, "\n{title:34}")?;
        for (variant, _) in columns {
            write!(out, " {:>10}", variant.heading())?;
        }
        writeln!(out, "   (°, mean RMSE)")?;
        for (index, estimator) in estimators.iter().enumerate() {
            if estimator.axes != axes {
                continue;
            }
            write!(out, "{:34}", estimator.name)?;
            for (_, scores) in columns {
                write!(
                    out,
                    " {:>10.3}",
                    counted(axes, &Score::mean(&scores[index]))
                )?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}

/// The benchmark's table of each estimator: a row for each of its groups.
///
/// # Errors
///
/// Those of `out`.
pub fn groups(
    out: &mut impl Write,
    trials: &[Trial],
    estimators: &[Estimator],
    outcomes: &[Vec<Outcome>],
) -> io::Result<()> {
    let rows = GROUPS.map(|group| {
        let members: Vec<usize> = (0..trials.len())
            .filter(|&index| trials[index].groups().any(|of| of == group))
            .collect();
        (group.to_owned(), members)
    });
    let rows = rows.into_iter().filter(|(_, members)| !members.is_empty());
    tables(
        out,
        "group",
        &rows.collect::<Vec<_>>(),
        estimators,
        outcomes,
    )
}

/// The same with a row for each trial.
///
/// # Errors
///
/// Those of `out`.
pub fn per_trial(
    out: &mut impl Write,
    trials: &[Trial],
    estimators: &[Estimator],
    outcomes: &[Vec<Outcome>],
) -> io::Result<()> {
    let rows = trials.iter().enumerate();
    let rows = rows.map(|(index, trial)| (trial.name.clone(), vec![index]));
    tables(
        out,
        "trial",
        &rows.collect::<Vec<_>>(),
        estimators,
        outcomes,
    )
}

/// Without a compass the heading begins anywhere: heading and total then mean nothing before they are
/// aligned.
fn tables(
    out: &mut impl Write,
    heading: &str,
    rows: &[(String, Vec<usize>)],
    estimators: &[Estimator],
    outcomes: &[Vec<Outcome>],
) -> io::Result<()> {
    for (estimator, column) in estimators.iter().zip(outcomes) {
        let axes = if estimator.axes == Axes::Six {
            "six"
        } else {
            "nine"
        };
        writeln!(
            out,
            "\n{}, {axes} axes (°, mean RMSE)\n{heading:48}  n inclination    heading      total    aligned",
            estimator.name
        )?;
        for (name, members) in rows {
            let of: Vec<Score> = members.iter().map(|&index| column[index].score).collect();
            let mean = Score::mean(&of);
            writeln!(
                out,
                "{name:48} {:2} {:>11.3} {:>10.3} {:>10.3} {:>10.3}",
                members.len(),
                mean.inclination,
                mean.heading,
                mean.total,
                mean.aligned
            )?;
        }
    }
    Ok(())
}

/// A folder per estimator with `TRIAL.q32`: w, x, y, z as little-endian f32 after each sample, body → world
/// with **z up** (x east, y north).
///
/// # Errors
///
/// What the file system says, with the path.
pub fn results(
    folder: &Path,
    trials: &[Trial],
    estimators: &[Estimator],
    outcomes: &[Vec<Outcome>],
) -> io::Result<()> {
    for (estimator, column) in estimators.iter().zip(outcomes) {
        let folder = folder.join(file_name(estimator));
        create(&folder)?;
        for (trial, outcome) in trials.iter().zip(column) {
            let path = folder.join(format!("{}.q32", trial.name));
            let bytes: Vec<u8> = outcome
                .orientations
                .iter()
                .flat_map(|&q| z_up(q).map(|part| (part as f32).to_le_bytes()))
                .flatten()
                .collect();
            std::fs::write(&path, bytes).map_err(|error| with_path(&path, &error))?;
        }
    }
    Ok(())
}

/// The world with x east, y north, z up is ours turned by 90° about x: (x, y, z) → (x, −z, y).
fn z_up(q: UnitQuaternion<f64>) -> [f64; 4] {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    [
        half * (q.w - q.i),
        half * (q.i + q.w),
        half * (q.j - q.k),
        half * (q.k + q.j),
    ]
}

/// As a file or a folder is called: `vrduino-6`.
fn file_name(estimator: &Estimator) -> String {
    let axes = if estimator.axes == Axes::Six { 6 } else { 9 };
    let words: String = estimator
        .name
        .chars()
        .map(|c| {
            if c.is_ascii_alphanumeric() || c == '.' {
                c
            } else {
                ' '
            }
        })
        .collect();
    let words: Vec<&str> = words.split_whitespace().collect();
    format!("{}-{axes}", words.join("-"))
}

/// A picture per trial and number of axes: error over time, as it is counted.
///
/// # Errors
///
/// What the file system says, with the path.
pub fn pictures(
    folder: &Path,
    trials: &[Trial],
    estimators: &[Estimator],
    outcomes: &[Vec<Outcome>],
) -> io::Result<()> {
    create(folder)?;
    for (number, trial) in trials.iter().enumerate() {
        for (axes, word) in [(Axes::Six, "inclination"), (Axes::Nine, "total")] {
            let pictured = |estimator: &Estimator| {
                let begins = PICTURED.iter().any(|name| estimator.name.starts_with(name));
                // Ours once, not led and in double precision.
                let variant = estimator.name.starts_with("vrduino,");
                estimator.axes == axes && begins && !variant
            };
            // Ours last, so that it lies above the others.
            let order: Vec<usize> = (0..estimators.len())
                .rev()
                .filter(|&index| pictured(&estimators[index]))
                .collect();
            let lines: Vec<Line<'_>> = order
                .iter()
                .map(|&index| Line {
                    name: estimators[index].short_name(),
                    points: error_over_time(trial, axes, &outcomes[index][number].orientations),
                })
                .collect();
            let digit = if axes == Axes::Six { 6 } else { 9 };
            let picture = Picture {
                title: &format!("{}: error of the {word}, {digit} axes", trial.name),
                x: "time (s)",
                y: "error (°)",
                lines,
            };
            let name = format!("{}-{digit}", trial.name);
            picture
                .save_in(folder, &name)
                .map_err(|error| with_path(&folder.join(name), &error))?;
        }
    }
    Ok(())
}

/// The largest error of each stretch of time, s and °.
fn error_over_time(
    trial: &Trial,
    axes: Axes,
    orientations: &[UnitQuaternion<f64>],
) -> Vec<[f64; 2]> {
    let stretch = trial.samples.len().div_ceil(POINTS).max(1);
    let angle = |index: usize| {
        let e = score::error(&orientations[index], &trial.reference[index]?);
        Some(match axes {
            Axes::Six => score::inclination(e),
            Axes::Nine => score::total(e),
        })
    };
    (0..trial.samples.len())
        .step_by(stretch)
        .map(|begin| {
            let end = (begin + stretch).min(trial.samples.len());
            let largest = (begin..end).filter_map(angle).fold(f64::NAN, f64::max);
            [begin as f64 * trial.period, largest.to_degrees()]
        })
        .collect()
}

/// Makes a folder, so that it is known early whether it can be written.
///
/// # Errors
///
/// What the file system says, with the path.
pub fn create(folder: &Path) -> io::Result<()> {
    std::fs::create_dir_all(folder).map_err(|error| with_path(folder, &error))
}

fn with_path(path: &Path, error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("{}: {error}", path.display()))
}
