//! The bytes of USB/IP 1.1.1 (Linux, Documentation/usb/usbip_protocol.rst): all numbers big-endian.

use crate::host::Profile;

/// 1.1.1
const VERSION: u16 = 0x0111;

const OP_REQ_DEVLIST: u16 = 0x8005;
const OP_REP_DEVLIST: u16 = 0x0005;
const OP_REQ_IMPORT: u16 = 0x8003;
const OP_REP_IMPORT: u16 = 0x0003;

const CMD_SUBMIT: u32 = 1;
const CMD_UNLINK: u32 = 2;
const RET_SUBMIT: u32 = 3;
const RET_UNLINK: u32 = 4;

/// Bytes of an operation's header, of a bus ID, and of a command's or reply's header.
const OPERATION: usize = 8;
const BUS_ID: usize = 32;
const HEADER: usize = 48;
/// Bytes of an isochronous packet's descriptor.
const PACKET: usize = 16;

/// URB_SHORT_NOT_OK and URB_ZERO_PACKET.
const SHORT_NOT_OK: u32 = 0x01;
const ZERO_PACKET: u32 = 0x40;

/// More than any driver asks for at once; a larger length is a mistake or an attack.
pub(super) const LONGEST_TRANSFER: usize = 1 << 20;

/// Bytes that may wait to be sent before no more commands are taken, and to be read before no more are.
pub(super) const CONGESTED: usize = 2 * LONGEST_TRANSFER;
/// The same for isochronous packets.
const MOST_PACKETS: usize = 1024;

/// Full speed, as the kernel's `enum usb_device_speed` numbers it.
const FULL_SPEED: u32 = 2;

/// Status of the reply to an import.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Status {
    /// Here it is.
    Ok = 0,
    /// Not to be had.
    NotAvailable = 1,
    /// Somebody else has it.
    Busy = 2,
    /// There is no such device.
    NoDevice = 4,
}

/// What a new connection asks for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Operation {
    /// Which devices there are.
    List,
    /// The device with this bus ID.
    Import(String),
}

/// What the importing host asks for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Command {
    /// A transfer.
    Submit(Submit),
    /// To give up the transfer `victim`.
    Unlink {
        /// This command's own number.
        number: u32,
        /// The transfer's number.
        victim: u32,
    },
}

/// A transfer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Submit {
    pub number: u32,
    pub endpoint: u8,
    pub is_in: bool,
    /// Whether a short packet is an error.
    pub short_not_ok: bool,
    /// Whether an empty packet follows when the last one is full.
    pub zero_packet: bool,
    /// The room for data, or the length of `data`.
    pub length: usize,
    /// Whether it is in isochronous packets.
    pub isochronous: bool,
    pub setup: [u8; 8],
    pub data: Vec<u8>,
}

/// What bytes have that are not USB/IP, in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Malformed(pub String);

/// A message off the front of what was received, if it is there in whole.
type Taken<T> = Result<Option<T>, Malformed>;

fn number(bytes: &[u8; HEADER], at: usize) -> u32 {
    u32::from_be_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

/// Reads what a new connection asks for.
pub(super) fn take_operation(bytes: &mut Vec<u8>) -> Taken<Operation> {
    let Some(&[high, low, code_high, code_low]) = bytes.first_chunk() else {
        return Ok(None);
    };
    let version = u16::from_be_bytes([high, low]);
    if version != VERSION {
        return Err(Malformed(format!(
            "version {version:#06x} where 1.1.1 is {VERSION:#06x}"
        )));
    }
    match u16::from_be_bytes([code_high, code_low]) {
        OP_REQ_DEVLIST if bytes.len() >= OPERATION => {
            bytes.drain(..OPERATION);
            Ok(Some(Operation::List))
        }
        OP_REQ_IMPORT if bytes.len() >= OPERATION + BUS_ID => {
            let name: Vec<u8> = bytes
                .drain(..OPERATION + BUS_ID)
                .skip(OPERATION)
                .take_while(|&byte| byte != 0)
                .collect();
            let name = String::from_utf8_lossy(&name).into_owned();
            Ok(Some(Operation::Import(name)))
        }
        OP_REQ_DEVLIST | OP_REQ_IMPORT => Ok(None),
        code => Err(Malformed(format!("unknown operation {code:#06x}"))),
    }
}

/// Reads the importing host's next command.
pub(super) fn take_command(bytes: &mut Vec<u8>) -> Taken<Command> {
    let Some(&header) = bytes.first_chunk::<HEADER>() else {
        return Ok(None);
    };
    match number(&header, 0) {
        CMD_UNLINK => {
            bytes.drain(..HEADER);
            Ok(Some(Command::Unlink {
                number: number(&header, 4),
                victim: number(&header, 20),
            }))
        }
        CMD_SUBMIT => take_submit(bytes, &header),
        command => Err(Malformed(format!("unknown command {command:#x}"))),
    }
}

fn take_submit(bytes: &mut Vec<u8>, header: &[u8; HEADER]) -> Taken<Command> {
    let is_in = match number(header, 12) {
        0 => false,
        1 => true,
        direction => return Err(Malformed(format!("direction {direction}"))),
    };
    let endpoint = number(header, 16);
    if endpoint > 15 {
        return Err(Malformed(format!("endpoint {endpoint}")));
    }
    let flags = number(header, 20);
    let length = number(header, 24) as usize;
    // -1 and 0 both mean a transfer that is not isochronous.
    let packets = match number(header, 32) {
        u32::MAX => 0,
        packets => packets as usize,
    };
    if length > LONGEST_TRANSFER || packets > MOST_PACKETS {
        return Err(Malformed(format!(
            "a transfer of {length} bytes and {packets} isochronous packets; {LONGEST_TRANSFER} and {MOST_PACKETS} at \
             most are taken"
        )));
    }
    let sent = if is_in { 0 } else { length };
    let whole = HEADER + sent + PACKET * packets;
    if bytes.len() < whole {
        return Ok(None);
    }
    let data = bytes[HEADER..HEADER + sent].to_vec();
    bytes.drain(..whole);
    let [.., a, b, c, d, e, f, g, h] = *header;
    Ok(Some(Command::Submit(Submit {
        number: number(header, 4),
        endpoint: endpoint as u8,
        is_in,
        short_not_ok: flags & SHORT_NOT_OK != 0,
        zero_packet: flags & ZERO_PACKET != 0,
        length,
        isochronous: packets > 0,
        setup: [a, b, c, d, e, f, g, h],
        data,
    })))
}

/// The reply to [`Operation::List`].
pub(super) fn device_list(bus_id: &str, device: Option<&Profile>) -> Vec<u8> {
    let mut reply = operation(OP_REP_DEVLIST, Status::Ok);
    reply.extend(u32::from(device.is_some()).to_be_bytes());
    if let Some(profile) = device {
        reply.extend(describe(bus_id, profile));
        for interface in profile.interfaces() {
            reply.extend(interface.class);
            reply.push(0);
        }
    }
    reply
}

/// The reply to [`Operation::Import`] that gives the device.
pub(super) fn imported(bus_id: &str, device: &Profile) -> Vec<u8> {
    let mut reply = operation(OP_REP_IMPORT, Status::Ok);
    reply.extend(describe(bus_id, device));
    reply
}

/// The reply to [`Operation::Import`] that refuses it.
pub(super) fn refused(status: Status) -> Vec<u8> {
    operation(OP_REP_IMPORT, status)
}

fn operation(code: u16, status: Status) -> Vec<u8> {
    let mut reply = Vec::new();
    reply.extend(VERSION.to_be_bytes());
    reply.extend(code.to_be_bytes());
    reply.extend((status as u32).to_be_bytes());
    reply
}

/// A device: path, bus ID, bus and device number, speed, then what its descriptors say.
fn describe(bus_id: &str, profile: &Profile) -> Vec<u8> {
    let text = |text: &str, size: usize| {
        let mut bytes = text.as_bytes().to_vec();
        bytes.resize(size, 0);
        bytes
    };
    let device = |at: usize| profile.device.get(at).copied().unwrap_or(0);
    let mut described = text(&format!("/sys/devices/vrduino-emulator/{bus_id}"), 256);
    described.extend(text(bus_id, BUS_ID));
    for value in [1, 1, FULL_SPEED] {
        described.extend(u32::to_be_bytes(value));
    }
    // idVendor, idProduct and bcdDevice are little-endian in their descriptor.
    for at in [8, 10, 12] {
        described.extend([device(at + 1), device(at)]);
    }
    described.extend([device(4), device(5), device(6)]);
    described.extend([
        profile.configuration_value(),
        device(17),
        profile.interfaces().len() as u8,
    ]);
    described
}

/// RET_SUBMIT: `moved` bytes went one way or the other, and `data` came.
pub(super) fn submitted(number: u32, status: i32, moved: usize, data: &[u8]) -> Vec<u8> {
    let mut reply = returned(RET_SUBMIT, number, status);
    reply[24..28].copy_from_slice(&(moved as u32).to_be_bytes());
    reply.extend(data);
    reply
}

/// RET_UNLINK.
pub(super) fn unlinked(number: u32, status: i32) -> Vec<u8> {
    returned(RET_UNLINK, number, status)
}

fn returned(command: u32, number: u32, status: i32) -> Vec<u8> {
    let mut reply = vec![0; HEADER];
    reply[0..4].copy_from_slice(&command.to_be_bytes());
    reply[4..8].copy_from_slice(&number.to_be_bytes());
    reply[20..24].copy_from_slice(&status.to_be_bytes());
    reply
}
