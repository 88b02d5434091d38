//! A little USB/IP client of the tests' own, and a board that offers its device to it.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread::JoinHandle;
use std::time::Duration;

use vrduino_emulator::board::{Board, Setup};
use vrduino_emulator::firmware::{self, BuildOptions};
use vrduino_emulator::host::Host;
use vrduino_emulator::image::Image;
use vrduino_emulator::motion::turns::Turns;
use vrduino_emulator::time::MILLISECOND;
use vrduino_emulator::usbip::Server;
use vrduino_emulator::witness::Stop;

/// Long enough for the slowest machine; a test that waits for it has failed.
const NEVER_THAT_LONG: Duration = Duration::from_secs(120);

/// A board that runs in a thread of its own, with its device on a loopback port.
pub struct Offer {
    address: SocketAddr,
    plug: Sender<bool>,
    thread: Option<JoinHandle<(Option<Stop>, Vec<String>)>>,
}

impl Offer {
    pub fn new() -> Offer {
        let path = firmware::build(BuildOptions { quiet: true }).expect("the firmware builds");
        let image = Image::open(&path).expect("the emulator accepts the firmware");
        let (plug, orders) = channel();
        let (tell, told) = channel();
        let thread = std::thread::spawn(move || run(image, &orders, &tell));
        Offer {
            address: told.recv().expect("the server listens"),
            plug,
            thread: Some(thread),
        }
    }

    /// A connection that has not said anything yet.
    pub fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.address).expect("the server accepts");
        stream.set_read_timeout(Some(NEVER_THAT_LONG)).unwrap();
        stream
    }

    pub fn set_plugged(&self, plugged: bool) {
        self.plug.send(plugged).expect("the board runs");
    }

    /// Asks which devices there are.
    pub fn list(&self) -> Vec<u8> {
        let mut stream = self.connect();
        stream.write_all(&[1, 0x11, 0x80, 5, 0, 0, 0, 0]).unwrap();
        let mut reply = Vec::new();
        stream
            .read_to_end(&mut reply)
            .expect("a reply, then the end");
        reply
    }

    /// Asks for a device; the status of the reply, and the connection.
    pub fn ask_for(&self, bus_id: &str) -> (u32, TcpStream) {
        let mut stream = self.connect();
        let mut request = vec![1, 0x11, 0x80, 3, 0, 0, 0, 0];
        request.extend(bus_id.as_bytes());
        request.resize(40, 0);
        stream.write_all(&request).unwrap();
        let mut head = [0; 8];
        stream.read_exact(&mut head).expect("a reply");
        assert_eq!(head[..4], [1, 0x11, 0, 3]);
        (
            u32::from_be_bytes([head[4], head[5], head[6], head[7]]),
            stream,
        )
    }

    /// Has the device.
    pub fn import(&self) -> Client {
        let (status, mut stream) = self.ask_for("1-1");
        assert_eq!(status, 0, "the import was refused");
        let mut device = [0; 312];
        stream.read_exact(&mut device).unwrap();
        // Bus 1, device 1, full speed; then what the descriptors say.
        assert_eq!(device[288..300], [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 2]);
        assert_eq!(device[300..304], [0x16, 0xC0, 0x04, 0x83]);
        Client {
            stream,
            number: 0,
            writes: Vec::new(),
            early: Vec::new(),
        }
    }

    /// Ends the run; nothing may have been wrong with the firmware. What the server had to tell.
    pub fn end(mut self) -> Vec<String> {
        let thread = self.thread.take().expect("it runs");
        // Without anybody to give orders the board stops.
        self.plug = channel().0;
        let (stop, notes) = thread.join().expect("the board runs to the end");
        assert_eq!(stop, None);
        notes
    }
}

fn run(
    image: Image,
    orders: &Receiver<bool>,
    tell: &Sender<SocketAddr>,
) -> (Option<Stop>, Vec<String>) {
    let mut board = Board::new(image, Setup::new(Box::new(Turns::new(1e6, 0.0))));
    board.chip().host = Host::exporting();
    let mut server = Server::open(0).expect("a free port");
    let mut notes = Vec::new();
    tell.send(server.address()).expect("the test waits");
    loop {
        match orders.try_recv() {
            Ok(plugged) => board.chip().host.set_plugged(plugged),
            Err(TryRecvError::Empty) => {}
            Err(TryRecvError::Disconnected) => break,
        }
        if board.stop().is_some() {
            break;
        }
        board.run(MILLISECOND);
        server.serve(&mut board);
        notes.extend(server.take_notes());
    }
    (board.stop().cloned(), notes)
}

/// A reply to a SUBMIT (command 3) or an UNLINK (4).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reply {
    pub command: u32,
    pub number: u32,
    pub status: i32,
    pub count: usize,
    pub data: Vec<u8>,
}

/// Who has the device.
pub struct Client {
    pub stream: TcpStream,
    number: u32,
    /// Transfers whose reply has a count and no data.
    writes: Vec<u32>,
    /// Replies that came while another was waited for.
    early: Vec<Reply>,
}

impl Client {
    /// The number that the next command gets.
    pub fn next_number(&mut self) -> u32 {
        self.number += 1;
        self.number
    }

    /// A SUBMIT's bytes: the data, or room for `length` bytes of it.
    pub fn submit_bytes(
        number: u32,
        endpoint: u8,
        room: Option<usize>,
        data: &[u8],
        setup: [u8; 8],
    ) -> Vec<u8> {
        let length = room.unwrap_or(data.len()) as u32;
        let words = [
            1,
            number,
            0x0001_0001,
            u32::from(room.is_some()),
            u32::from(endpoint),
            0,
            length,
            0,
            0,
            0,
        ];
        let mut bytes: Vec<u8> = words
            .iter()
            .flat_map(|word: &u32| word.to_be_bytes())
            .collect();
        bytes.extend(setup);
        bytes.extend(data);
        bytes
    }

    pub fn send(&mut self, bytes: &[u8]) {
        self.stream.write_all(bytes).expect("the server reads");
    }

    /// Submits a read of an IN endpoint.
    pub fn read(&mut self, endpoint: u8, length: usize) -> u32 {
        let number = self.next_number();
        self.send(&Client::submit_bytes(
            number,
            endpoint,
            Some(length),
            &[],
            [0; 8],
        ));
        number
    }

    /// Submits a write to an OUT endpoint.
    pub fn write(&mut self, endpoint: u8, data: &[u8]) -> u32 {
        let number = self.next_number();
        self.writes.push(number);
        self.send(&Client::submit_bytes(number, endpoint, None, data, [0; 8]));
        number
    }

    pub fn unlink(&mut self, victim: u32) -> u32 {
        let number = self.next_number();
        let words = [2, number, 0x0001_0001, 0, 0, victim, 0, 0, 0, 0, 0, 0];
        let bytes: Vec<u8> = words
            .iter()
            .flat_map(|word: &u32| word.to_be_bytes())
            .collect();
        self.send(&bytes);
        number
    }

    /// A control request, from SUBMIT to its answer.
    pub fn control(&mut self, setup: [u8; 8], data: &[u8]) -> Reply {
        let number = self.next_number();
        let length = usize::from(u16::from_le_bytes([setup[6], setup[7]]));
        let room = (setup[0] & 0x80 != 0).then_some(length);
        if room.is_none() {
            self.writes.push(number);
        }
        self.send(&Client::submit_bytes(number, 0, room, data, setup));
        self.answer_to(number)
    }

    /// The next reply, whichever it is.
    pub fn reply(&mut self) -> Reply {
        if !self.early.is_empty() {
            return self.early.remove(0);
        }
        self.receive()
    }

    /// The reply to command `number`; those before it are kept.
    pub fn answer_to(&mut self, number: u32) -> Reply {
        if let Some(at) = self.early.iter().position(|reply| reply.number == number) {
            return self.early.remove(at);
        }
        loop {
            let reply = self.receive();
            if reply.number == number {
                return reply;
            }
            self.early.push(reply);
        }
    }

    /// Whether the server has closed the connection.
    pub fn is_closed(&mut self) -> bool {
        // What was on its way comes first; bytes that the server has not read make it a reset.
        match self.stream.read_to_end(&mut Vec::new()) {
            Ok(_) => true,
            Err(error) => error.kind() == std::io::ErrorKind::ConnectionReset,
        }
    }

    fn receive(&mut self) -> Reply {
        let mut header = [0; 48];
        self.stream.read_exact(&mut header).expect("a reply");
        let word = |at: usize| {
            u32::from_be_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]])
        };
        let (command, count) = (word(0), word(24) as usize);
        assert!(matches!(command, 3 | 4), "{header:02x?}");
        let mut reply = Reply {
            command,
            number: word(4),
            status: word(20) as i32,
            count,
            data: Vec::new(),
        };
        if command == 3 && !self.writes.contains(&reply.number) {
            reply.data = vec![0; count];
            self.stream.read_exact(&mut reply.data).expect("its data");
        }
        reply
    }
}
