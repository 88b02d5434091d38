//! The auxiliary I2C master: five slaves, served at every sample (register map, sections 4.12 to 4.18, 4.25 to 4.30).

use super::ak8963::{self, Ak8963};
use super::complaint::Complaints;
use super::registers::{
    EXT_SENS_DATA_00, EXT_SENS_DATA_23, I2C_MST_CTRL, I2C_MST_DELAY_CTRL, I2C_SLV0_ADDR,
    I2C_SLV0_DO, I2C_SLV4_ADDR, I2C_SLV4_CTRL, I2C_SLV4_DI, I2C_SLV4_DO, I2C_SLV4_REG, Registers,
};
use crate::time::{SECOND, Ticks};

/// In the ADDR registers: the transfer is a read.
const READ: u8 = 1 << 7;
/// In the CTRL registers.
const ENABLED: u8 = 1 << 7;
const BYTE_SWAP: u8 = 1 << 6;
const NO_REGISTER: u8 = 1 << 5;
const ODD_GROUPS: u8 = 1 << 4;
/// In I2C_MST_STATUS.
const SLV4_DONE: u8 = 1 << 6;
const SLV4_NACK: u8 = 1 << 4;
/// In I2C_MST_DELAY_CTRL.
const DELAY_ES_SHADOW: u8 = 1 << 7;

const EXTERNAL: u8 = EXT_SENS_DATA_23 - EXT_SENS_DATA_00 + 1;

/// Divider of the 8 MHz clock by I2C_MST_CLK (section 4.12).
const CLOCK_DIVIDER: [u64; 16] = [
    23, 24, 25, 26, 27, 28, 29, 30, 31, 16, 17, 18, 19, 20, 21, 22,
];

/// What a finished transfer changes.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Outcome {
    /// Bytes for EXT_SENS_DATA from this index on.
    External(u8, Vec<u8>),
    /// The byte slave 4 gave.
    Slave4(Option<u8>),
    /// Status bits.
    Status(u8),
}

/// What is at the other end of the bus.
pub struct AuxiliaryBus<'a> {
    /// The magnetometer, if there is one.
    pub magnetometer: Option<&'a mut Ak8963>,
    /// Where misuse is noted.
    pub complaints: &'a mut Complaints,
}

/// The master.
#[derive(Debug, Clone, Default)]
pub struct AuxMaster {
    /// Bytes of EXT_SENS_DATA that belong to each slave; kept until all are disabled.
    allocated: [u8; 4],
    /// Samples so far, to count delayed access.
    samples: u64,
    /// When the bus is free again.
    busy_until: Ticks,
    outcomes: Vec<(Ticks, Outcome)>,
    status: u8,
    /// The slave was reset in mid-transfer and hangs.
    hung: bool,
}

/// What a slave is asked for.
struct Transfer {
    address: u8,
    register: Option<u8>,
    /// `None` reads.
    write: Option<u8>,
    length: u8,
}

impl AuxMaster {
    /// Whether a transfer is under way.
    pub fn is_busy(&self, now: Ticks) -> bool {
        now < self.busy_until
    }

    /// When the transfers under way end.
    pub fn busy_until(&self) -> Ticks {
        self.busy_until
    }

    /// I2C_MST_RST; in mid-transfer the slave hangs (section 4.33).
    pub fn reset(&mut self, now: Ticks) {
        self.hung |= self.is_busy(now);
        self.clear();
    }

    /// The state after a reset of the whole die; a slave that hangs does not notice.
    pub fn clear(&mut self) {
        *self = AuxMaster {
            hung: self.hung,
            ..AuxMaster::default()
        };
    }

    /// Reads and clears I2C_MST_STATUS.
    pub fn read_status(&mut self) -> u8 {
        std::mem::take(&mut self.status)
    }

    /// A CTRL register of slave 0 to 3 was written: bytes are allocated when a slave is enabled, and given back when
    /// all are disabled (section 4.25).
    pub fn reallocate(&mut self, registers: &Registers) {
        let control = |slave: u8| registers[I2C_SLV0_ADDR + 3 * slave + 2];
        if (0..4).all(|slave| control(slave) & ENABLED == 0) {
            self.allocated = [0; 4];
        }
        for slave in 0..4 {
            let reads = registers[I2C_SLV0_ADDR + 3 * slave] & READ != 0;
            if control(slave) & ENABLED != 0 && reads {
                self.allocated[usize::from(slave)] = control(slave) & 0xF;
            }
        }
    }

    /// The bytes of EXT_SENS_DATA that belong to a slave: first index and number.
    pub fn allocation(&self, slave: usize) -> (u8, u8) {
        let first: u8 = self.allocated[..slave].iter().sum();
        let first = first.min(EXTERNAL);
        (first, self.allocated[slave].min(EXTERNAL - first))
    }

    /// A sample is taken at `at`: serves the slaves.
    pub fn sample(&mut self, registers: &mut Registers, at: Ticks, bus: &mut AuxiliaryBus<'_>) {
        self.samples += 1;
        if self.is_busy(at) {
            // The last round has not ended; this one is left out.
            return;
        }
        let clock = CLOCK_DIVIDER[usize::from(registers[I2C_MST_CTRL] & 0xF)];
        let bit = SECOND / 8_000_000 * clock;
        let delay = u64::from(registers[I2C_SLV4_CTRL] & 0x1F) + 1;
        let mut time = at;
        let mut external = Vec::new();
        for slave in 0..=4 {
            let base = I2C_SLV0_ADDR + 3 * slave;
            let control = if slave < 4 { base + 2 } else { I2C_SLV4_CTRL };
            let delayed = registers[I2C_MST_DELAY_CTRL] >> slave & 1 != 0;
            if registers[control] & ENABLED == 0 || delayed && !self.samples.is_multiple_of(delay) {
                continue;
            }
            let transfer = Transfer::of(registers, slave);
            let result = self.transfer(&transfer, &mut time, bit, bus);
            let outcome = match (slave, result) {
                (4, result) => {
                    registers[I2C_SLV4_CTRL] &= !ENABLED;
                    let nack = if result.is_none() { SLV4_NACK } else { 0 };
                    self.outcomes
                        .push((time, Outcome::Status(SLV4_DONE | nack)));
                    Outcome::Slave4(result.and_then(|bytes| bytes.first().copied()))
                }
                (_, None) => Outcome::Status(1 << slave),
                (_, Some(mut bytes)) => {
                    if registers[control] & BYTE_SWAP != 0 {
                        let odd = registers[control] & ODD_GROUPS != 0;
                        swap(&mut bytes, registers[base + 1], odd);
                    }
                    let (first, length) = self.allocation(usize::from(slave));
                    bytes.truncate(usize::from(length));
                    external.push((time, Outcome::External(first, bytes)));
                    continue;
                }
            };
            self.outcomes.push((time, outcome));
        }
        let together = registers.has(I2C_MST_DELAY_CTRL, DELAY_ES_SHADOW);
        let shown = |end: Ticks| if together { time } else { end };
        self.outcomes.extend(
            external
                .into_iter()
                .map(|(end, outcome)| (shown(end), outcome)),
        );
        self.busy_until = time;
    }

    /// One transfer, from `time` on; `None` is not acknowledged.
    fn transfer(
        &mut self,
        transfer: &Transfer,
        time: &mut Ticks,
        bit: Ticks,
        bus: &mut AuxiliaryBus<'_>,
    ) -> Option<Vec<u8>> {
        let byte = 9 * bit;
        // START, the address, and whatever follows.
        *time += bit + byte;
        let present = transfer.address == ak8963::ADDRESS && !self.hung;
        let magnetometer = bus
            .magnetometer
            .as_deref_mut()
            .filter(|_| present)
            .filter(|magnetometer| magnetometer.answers())?;
        if let Some(register) = transfer.register {
            magnetometer.address();
            *time += byte;
            magnetometer.write(register, *time, bus.complaints);
        }
        if let Some(data) = transfer.write {
            *time += byte;
            magnetometer.write(data, *time, bus.complaints);
            *time += bit;
            return Some(Vec::new());
        }
        if transfer.register.is_some() {
            *time += bit + byte;
        }
        magnetometer.address();
        let bytes = (0..transfer.length)
            .map(|_| {
                *time += byte;
                magnetometer.read(*time, bus.complaints)
            })
            .collect();
        *time += bit;
        Some(bytes)
    }

    /// Shows what has ended by `now` in the registers.
    pub fn finish(&mut self, registers: &mut Registers, now: Ticks) {
        let status = &mut self.status;
        self.outcomes.retain(|(end, outcome)| {
            if *end > now {
                return true;
            }
            match outcome {
                Outcome::External(first, bytes) => {
                    for (register, byte) in (EXT_SENS_DATA_00 + first..).zip(bytes) {
                        registers[register] = *byte;
                    }
                }
                Outcome::Slave4(byte) => registers[I2C_SLV4_DI] = byte.unwrap_or(0),
                Outcome::Status(bits) => *status |= bits,
            }
            false
        });
    }
}

impl Transfer {
    fn of(registers: &Registers, slave: u8) -> Transfer {
        let (address, register, control, output) = if slave < 4 {
            let base = I2C_SLV0_ADDR + 3 * slave;
            (base, base + 1, base + 2, I2C_SLV0_DO + slave)
        } else {
            (I2C_SLV4_ADDR, I2C_SLV4_REG, I2C_SLV4_CTRL, I2C_SLV4_DO)
        };
        let reads = registers[address] & READ != 0;
        Transfer {
            address: registers[address] & !READ,
            register: (registers[control] & NO_REGISTER == 0).then_some(registers[register]),
            write: (!reads).then_some(registers[output]),
            length: if slave < 4 {
                registers[control] & 0xF
            } else {
                1
            },
        }
    }
}

/// Exchanges the bytes of each whole word. Words begin at even registers, or with `odd` at odd ones (section 4.13).
fn swap(bytes: &mut [u8], first_register: u8, odd: bool) {
    let begins_inside = (first_register & 1 != 0) != odd;
    let first = usize::from(begins_inside).min(bytes.len());
    let whole = &mut bytes[first..];
    for word in whole.chunks_exact_mut(2) {
        word.swap(0, 1);
    }
}
