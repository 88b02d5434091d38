//! From the plug to the port.

use crate::computer::access::Barrier;
use crate::computer::{access, halfkay, programs, udev};
use crate::source::Choice;
use crate::source::port::{self, Found, MANUFACTURER, UDEV_RULE};

use super::check::Report;

/// Looks at the port that is meant; what is worth opening, if anything is.
pub fn look(choice: Choice, report: &mut Report) -> Option<Choice> {
    let name = match choice {
        Choice::Port(name) => name,
        Choice::Emulated(_) | Choice::Replay(_) => {
            report.note("the emulated board: no plug, no port");
            return Some(choice);
        }
    };
    if name.as_ref().is_some_and(|name| name.starts_with("tcp:")) {
        return Some(Choice::Port(name));
    }
    let ports = match port::ports() {
        Ok(ports) => ports,
        Err(failure) => {
            report.bad("the ports are not known", failure.sentence);
            return name.map(|name| Choice::Port(Some(name)));
        }
    };
    let found = match name {
        Some(name) => named(name, &ports, report)?,
        None => only(&ports, report)?,
    };
    identity(&found, report);
    let can_be_had = permission(&found.name, report) & unused(&found.name, report);
    if found.usb.is_some() {
        modem_manager(report);
    }
    can_be_had.then_some(Choice::Port(Some(found.name)))
}

fn named(name: String, ports: &[Found], report: &mut Report) -> Option<Found> {
    if let Some(found) = ports.iter().find(|port| port.name == name) {
        return Some(found.clone());
    }
    // A pseudo-terminal, or a link to a port, is in no list.
    if cfg!(unix) && !std::path::Path::new(&name).exists() {
        report.bad(
            format!("there is no port {name}"),
            "take one of those that `vrduino list --all` shows",
        );
        return None;
    }
    Some(Found { name, usb: None })
}

/// The one board there is.
fn only(ports: &[Found], report: &mut Report) -> Option<Found> {
    let mut boards = ports.iter().filter(|port| port.is_board());
    match (boards.next(), boards.next()) {
        (Some(board), None) => Some(board.clone()),
        (Some(_), Some(_)) => {
            report.bad(
                "several boards are plugged in",
                "choose one with --port (`vrduino list` shows them)",
            );
            None
        }
        (None, _) if halfkay::waiting() > 0 => {
            report.bad(
                "a Teensy is plugged in and waits in its loader: it has no program, or its button was pressed",
                "give it one with `vrduino flash`",
            );
            None
        }
        (None, _) => {
            report.bad(
                "no board is plugged in",
                "connect the board by USB\nif nothing happens: take a cable that carries data too, and another socket; press the board's button, whose loader shows in any case\nwithout a board: `vrduino doctor --emulate`",
            );
            None
        }
    }
}

/// Whether it is what the course's pages look for.
fn identity(found: &Found, report: &mut Report) {
    let name = &found.name;
    let Some(usb) = &found.usb else {
        report.note(format!(
            "{name} is no USB device: nothing is known of what is behind it"
        ));
        return;
    };
    if !found.is_board() {
        report.doubt(
            format!(
                "{name} is a USB device {:04x}:{:04x}, not a Teensy's 16c0:0483",
                usb.vid, usb.pid
            ),
            "is it the right port? `vrduino list` shows all",
        );
        return;
    }
    let serial = usb.serial_number.as_deref().unwrap_or("none");
    report.good(format!("{name} is a Teensy, serial number {serial}"));
    match found.manufacturer() {
        Some(maker) if maker.contains(MANUFACTURER) => {
            report.good(format!("its manufacturer is {maker}: the course's pages find it"));
        }
        Some(maker) => report.doubt(
            format!("its manufacturer is {maker}"),
            format!("the course's pages look for {MANUFACTURER}: flash it (`vrduino flash`), or name its port there"),
        ),
        // Windows names the driver's maker or none.
        None => report.note("this computer does not tell its manufacturer"),
    }
}

fn permission(name: &str, report: &mut Report) -> bool {
    let Some(Barrier { group }) = access::barrier(name) else {
        return true;
    };
    let mut advice = format!(
        "let every user of this computer use Teensys:\n{}",
        install_rule()
    );
    if let Some(group) = group {
        advice += &format!("\nor join its group, and log in anew: sudo usermod -aG {group} $USER");
    }
    report.bad(format!("you may not open {name}"), advice);
    false
}

/// The commands, ready to paste.
pub fn install_rule() -> String {
    let file = udev::FILE;
    format!(
        "  echo '{UDEV_RULE}' | sudo tee {file}\n  sudo udevadm control --reload-rules && sudo udevadm trigger\nthen plug the board in again"
    )
}

fn unused(name: &str, report: &mut Report) -> bool {
    let holders = programs::holders(name);
    if holders.is_empty() {
        return true;
    }
    let names: Vec<_> = holders.iter().map(ToString::to_string).collect();
    report.bad(
        format!("{name} is in use by {}", names.join(", ")),
        "close that program; or, if it is `vrduino view` or `vrduino serve`, let others look at what that one shows: it takes any number of viewers",
    );
    false
}

fn modem_manager(report: &mut Report) {
    if programs::is_running("ModemManager") && udev::rule().is_none() {
        report.doubt(
            "ModemManager runs: for some seconds after plugging in it may hold the port and type to the board",
            format!("tell it to leave Teensys alone:\n{}", install_rule()),
        );
    }
}
