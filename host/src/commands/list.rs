//! `vrduino list`: the serial ports, and what they are.

use clap::Args;
use serde::Serialize;

use crate::computer::{access, halfkay, programs};
use crate::failure::{Failure, Kind};
use crate::output::Output;
use crate::source::port::{self, Cause, Found};

const MEANING: &str = "\
A board is what has a Teensy's USB numbers: whether its program is the tracker's, `vrduino doctor` finds out. Its port \
is opened for a moment to see whether it can be had; other ports are not, for some boards start anew when they are.";

/// What is asked for.
#[derive(Clone, Debug, Args)]
#[command(after_help = MEANING)]
pub struct Arguments {
    /// Shows ports that are no USB devices as well
    #[arg(long)]
    pub all: bool,
    /// As JSON, for programs: a list of ports
    #[arg(long)]
    pub json: bool,
}

/// What stands behind a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum What {
    /// A Teensy that is a serial port.
    Board,
    /// A Teensy in its loader, which is no port.
    Loader,
    /// Another USB device.
    Usb,
    /// No USB device.
    Plain,
}

/// Whether it can be had.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum State {
    /// It can, as far as is known.
    Free,
    /// Another program has it.
    Busy,
    /// The user may not open it.
    Denied,
    /// It does not open for another reason.
    Broken,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct Row {
    /// None for a loader.
    name: Option<String>,
    what: What,
    #[serde(skip_serializing_if = "Option::is_none")]
    usb: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    manufacturer: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    serial: Option<String>,
    state: State,
    /// What else there is to say about the state.
    #[serde(skip_serializing_if = "String::is_empty")]
    remark: String,
}

/// Lists them.
///
/// # Errors
///
/// There is none.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut rows: Vec<Row> = port::ports()?.into_iter().map(row).collect();
    rows.extend((0..halfkay::waiting()).map(|_| loader()));
    let all = rows.len();
    rows.retain(|row| arguments.all || row.what != What::Plain);
    let hidden = all - rows.len();
    let mut output = Output::new();
    if arguments.json {
        output.say(json(&rows)?);
    } else {
        for line in table(&rows) {
            output.say(line);
        }
    }
    if rows.is_empty() {
        return Err(nothing(hidden));
    }
    if hidden > 0 && !arguments.json {
        output.say(format!("({hidden} more that are no USB devices: --all)"));
    }
    Ok(())
}

fn json(rows: &[Row]) -> Result<String, Failure> {
    serde_json::to_string_pretty(rows)
        .map_err(|error| Failure::new(Kind::Computer, error.to_string()))
}

fn nothing(hidden: usize) -> Failure {
    let hidden = match hidden {
        0 => String::new(),
        1 => " (a port that is no USB device is left out: --all)".into(),
        count => format!(" ({count} ports that are no USB devices are left out: --all)"),
    };
    Failure::new(
        Kind::Board,
        format!(
            "no board is plugged in{hidden}: connect it with a cable that carries data too, press its button if nothing shows, or take --emulate for the emulated board"
        ),
    )
}

fn loader() -> Row {
    Row {
        name: None,
        what: What::Loader,
        usb: Some("16c0:0478".into()),
        manufacturer: None,
        serial: None,
        state: State::Free,
        remark: "`vrduino flash` puts a program on it".into(),
    }
}

fn row(port: Found) -> Row {
    let what = match (&port.usb, port.is_board()) {
        (_, true) => What::Board,
        (Some(_), false) => What::Usb,
        (None, _) => What::Plain,
    };
    let (state, remark) = state(&port.name, what);
    Row {
        what,
        usb: port
            .usb
            .as_ref()
            .map(|usb| format!("{:04x}:{:04x}", usb.vid, usb.pid)),
        manufacturer: port.manufacturer().map(str::to_owned),
        serial: port.usb.and_then(|usb| usb.serial_number),
        name: Some(port.name),
        state,
        remark,
    }
}

fn state(name: &str, what: What) -> (State, String) {
    let holders = programs::holders(name);
    if !holders.is_empty() {
        let names: Vec<_> = holders.iter().map(ToString::to_string).collect();
        return (State::Busy, format!("in use by {}", names.join(", ")));
    }
    if access::barrier(name).is_some() {
        return denied();
    }
    if what != What::Board {
        return (State::Free, String::new());
    }
    match port::try_port(name) {
        Ok(()) => (State::Free, String::new()),
        Err((Cause::InUse, _)) => (State::Busy, "in use by another program".into()),
        Err((Cause::Denied, _)) => denied(),
        Err((Cause::Absent | Cause::Other, failure)) => (State::Broken, failure.sentence),
    }
}

fn denied() -> (State, String) {
    (
        State::Denied,
        "you may not open it: see `vrduino doctor`".into(),
    )
}

/// A line each, in columns.
fn table(rows: &[Row]) -> Vec<String> {
    let cells: Vec<[String; 4]> = rows.iter().map(cells).collect();
    let width = |column: usize| {
        let widths = cells.iter().map(|row| row[column].chars().count());
        widths.max().unwrap_or(0)
    };
    let widths = [width(0), width(1), width(2)];
    cells
        .iter()
        .map(|[name, what, made, state]| {
            let [a, b, c] = widths;
            let line = format!("{name:a$}  {what:b$}  {made:c$}  {state}");
            line.trim_end().to_owned()
        })
        .collect()
}

fn cells(row: &Row) -> [String; 4] {
    let what = match row.what {
        What::Board => "board".to_owned(),
        What::Loader => "Teensy in its loader".to_owned(),
        What::Usb => format!("other USB device {}", row.usb.as_deref().unwrap_or("")),
        What::Plain => "plain port".to_owned(),
    };
    let made: Vec<_> = [&row.manufacturer, &row.serial]
        .into_iter()
        .filter_map(Option::as_deref)
        .collect();
    let state = match row.state {
        State::Free if row.remark.is_empty() => "free".to_owned(),
        _ => row.remark.clone(),
    };
    [
        row.name.clone().unwrap_or_else(|| "–".into()),
        what,
        made.join(" "),
        state,
    ]
}

#[cfg(test)]
mod tests {
    use super::{Row, State, What, json, loader, row, table};
    use crate::source::port::Found;
    use serialport::UsbPortInfo;

    fn teensy() -> Found {
        Found {
            name: "/dev/there-is-no-such-port".into(),
            usb: Some(UsbPortInfo {
                vid: 0x16C0,
                pid: 0x0483,
                serial_number: Some("1234560".into()),
                manufacturer: Some("Teensyduino".into()),
                product: Some("USB Serial".into()),
            }),
        }
    }

    #[test]
    fn a_board_that_does_not_open_says_why() {
        let row = row(teensy());
        assert_eq!((row.what, row.state), (What::Board, State::Broken));
        assert!(row.remark.contains("is not there"), "{}", row.remark);
    }

    #[test]
    fn columns_stand_below_each_other() {
        let board = Row {
            name: Some("/dev/ttyACM0".into()),
            what: What::Board,
            usb: Some("16c0:0483".into()),
            manufacturer: Some("Teensyduino".into()),
            serial: Some("1234560".into()),
            state: State::Busy,
            remark: "in use by minicom (process 7)".into(),
        };
        assert_eq!(
            table(&[board, loader()]),
            [
                "/dev/ttyACM0  board                 Teensyduino 1234560  in use by minicom (process 7)",
                "–             Teensy in its loader                       `vrduino flash` puts a program on it",
            ]
        );
    }

    #[test]
    fn programs_get_what_is_known() {
        let json: serde_json::Value =
            serde_json::from_str(&json(&[row(teensy()), loader()]).unwrap()).unwrap();
        assert_eq!(json[0]["what"], "board");
        assert_eq!(json[0]["serial"], "1234560");
        assert_eq!(json[0]["state"], "broken");
        assert_eq!(json[1]["name"], serde_json::Value::Null);
        assert_eq!(json[1]["what"], "loader");
    }
}
