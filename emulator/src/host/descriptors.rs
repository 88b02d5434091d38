//! What a device says about itself: the descriptors of USB 2.0, 9.6, as far as the bus depends on them.

/// How an endpoint's packets are scheduled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Isochronous,
    Bulk,
    Interrupt,
}

/// An endpoint of a configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Endpoint {
    pub interface: u8,
    pub alternate: u8,
    /// bInterfaceClass.
    pub class: u8,
    /// bEndpointAddress: the number, with bit 7 for IN.
    pub address: u8,
    pub kind: Kind,
    /// wMaxPacketSize.
    pub packet: usize,
    /// bInterval.
    interval: u8,
}

impl Endpoint {
    /// Without the direction.
    pub fn number(self) -> u8 {
        self.address & 0xF
    }

    /// Whether it sends to the host.
    pub fn is_in(self) -> bool {
        self.address & 0x80 != 0
    }

    /// Frames from one turn to the next. As controllers do it: the power of two below bInterval, 32 at most.
    pub fn frames(self) -> u8 {
        match self.kind {
            Kind::Interrupt => 1 << self.interval.max(1).ilog2().min(5),
            _ => 1,
        }
    }
}

impl std::fmt::Display for Endpoint {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "endpoint {:#04x}", self.address)
    }
}

/// An interface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Interface {
    /// bInterfaceNumber.
    pub number: u8,
    /// bInterfaceClass, bInterfaceSubClass and bInterfaceProtocol.
    pub class: [u8; 3],
}

/// A configuration.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Configuration {
    /// bConfigurationValue.
    pub value: u8,
    /// Each interface's first setting.
    pub interfaces: Vec<Interface>,
    pub endpoints: Vec<Endpoint>,
}

impl Configuration {
    /// Reads a whole configuration descriptor.
    ///
    /// # Errors
    ///
    /// What a host objects to, in a sentence.
    pub fn parse(bytes: &[u8]) -> Result<Configuration, String> {
        let [9, 2, low, high, interfaces, value, ..] = *bytes else {
            return Err("the configuration does not begin with a configuration descriptor".into());
        };
        if usize::from(u16::from_le_bytes([low, high])) != bytes.len() {
            return Err(format!(
                "wTotalLength does not fit the {} bytes of the configuration",
                bytes.len()
            ));
        }
        let mut found = Configuration {
            value,
            ..Configuration::default()
        };
        let mut rest = &bytes[9..];
        let mut interface = None;
        while let [length, kind, ..] = *rest {
            let Some(descriptor) = rest.get(..usize::from(length)).filter(|_| length >= 2) else {
                return Err("a descriptor in the configuration has an impossible length".into());
            };
            match (kind, descriptor) {
                (4, &[_, _, number, alternate, _, class, subclass, protocol, ..]) => {
                    interface = Some((number, alternate, class));
                    if alternate == 0 {
                        found.interfaces.push(Interface {
                            number,
                            class: [class, subclass, protocol],
                        });
                    }
                }
                (5, &[_, _, address, attributes, low, high, interval, ..]) => {
                    let interface = interface.ok_or("an endpoint comes before any interface")?;
                    let packet = u16::from_le_bytes([low, high]);
                    let endpoint = endpoint(interface, address, attributes, packet, interval)?;
                    found.endpoints.push(endpoint);
                }
                (4 | 5, _) => return Err("an interface or endpoint descriptor is too short".into()),
                _ => {}
            }
            rest = &rest[usize::from(length)..];
        }
        if !rest.is_empty() {
            return Err("the configuration ends within a descriptor".into());
        }
        if found.interfaces.len() != usize::from(interfaces) {
            return Err(format!(
                "bNumInterfaces is {interfaces}, but {} interfaces are described",
                found.interfaces.len()
            ));
        }
        Ok(found)
    }
}

/// An endpoint as its descriptor says, if full speed allows it (USB 2.0, 5.5.3 to 5.8.3 and 9.6.6).
fn endpoint(
    (interface, alternate, class): (u8, u8, u8),
    address: u8,
    attributes: u8,
    packet: u16,
    interval: u8,
) -> Result<Endpoint, String> {
    let (kind, legal) = match attributes & 3 {
        1 => (Kind::Isochronous, packet <= 1023),
        2 => (Kind::Bulk, matches!(packet, 8 | 16 | 32 | 64)),
        3 => (Kind::Interrupt, packet <= 64 && interval > 0),
        _ => {
            return Err(format!(
                "endpoint {address:#04x} is a second control endpoint"
            ));
        }
    };
    if address & 0x70 != 0 || address & 0xF == 0 {
        return Err(format!("{address:#04x} is no endpoint's address"));
    }
    if !legal {
        return Err(format!(
            "endpoint {address:#04x}: {kind:?} with packets of {packet} bytes and interval {interval} is illegal at full speed"
        ));
    }
    Ok(Endpoint {
        interface,
        alternate,
        class,
        address,
        kind,
        packet: usize::from(packet),
        interval,
    })
}

/// The text of a string descriptor.
///
/// # Errors
///
/// What is wrong with it.
pub(super) fn string(descriptor: &[u8]) -> Result<String, String> {
    match descriptor {
        [length, 3, text @ ..]
            if usize::from(*length) == descriptor.len() && text.len() % 2 == 0 =>
        {
            let units: Vec<u16> = text
                .chunks_exact(2)
                .map(|pair| u16::from_le_bytes([pair[0], pair[1]]))
                .collect();
            Ok(String::from_utf16_lossy(&units))
        }
        _ => Err("a malformed string descriptor".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One interface, one bulk IN endpoint.
    const SMALL: [u8; 25] = [
        9, 2, 25, 0, 1, 1, 0, 0xC0, 50, 9, 4, 0, 0, 1, 0xFF, 0, 0, 0, 7, 5, 0x81, 2, 64, 0, 0,
    ];

    #[test]
    fn a_configuration_is_taken_apart() {
        let found = Configuration::parse(&SMALL).unwrap();
        assert_eq!((found.value, found.interfaces.len()), (1, 1));
        assert_eq!(found.endpoints[0].address, 0x81);
        assert_eq!(found.endpoints[0].kind, Kind::Bulk);
    }

    #[test]
    fn illegal_configurations_are_refused() {
        for (at, value) in [
            (2, 24),
            (4, 2),
            (9, 0),
            (18, 3),
            (20, 0x80),
            (22, 65),
            (21, 0),
        ] {
            let mut bytes = SMALL;
            bytes[at] = value;
            assert!(Configuration::parse(&bytes).is_err(), "byte {at} = {value}");
        }
        for end in 0..SMALL.len() {
            assert!(Configuration::parse(&SMALL[..end]).is_err());
        }
    }

    #[test]
    fn interrupt_endpoints_are_polled_at_powers_of_two() {
        let frames = |interval| endpoint((0, 0, 2), 0x82, 3, 16, interval).unwrap().frames();
        assert_eq!([1, 2, 3, 10, 64, 255].map(frames), [1, 2, 2, 8, 32, 32]);
    }
}
