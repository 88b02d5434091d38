//! Tables: CSV, and the course's rows.

use std::f64::consts::FRAC_PI_2;

use vrduino_emulator::motion::rotation::IDENTITY;
use vrduino_emulator::motion::{self, Motion};

use crate::close;

fn text_error(text: &str) -> String {
    motion::parse(text.as_bytes())
        .map(|_| ())
        .unwrap_err()
        .to_string()
}

#[test]
fn a_table_is_read_by_its_column_names() {
    let text = "\u{feff}# a nod\r\n\r\naz, AY,ax,gz,gy,gx_dps,t_ms,note,qw,qx,qy,qz\r\n\
                1,9,3,4,5,180,1000,start,1,0,0,0\r\n3,9,3,4,5,360,1500,end,1,0,0,0 # done\r\n";
    let motion = motion::parse(text.as_bytes()).unwrap();
    assert_eq!(motion.duration(), Some(0.5));
    let instant = motion.at(0.25);
    assert!(close(
        instant.rate,
        [1.5 * std::f64::consts::PI, 5.0, 4.0],
        1e-12
    ));
    assert!(close(instant.force, [3.0, 9.0, 2.0], 1e-12));
    assert_eq!(instant.truth, Some(IDENTITY));
}

#[test]
fn a_table_may_hold_the_magnetic_field() {
    let motion =
        motion::parse(b"t,gx,gy,gz,ax,ay,az,mx,my_ut,mz\n0,0,0,0,0,9.8,0,20,-40,5\n").unwrap();
    assert_eq!(motion.at(0.0).magnetic_field(), [20.0, -40.0, 5.0]);
    let message = text_error("t,gx,gy,gz,ax,ay,az,mx,mz\n0,0,0,0,0,0,0,0,0\n");
    assert!(
        message.contains("the magnetic field lacks the column my"),
        "{message}"
    );
}

#[test]
fn a_table_without_truth_has_none() {
    let motion = motion::parse(b"t,gx,gy,gz,ax_g,ay_g,az_g\n0,0,0,0,0,1,0\n").unwrap();
    assert_eq!(motion.at(0.0).truth, None);
    assert!(close(motion.at(5.0).force, [0.0, 9.80665, 0.0], 1e-12));
}

#[test]
fn a_wrong_table_is_refused_with_its_place() {
    const NAMES: &str = "t,gx,gy,gz,ax,ay,az\n";
    let with = |rows: &str| text_error(&format!("{NAMES}{rows}"));
    assert!(
        with("0,0,0,0,0,9.81,0\n1,0, x,0,0,9.81,0\n").starts_with("line 3, column 6: \"x\" for gy")
    );
    assert!(with("0,0,0,0,0,9.81\n").starts_with("line 2, column 1: 6 values"));
    assert!(with("0,0,0,0,0,NaN,0\n").starts_with("line 2, column 11: \"NaN\""));
    assert!(with("0,0,0,0,0,1e400,0\n").contains("1e400"));
    assert!(with("0,0,0,0,0,9,0\n0,0,0,0,0,9,0\n").starts_with("line 3, column 1: the time 0 s"));
    assert!(with("").contains("no motion"));
    assert!(text_error("t,gx,gy,gz,ax,ay\n").contains("no column az"));
    assert!(text_error("t,t,gx,gy,gz,ax,ay,az\n").contains("two columns hold t"));
    assert!(text_error("t,gx,gy,gz,ax,ay,az,qw,qx\n").contains("lacks the column qy, qz"));
    assert!(
        text_error("t,gx,gy,gz,ax,ay,az,qw,qx,qy,qz\n0,0,0,0,0,9,0,0,0,0,0\n")
            .contains("unit quaternion")
    );
    assert!(text_error("hello world\n").contains("no column t"));
    assert!(text_error("# nothing\n\n").contains("no motion"));
}

#[test]
fn the_courses_rows_are_read_in_every_dress() {
    let dresses = [
        "180 0 0 0.37 9.0 2.3\n0 0 90 0.37, 9.0, 2.3\n",
        "180,0,0,0.37,9.0,2.3,\n\n0,0,90,0.37,9.0,2.3,\n",
        "#pragma once\n// made { by hand }\nconst double imuData[2*6] = {\n180, 0, 0, 0.37f, 9.0,\n 2.3, \
         0, 0, 90, 0.37, /* a\n b */ 9.0, 2.3,\n};\n",
        "double imuData[][6] = {\n{180,0,0,0.37,9.0,2.3},\n{0,0,90,0.37,9.0,2.3}};",
        "{1.8e2,0,0,0.37,9.0,2.3},\n{0,0,90,0.37,9.0,2.3},\n",
    ];
    for text in dresses {
        let motion =
            motion::parse(text.as_bytes()).unwrap_or_else(|error| panic!("{error}: {text}"));
        assert_eq!(motion.duration(), Some(0.002), "{text}");
        assert!(close(
            motion.at(0.0).rate,
            [std::f64::consts::PI, 0.0, 0.0],
            1e-12
        ));
        assert!(close(motion.at(0.002).rate, [0.0, 0.0, FRAC_PI_2], 1e-12));
        assert!(close(motion.at(0.001).force, [0.37, 9.0, 2.3], 1e-7));
    }
}

#[test]
fn wrong_rows_are_refused_with_their_place() {
    assert!(text_error("1 2 3 4 5 6\n1 2 3 4 5\n").starts_with("line 2, column 1: 5 numbers"));
    assert!(text_error("0,1,2,3,4,5,6\n").starts_with("line 1, column 1: 7 numbers"));
    assert!(
        text_error("1 2 3 4 5 6\n1 2 three 4 5 6\n").starts_with("line 2, column 5: \"three\"")
    );
    assert!(text_error("double a[] = {1,2,3,4,5,6,7};").contains("7 numbers"));
    assert!(text_error("double a[] = {1,2,3,4,5,6").contains("ends inside the array"));
    assert!(text_error("double a[] = {};").contains("no motion"));
    assert!(
        text_error("double a[] = {{1,2,3},{4,5,6}};").starts_with("line 1, column 21: a row of 3")
    );
    assert!(text_error("double a[] = {1,2,3,4,5,6}; int b;").contains("after the end"));
    assert!(text_error("{}}").contains("after the end"));
    assert!(text_error("1 2 3 4 5 inf").contains("inf"));
}
