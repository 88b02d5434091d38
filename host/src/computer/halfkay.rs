//! A Teensy in its loader, HalfKay: a USB device that is no serial port.

use std::fs;
use std::path::Path;

/// Where Linux lists what is on the USB.
const DEVICES: &str = "/sys/bus/usb/devices";

/// PJRC's vendor number and HalfKay's product number.
const NUMBERS: [&str; 2] = ["16c0", "0478"];

/// How many Teensys wait in their loader; none is also what a computer says that does not know.
pub fn waiting() -> usize {
    among(Path::new(DEVICES))
}

fn among(devices: &Path) -> usize {
    let Ok(entries) = fs::read_dir(devices) else {
        return 0;
    };
    let is = |folder: &Path, file: &str, wanted: &str| {
        fs::read_to_string(folder.join(file)).is_ok_and(|number| number.trim() == wanted)
    };
    let [vendor, product] = NUMBERS;
    entries
        .flatten()
        .map(|entry| entry.path())
        .filter(|folder| is(folder, "idVendor", vendor) && is(folder, "idProduct", product))
        .count()
}

#[cfg(test)]
mod tests {
    use super::among;
    use std::fs;

    #[test]
    fn a_loader_is_known_by_its_numbers() {
        let devices = std::env::temp_dir().join(format!("vrduino-halfkay-{}", std::process::id()));
        for (name, vendor, product) in [
            ("1-1", "16c0\n", "0483\n"),
            ("1-2", "16c0\n", "0478\n"),
            ("1-3", "1d6b\n", "0478\n"),
        ] {
            let folder = devices.join(name);
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join("idVendor"), vendor).unwrap();
            fs::write(folder.join("idProduct"), product).unwrap();
        }
        fs::create_dir_all(devices.join("usb1-port1")).unwrap();
        assert_eq!(among(&devices), 1);
        assert_eq!(among(&devices.join("1-1")), 0);
        fs::remove_dir_all(&devices).unwrap();
        assert_eq!(among(&devices), 0);
    }
}
