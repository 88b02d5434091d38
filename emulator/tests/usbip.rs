//! The emulated device over USB/IP, as a Linux kernel uses it: our image on the board, and a client of the tests' own on
//! the other end of the connection. `linux.rs` has a real kernel there.

#[path = "usbip/client.rs"]
mod client;

use std::io::{Read, Write};

use client::{Client, Offer, Reply};

/// Linux's numbers.
const OK: i32 = 0;
const ENOENT: i32 = -2;
const EINVAL: i32 = -22;
const EPIPE: i32 = -32;
const ECONNRESET: i32 = -104;

const DEVICE_DESCRIPTOR: [u8; 8] = [0x80, 6, 0, 1, 0, 0, 18, 0];
const DEVICE_QUALIFIER: [u8; 8] = [0x80, 6, 0, 6, 0, 0, 10, 0];
const SET_CONFIGURATION: [u8; 8] = [0, 9, 1, 0, 0, 0, 0, 0];
const SET_LINE_CODING: [u8; 8] = [0x21, 0x20, 0, 0, 0, 0, 7, 0];
const GET_LINE_CODING: [u8; 8] = [0xA1, 0x21, 0, 0, 0, 0, 7, 0];
const DTR_ON: [u8; 8] = [0x21, 0x22, 3, 0, 0, 0, 0, 0];
const DTR_OFF: [u8; 8] = [0x21, 0x22, 0, 0, 0, 0, 0, 0];

/// The endpoints of the image's serial port, from its own descriptors.
struct Port {
    notifications: u8,
    bulk_in: u8,
    bulk_out: u8,
}

/// What a kernel does between attaching the device and opening its port.
fn configure(client: &mut Client) -> Port {
    let device = client.control(DEVICE_DESCRIPTOR, &[]);
    assert_eq!((device.status, device.data.len()), (OK, 18));
    let head = client.control([0x80, 6, 0, 2, 0, 0, 9, 0], &[]);
    let [low, high] = [head.data[2], head.data[3]];
    let all = client.control([0x80, 6, 0, 2, 0, 0, low, high], &[]);
    assert_eq!(all.data.len(), usize::from(u16::from_le_bytes([low, high])));
    let endpoint = |attributes: u8, is_in: bool| {
        let mut rest = all.data.as_slice();
        loop {
            let (descriptor, more) = rest.split_at(usize::from(rest[0]));
            if let [7, 5, address, kind, ..] = *descriptor
                && kind == attributes
                && (address & 0x80 != 0) == is_in
            {
                return address & 0xF;
            }
            rest = more;
        }
    };
    assert_eq!(client.control(SET_CONFIGURATION, &[]).status, OK);
    Port {
        notifications: endpoint(3, true),
        bulk_in: endpoint(2, true),
        bulk_out: endpoint(2, false),
    }
}

/// Opens the port as cdc_acm does: 16 reads and one for notifications stay pending.
fn open(client: &mut Client, port: &Port) -> Vec<u32> {
    let coding = [0x80, 0x25, 0, 0, 0, 0, 8];
    assert_eq!(client.control(SET_LINE_CODING, &coding).status, OK);
    assert_eq!(client.control(DTR_ON, &[]).status, OK);
    let mut reads = vec![client.read(port.notifications, 64)];
    reads.extend((0..16).map(|_| client.read(port.bulk_in, 128)));
    reads
}

/// Reads until `text` has come, renewing every read that was answered.
fn read_until(client: &mut Client, port: &Port, text: &str) -> String {
    let mut stream = String::new();
    while !stream.contains(text) {
        let Reply { status, data, .. } = client.reply();
        assert_eq!(status, OK, "after {stream:?}");
        assert!(stream.len() < 100_000, "no {text:?} in {stream}");
        stream.push_str(std::str::from_utf8(&data).expect("text"));
        client.read(port.bulk_in, 128);
    }
    stream
}

#[test]
fn the_device_list_says_what_the_descriptors_say() {
    let offer = Offer::new();
    let list = offer.list();
    // Header and one device, then its two interfaces: communication and data.
    assert_eq!(list.len(), 12 + 312 + 2 * 4);
    assert_eq!(list[..12], [1, 0x11, 0, 5, 0, 0, 0, 0, 0, 0, 0, 1]);
    assert_eq!(list[12 + 256..12 + 260], *b"1-1\0");
    assert_eq!(list[12 + 300..12 + 304], [0x16, 0xC0, 0x04, 0x83]);
    assert_eq!((list[12 + 312], list[12 + 316]), (0x02, 0x0A));
    offer.end();
}

#[test]
fn a_client_configures_the_device_opens_its_port_and_reads_the_stream() {
    let offer = Offer::new();
    let mut client = offer.import();
    let port = configure(&mut client);
    let refused = client.control(DEVICE_QUALIFIER, &[]);
    assert_eq!((refused.status, refused.count), (EPIPE, 0));
    open(&mut client, &port);
    let stream = read_until(&mut client, &port, "QC ");
    assert!(stream.contains("vrduino "), "no banner in {stream}");
    let coding = client.control(GET_LINE_CODING, &[]);
    assert_eq!(coding.data, [0x80, 0x25, 0, 0, 0, 0, 8]);
    // Keys under traffic; then the port is closed and opened, which the firmware sees by DTR.
    let sent = client.write(port.bulk_out, b"2");
    let answer = client.answer_to(sent);
    assert_eq!((answer.status, answer.count), (OK, 1));
    read_until(&mut client, &port, "EA ");
    assert_eq!(client.control(DTR_OFF, &[]).status, OK);
    assert_eq!(client.control(DTR_ON, &[]).status, OK);
    read_until(&mut client, &port, "vrduino ");
    offer.end();
}

#[test]
fn a_transfer_is_unlinked_before_after_and_without_its_submit() {
    let offer = Offer::new();
    let mut client = offer.import();
    let port = configure(&mut client);
    // Pending: given up, and not answered any more.
    let pending = client.read(port.notifications, 64);
    let unlink = client.unlink(pending);
    assert_eq!(client.reply(), unlinked(unlink, ECONNRESET));
    // Answered: nothing left to give up.
    let done = client.next_number();
    client.send(&Client::submit_bytes(
        done,
        0,
        Some(18),
        &[],
        DEVICE_DESCRIPTOR,
    ));
    assert_eq!(client.answer_to(done).status, OK);
    let unlink = client.unlink(done);
    assert_eq!(client.reply(), unlinked(unlink, OK));
    // Not there yet: given up, and dropped when it comes.
    let late = client.next_number();
    let unlink = client.unlink(late);
    assert_eq!(client.reply(), unlinked(unlink, ECONNRESET));
    client.send(&Client::submit_bytes(
        late,
        0,
        Some(18),
        &[],
        DEVICE_DESCRIPTOR,
    ));
    let next = client.control(DEVICE_DESCRIPTOR, &[]);
    assert_eq!((next.status, next.data.len()), (OK, 18));
    // Everything at once, as when the port is closed under traffic; then it works as before.
    let reads = open(&mut client, &port);
    read_until(&mut client, &port, "QC ");
    for number in reads[0]..=client.next_number() {
        client.unlink(number);
    }
    assert_eq!(client.control(DTR_OFF, &[]).status, OK);
    open(&mut client, &port);
    loop {
        // What was pending comes to an end one way or the other; then the stream goes on.
        let reply = client.reply();
        assert!(matches!(reply.status, OK | ECONNRESET), "{reply:?}");
        if reply.data.starts_with(b"QC ") || reply.data.windows(4).any(|part| part == b"\nQC ") {
            break;
        }
    }
    offer.end();
}

fn unlinked(number: u32, status: i32) -> Reply {
    Reply {
        command: 4,
        number,
        status,
        count: 0,
        data: Vec::new(),
    }
}

#[test]
fn requests_that_cannot_be_are_answered_with_an_error() {
    let offer = Offer::new();
    let mut client = offer.import();
    let port = configure(&mut client);
    let nowhere = client.read(9, 64);
    assert_eq!(client.answer_to(nowhere).status, ENOENT);
    // A data stage that is not as long as wLength says.
    let wrong = client.next_number();
    client.send(&Client::submit_bytes(
        wrong,
        0,
        Some(17),
        &[],
        DEVICE_DESCRIPTOR,
    ));
    assert_eq!(client.answer_to(wrong).status, EINVAL);
    // A halted endpoint refuses until the halt is cleared.
    let address = 0x80 | port.bulk_in;
    let halt = |request| [0x02, request, 0, 0, address, 0, 0, 0];
    assert_eq!(client.control(halt(3), &[]).status, OK);
    let read = client.read(port.bulk_in, 128);
    assert_eq!(client.answer_to(read).status, EPIPE);
    assert_eq!(client.control(halt(1), &[]).status, OK);
    open(&mut client, &port);
    read_until(&mut client, &port, "QC ");
    offer.end();
}

#[test]
fn one_has_the_device_and_the_next_gets_it_afterwards() {
    let offer = Offer::new();
    let mut first = offer.import();
    let port = configure(&mut first);
    open(&mut first, &port);
    read_until(&mut first, &port, "QC ");
    // ST_DEV_BUSY and ST_NODEV.
    assert_eq!(offer.ask_for("1-1").0, 2);
    assert_eq!(offer.ask_for("7-3").0, 4);
    assert_eq!(offer.list().len(), 12 + 312 + 2 * 4);
    // Gone under traffic.
    drop(first);
    for _ in 0..3 {
        let mut next = offer.import();
        let port = configure(&mut next);
        open(&mut next, &port);
        read_until(&mut next, &port, "QC ");
    }
    let notes = offer.end();
    let attached = notes
        .iter()
        .filter(|note| note.ends_with("has attached the device"));
    assert_eq!(attached.count(), 4, "{notes:?}");
}

#[test]
fn an_unplugged_device_closes_the_connection_and_comes_back() {
    let offer = Offer::new();
    let mut client = offer.import();
    let port = configure(&mut client);
    open(&mut client, &port);
    read_until(&mut client, &port, "QC ");
    offer.set_plugged(false);
    assert!(client.is_closed());
    offer.set_plugged(true);
    let mut client = offer.import();
    let port = configure(&mut client);
    open(&mut client, &port);
    read_until(&mut client, &port, "QC ");
    offer.end();
}

#[test]
fn garbage_closes_its_own_connection_only() {
    let offer = Offer::new();
    // Another version, an unknown operation, and noise.
    for bytes in [&[1, 6, 0x80, 5], &[1, 0x11, 0x80, 9], b"GET "] {
        let mut stream = offer.connect();
        stream.write_all(bytes).unwrap();
        let mut rest = Vec::new();
        let _ = stream.read_to_end(&mut rest);
        assert_eq!(rest, []);
    }
    // Half a header is waited for; its end is as good as none.
    let mut half = offer.connect();
    half.write_all(&[1, 0x11, 0x80]).unwrap();
    drop(half);
    let [command, direction, endpoint, length, packets] = [3, 15, 19, 24, 32];
    for (at, byte) in [
        (command, 9),
        (direction, 2),
        (endpoint, 16),
        (length, 0x7F),
        (packets, 1),
    ] {
        let mut client = offer.import();
        let mut bytes = Client::submit_bytes(1, 0, Some(18), &[], DEVICE_DESCRIPTOR);
        bytes[at] = byte;
        client.send(&bytes);
        assert!(client.is_closed(), "byte {at} = {byte}");
    }
    // A number that is in use.
    let mut client = offer.import();
    let port = configure(&mut client);
    let pending = client.read(port.notifications, 64);
    client.send(&Client::submit_bytes(
        pending,
        port.notifications,
        Some(64),
        &[],
        [0; 8],
    ));
    assert!(client.is_closed());
    // Half a command, then gone.
    let mut client = offer.import();
    client.send(&Client::submit_bytes(1, 0, Some(18), &[], DEVICE_DESCRIPTOR)[..47]);
    drop(client);
    // And the device lives on.
    let mut client = offer.import();
    configure(&mut client);
    let notes = offer.end();
    let refused = notes
        .iter()
        .filter(|note| note.contains("speaks no USB/IP"));
    assert_eq!(refused.count(), 9, "{notes:?}");
}
