//! Linux's rules for devices: whether there is one for Teensys.

use std::fs;
use std::path::{Path, PathBuf};

/// Where rules lie, the computer's own first.
const FOLDERS: [&str; 4] = [
    "/etc/udev/rules.d",
    "/run/udev/rules.d",
    "/usr/lib/udev/rules.d",
    "/lib/udev/rules.d",
];

/// Where ours goes: beside PJRC's `00-teensy.rules`, which stays as it is, and before systemd's
/// `73-seat-late.rules`, which reads the tag in it.
pub const FILE: &str = "/etc/udev/rules.d/70-vrduino.rules";

/// The rule that is there: the first file that opens Teensys to others than the superuser.
pub fn rule() -> Option<PathBuf> {
    FOLDERS.iter().find_map(|folder| rule_in(Path::new(folder)))
}

/// Whether this computer has such rules.
pub fn is_used() -> bool {
    FOLDERS.iter().any(|folder| Path::new(folder).is_dir())
}

fn rule_in(folder: &Path) -> Option<PathBuf> {
    let mut files: Vec<_> = fs::read_dir(folder)
        .ok()?
        .flatten()
        .map(|entry| entry.path())
        .collect();
    files.sort();
    files
        .into_iter()
        .find(|path| fs::read_to_string(path).is_ok_and(|text| opens_teensys(&text)))
}

/// Whether a line that is no comment is about PJRC's vendor number and lets others in.
fn opens_teensys(rules: &str) -> bool {
    rules
        .lines()
        .map(|line| line.trim().to_ascii_lowercase())
        .filter(|line| !line.starts_with('#'))
        .any(|line| {
            line.contains("\"16c0\"") && (line.contains("mode") || line.contains("uaccess"))
        })
}

#[cfg(test)]
mod tests {
    use super::{FILE, opens_teensys};
    use crate::source::port::UDEV_RULE;

    #[test]
    fn our_rule_and_pjrcs_open_teensys_and_others_do_not() {
        assert!(opens_teensys(UDEV_RULE));
        assert!(opens_teensys(
            "# x\nKERNEL==\"ttyACM*\", ATTRS{idVendor}==\"16c0\", ATTRS{idProduct}==\"04*\", MODE:=\"0666\"\n"
        ));
        assert!(!opens_teensys(&format!("# {UDEV_RULE}")));
        assert!(!opens_teensys(
            "ATTRS{idVendor}==\"16c0\", ENV{ID_MM_DEVICE_IGNORE}=\"1\"\nATTRS{idVendor}==\"0403\", MODE=\"0666\"\n"
        ));
    }

    #[test]
    fn our_file_takes_no_other_s_place_and_is_read_before_its_tag_is() {
        let (_, name) = FILE.rsplit_once('/').unwrap();
        assert_ne!(name, "00-teensy.rules");
        assert!(UDEV_RULE.contains("TAG+=\"uaccess\"") && name < "73-seat-late.rules");
    }
}
