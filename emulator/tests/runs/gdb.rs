//! The debugger's door, by somebody who speaks the protocol and nothing else.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use vrduino_emulator::board::Board;
use vrduino_emulator::gdb::Server;
use vrduino_emulator::time::MILLISECOND;

use crate::tracker::{board, setup};

/// A board that is debugged, in a thread of its own.
struct Bench {
    debugger: TcpStream,
    received: Vec<u8>,
    /// Text for the debugger's console.
    console: String,
    board: JoinHandle<Board>,
}

impl Bench {
    fn new() -> Bench {
        let mut server = Server::open(0).unwrap();
        let address: SocketAddr = server.address().unwrap();
        let board = thread::spawn(move || {
            let mut board = board(setup());
            while server.holds() {
                server.run(&mut board, MILLISECOND);
            }
            board
        });
        let debugger = TcpStream::connect(address).unwrap();
        debugger
            .set_read_timeout(Some(Duration::from_secs(60)))
            .unwrap();
        Bench {
            debugger,
            received: Vec::new(),
            console: String::new(),
            board,
        }
    }

    fn send(&mut self, text: &str) {
        let sum = text.bytes().fold(0u8, u8::wrapping_add);
        let packet = format!("${text}#{sum:02x}");
        self.debugger.write_all(packet.as_bytes()).unwrap();
    }

    /// The next packet that is no text for the console.
    fn reply(&mut self) -> String {
        loop {
            if let Some(end) = self.received.iter().position(|&byte| byte == b'#')
                && self.received.len() > end + 2
            {
                let packet: Vec<u8> = self.received.drain(..end + 3).collect();
                let start = packet.iter().position(|&byte| byte == b'$').unwrap();
                let text = &packet[start + 1..end];
                let sum = text.iter().fold(0u8, |sum, &byte| sum.wrapping_add(byte));
                assert_eq!(packet[end + 1..], *format!("{sum:02x}").as_bytes());
                self.debugger.write_all(b"+").unwrap();
                let text = String::from_utf8(text.to_vec()).unwrap();
                match text.strip_prefix('O') {
                    Some(hex) if hex != "K" => self.console += &unhex(hex),
                    _ => return text,
                }
                continue;
            }
            let mut buffer = [0; 1024];
            let count = self.debugger.read(&mut buffer).unwrap();
            assert!(count > 0, "the board has hung up");
            self.received.extend(&buffer[..count]);
        }
    }

    fn ask(&mut self, text: &str) -> String {
        self.send(text);
        self.reply()
    }

    fn register(&mut self, number: usize) -> u32 {
        let hex = self.ask(&format!("p{number:x}"));
        u32::from_str_radix(&hex, 16).unwrap().swap_bytes()
    }

    fn monitor(&mut self, command: &str) -> String {
        self.console.clear();
        let hex: String = command.bytes().map(|b| format!("{b:02x}")).collect();
        assert_eq!(self.ask(&format!("qRcmd,{hex}")), "OK");
        self.console.clone()
    }

    fn detach(mut self) -> Board {
        assert_eq!(self.ask("D"), "OK");
        self.board.join().unwrap()
    }
}

fn unhex(text: &str) -> String {
    let bytes = text
        .as_bytes()
        .chunks(2)
        .map(|pair| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap())
        .collect();
    String::from_utf8(bytes).unwrap()
}

const PC: usize = 15;
const XPSR: usize = 25;
const MAIN: &str = "__cortex_m_rt_main";

#[test]
fn the_board_waits_at_its_first_instruction_and_describes_itself() {
    let mut bench = Bench::new();
    assert!(bench.ask("qSupported:hwbreak+").contains("PacketSize="));
    assert_eq!(bench.ask("?"), "S05");
    let description = bench.ask("qXfer:features:read:target.xml:0,800");
    assert!(description.starts_with("l<?xml") && description.contains("m-profile"));
    let map = bench.ask("qXfer:memory-map:read::0,800");
    assert!(map.contains("type=\"rom\" start=\"0x0\" length=\"0x40000\""));
    assert_eq!(bench.ask("g").len(), 19 * 8);
    assert_eq!(bench.register(13), 0x2000_8000);
    assert_eq!(bench.register(XPSR), 0x0100_0000);
    // Nonsense is refused, and nothing else happens.
    for (nonsense, answer) in [
        ("m", "E16"),
        ("mzz,4", "E16"),
        ("p99", "E16"),
        ("Z9,0,2", ""),
        ("X", ""),
        ("vKill", ""),
        ("m60000000,4", "E0e"),
        ("M0,4:00000000", "E0e"),
    ] {
        assert_eq!(bench.ask(nonsense), answer, "{nonsense:?}");
    }
    // A packet with a wrong checksum is asked for again.
    bench.debugger.write_all(b"$g#00").unwrap();
    bench.send("?");
    assert_eq!(bench.reply(), "S05");
    bench.detach();
}

#[test]
fn breakpoints_watchpoints_steps_and_ctrl_c_stop_the_program() {
    let reference = board(setup());
    let address = |name: &str| reference.image().address_of(name).unwrap() & !1;
    let (main, lines) = (address(MAIN), address("vrduino_dropped_lines"));
    let mut bench = Bench::new();
    assert_eq!(bench.ask(&format!("Z1,{main:x},2")), "OK");
    assert_eq!(bench.ask("vCont;c"), "T05hwbreak:;");
    assert_eq!(bench.register(PC), main);
    assert_eq!(bench.ask("vCont;s:1"), "S05");
    let next = bench.register(PC);
    assert!(next == main + 2 || next == main + 4, "{next:#x}");
    assert_eq!(bench.ask(&format!("z1,{main:x},2")), "OK");
    // Variables are zeroed on the way to main: from the start, a watchpoint sees that.
    bench.monitor("reset");
    assert_eq!(bench.ask(&format!("Z2,{lines:x},4")), "OK");
    assert_eq!(bench.ask("c"), format!("T05watch:{lines:x};"));
    assert!(bench.register(PC) < main);
    assert_eq!(bench.ask(&format!("m{lines:x},4")), "00000000");
    assert_eq!(bench.ask(&format!("z2,{lines:x},4")), "OK");
    bench.send("c");
    thread::sleep(Duration::from_millis(100));
    bench.debugger.write_all(&[3]).unwrap();
    assert_eq!(bench.reply(), "S02");
    bench.detach();
}

#[test]
fn registers_and_memory_can_be_changed_and_looking_changes_nothing() {
    let mut bench = Bench::new();
    let began = Instant::now();
    // Until I2C and USB have their clocks.
    loop {
        bench.send("c");
        thread::sleep(Duration::from_millis(100));
        bench.debugger.write_all(&[3]).unwrap();
        assert_eq!(bench.reply(), "S02");
        if ["m40066000,c", "m40072000,10"]
            .iter()
            .all(|read| !bench.ask(read).starts_with('E'))
        {
            break;
        }
        assert!(began.elapsed() < Duration::from_secs(120));
    }
    let before = bench.monitor("hash");
    // The identification of the processor, the clock's status, all of I2C0 with its data register, USB, SysTick.
    assert_eq!(bench.ask("me000ed00,4"), "41c20f41");
    for range in [
        "40064006,1",
        "40066000,c",
        "40072000,10",
        "40048034,4",
        "e000e010,10",
    ] {
        let answer = bench.ask(&format!("m{range}"));
        assert!(!answer.starts_with('E'), "{range}: {answer}");
    }
    assert_eq!(bench.monitor("hash"), before);
    assert_eq!(bench.ask("P3=78563412"), "OK");
    assert_eq!(bench.register(3), 0x1234_5678);
    assert_eq!(bench.ask("M20007000,4:deadbeef"), "OK");
    assert_eq!(bench.ask("m20007000,4"), "deadbeef");
    assert_ne!(bench.monitor("hash"), before);
    let mut board = bench.detach();
    assert_eq!(board.chip().ram.word(0x2000_7000), Some(0xEFBE_ADDE));
}

#[test]
fn a_trap_stops_the_program_with_its_reason_and_a_reset_goes_on() {
    let mut bench = Bench::new();
    // Nothing can be fetched from a peripheral.
    assert_eq!(bench.ask("Pf=00000040"), "OK");
    assert_eq!(bench.ask("c"), "S06");
    assert!(bench.console.contains("stopped "), "{}", bench.console);
    assert!(bench.console.contains("rule    "), "{}", bench.console);
    assert!(bench.monitor("why").contains("stopped "));
    // It does not go on by itself.
    assert_eq!(bench.ask("c"), "S06");
    bench.monitor("reset");
    assert_eq!(bench.register(13), 0x2000_8000);
    assert_eq!(bench.ask("s"), "S05");
    assert!(bench.detach().stop().is_none());
}

#[test]
fn a_debugged_run_is_the_run_without_a_debugger() {
    let mut alone = board(setup());
    alone.run(20 * MILLISECOND);
    let mut bench = Bench::new();
    let main = alone.image().address_of(MAIN).unwrap() & !1;
    assert_eq!(bench.ask(&format!("Z1,{main:x},2")), "OK");
    assert_eq!(bench.ask("c"), "T05hwbreak:;");
    for _ in 0..10 {
        assert_eq!(bench.ask("s"), "S05");
    }
    let mut board = bench.detach();
    board.run(20 * MILLISECOND - board.now());
    assert_eq!(board.now(), alone.now());
    assert_eq!(board.state_hash(), alone.state_hash());
}
