//! Streams made by the library, for what the page decodes itself.

use vrduino::sensor::RawSample;
use vrduino::wire::frame::{self, Counts};
use vrduino::wire::{self, Decimals, LINE_LEN, Provenance, Q30, Stamp, Status, Tag};

/// Marsaglia's xorshift with a multiplication: the same numbers with every run.
pub struct Random(pub u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// From 0 to below.
    pub fn below(&mut self, limit: usize) -> usize {
        ((self.next() >> 32) as usize) % limit
    }

    /// From −1 to 1.
    fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn byte(&mut self) -> u8 {
        // Those that mean something to a decoder come more often than by chance.
        match self.below(8) {
            0 => 0,
            1 => b"\n\r\t *"[self.below(5)],
            2 => self.below(32) as u8,
            3 => b"QC 0123456789.-"[self.below(15)],
            _ => self.below(256) as u8,
        }
    }
}

/// A turn about the vertical by so many radians.
pub fn heading(angle: f64) -> Q30 {
    let (sin, cos) = (angle / 2.0).sin_cos();
    Q30([cos, 0.0, sin, 0.0].map(bits))
}

fn bits(component: f64) -> i32 {
    (component * f64::from(1 << 30)).round() as i32
}

/// The frame with this number, which is its millisecond as well.
pub fn frame(number: u32) -> impl AsRef<[u8]> {
    let provenance = Provenance {
        stamp: Stamp {
            sequence: number as u16,
            micros: number.wrapping_mul(1000),
        },
        status: Status::from_byte(0b0101_0100),
    };
    frame::orientation(heading(f64::from(number) * 1e-3), provenance)
}

/// Lines and frames of every kind, whole and damaged, and garbage between them.
pub fn mixture(pieces: usize, random: &mut Random) -> Vec<u8> {
    let mut bytes = Vec::new();
    for number in 0..pieces {
        let start = bytes.len();
        piece(number as u16, random, &mut bytes);
        match random.below(10) {
            // A byte is another, is missing, or is one more.
            0 => {
                let at = start + random.below(bytes.len() - start);
                bytes[at] = random.byte();
            }
            1 => {
                bytes.remove(start + random.below(bytes.len() - start));
            }
            2 => {
                let at = start + random.below(bytes.len() - start);
                bytes.insert(at, random.byte());
            }
            3 => {
                let length = random.below(200);
                bytes.extend((0..length).map(|_| random.byte()));
            }
            _ => {}
        }
    }
    bytes
}

fn piece(number: u16, random: &mut Random, bytes: &mut Vec<u8>) {
    let parts = [(); 4].map(|()| random.signed());
    let length = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
    let q = Q30(parts.map(|part| bits(part / length)));
    // Most follow each other; some are the farthest ahead, some the nearest back, some the same.
    let ahead = [0, 0x7FFE, 0x7FFF, 0xFFFE, 0xFFFF][random.below(5)];
    let leaps = random.below(10) == 0;
    let stamp = Stamp {
        sequence: number.wrapping_add(if leaps { ahead } else { 0 }),
        micros: random.next() as u32,
    };
    let status = Status::from_byte(random.below(256) as u8);
    let provenance = Provenance { stamp, status };
    let decimals = Decimals::new(3 + random.below(4) as u32).expect("three to six");
    match random.below(9) {
        0 | 1 => bytes.extend(frame::orientation(q, provenance)),
        2 => {
            let counts = Counts {
                sample: RawSample {
                    gyro: [1, -2, 3],
                    accel: [number.cast_signed(), 0, -1],
                    temperature: 0,
                    fresh: true,
                },
                field: None,
            };
            bytes.extend(frame::orientation_and_counts(q, provenance, &counts));
        }
        3 => bytes.extend(wire::timed(q, stamp, decimals).bytes()),
        4 => bytes.extend(wire::quaternion(Tag::Fused, q, decimals).bytes()),
        5 => bytes.extend(wire::quaternion(Tag::Gyro, q, decimals).bytes()),
        6 => bytes.extend(format!("OK µ {number}\r\n").bytes()),
        7 => bytes.extend("\u{feff}tab\tand mark\n".bytes()),
        // About as long as a line may be.
        _ => {
            let length = LINE_LEN - 3 + random.below(6);
            bytes.extend(std::iter::repeat_n(b'l', length).chain(*b"\n"));
        }
    }
}
