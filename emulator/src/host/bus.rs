//! The bus: a root port with a cable, 1 ms frames, and the pipes of the one device on it.
//!
//! Drivers ([`super::serial`], [`super::export`]) submit transfers and hear how they end; below that everything that USB
//! prescribes happens here, and is judged: frames, addresses, retries, toggles, packet sizes. Like a bus analyser, the
//! bus learns the device's endpoints from the requests that pass.

mod effects;

use std::collections::VecDeque;

use super::control::ControlPipe;
use super::descriptors::Configuration;
use super::pipe::Pipe;
use super::transfer::{Failure, Outcome, Ticket, Transfer};
use super::wire::{Noise, Wire};
use crate::cpu::Ram;
use crate::peripherals::usbotg::UsbController;
use crate::time::{MICROSECOND, MILLISECOND, NEVER, Ticks};
use crate::witness::{Trap, Witness};

/// A pull-up was seen; wait for the plug to settle (USB 2.0, 7.1.7.3).
const SETTLING: Ticks = 100 * MILLISECOND;
/// SE0 on the bus (7.1.7.5), and the time a device has to recover from it.
const RESET: Ticks = 10 * MILLISECOND;
const RESET_RECOVERY: Ticks = 10 * MILLISECOND;
/// A device has to be reachable at its new address (9.2.6.3).
const ADDRESS_RECOVERY: Ticks = 2 * MILLISECOND;
/// K on the bus, and the time until the device has to answer again (7.1.7.7).
const RESUME: Ticks = 20 * MILLISECOND;
const RESUME_RECOVERY: Ticks = 10 * MILLISECOND;
/// An idle bus suspends its device (7.1.7.6).
const IDLE: Ticks = 3 * MILLISECOND;
/// The longest transaction at full speed, with 64 bytes, takes 58 µs.
const LONGEST_TRANSACTION: Ticks = 70 * MICROSECOND;

/// The port's state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Port {
    /// Nothing shows on the bus.
    Empty,
    /// A device was plugged in.
    Settling { until: Ticks },
    /// A device is there, and the bus is idle.
    Idle,
    /// SE0.
    Resetting { until: Ticks },
    /// K.
    Resuming { until: Ticks },
    /// Frames run.
    Running,
}

/// What a driver hears.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Event {
    /// A device was plugged in and waits for a reset.
    Attached,
    /// It is gone.
    Detached,
    /// It was reset and listens at address 0.
    Reset,
    /// A transfer has ended.
    Ended(Ticket, Outcome),
}

/// The bus.
#[derive(Debug, Clone)]
pub(super) struct Bus {
    port: Port,
    plugged: bool,
    /// The driver wants SE0 on the bus.
    reset_wanted: bool,
    /// The driver wants frames, or none.
    suspend_wanted: bool,
    /// The device may wake the host.
    wake_up_enabled: bool,
    /// When the device will have seen 3 ms of silence.
    idle_at: Ticks,
    next_look: Ticks,
    frame: u16,
    next_frame: Ticks,
    free_at: Ticks,
    address: u8,
    control: ControlPipe,
    pipes: Vec<Pipe>,
    /// The pipe that was served last among those without a schedule.
    last_served: usize,
    configurations: Vec<Configuration>,
    /// The value of the active one; 0 is none.
    configuration: u8,
    noise: Noise,
    tickets: u64,
    events: VecDeque<Event>,
}

impl Bus {
    /// A powered port with its cable plugged in.
    pub fn new() -> Bus {
        Bus {
            port: Port::Empty,
            plugged: true,
            reset_wanted: false,
            suspend_wanted: false,
            wake_up_enabled: false,
            idle_at: NEVER,
            next_look: 0,
            frame: 0,
            next_frame: NEVER,
            free_at: 0,
            address: 0,
            control: ControlPipe::new(),
            pipes: Vec::new(),
            last_served: 0,
            configurations: Vec::new(),
            configuration: 0,
            noise: Noise::default(),
            tickets: 0,
            events: VecDeque::new(),
        }
    }

    /// Pulls the plug or puts it back.
    pub fn set_plugged(&mut self, plugged: bool) {
        self.plugged = plugged;
    }

    /// Disturbs every so many transactions: damages the packet to the device, or its handshake; 0 ends that.
    pub fn set_noise(&mut self, every: u32) {
        self.noise.every = every;
    }

    /// Resets the device; [`Event::Reset`] follows if one is there.
    pub fn reset(&mut self) {
        self.reset_wanted = self.port != Port::Empty;
        self.suspend_wanted = false;
    }

    /// Stops the frames so that the device suspends itself, or resumes it.
    pub fn set_suspended(&mut self, suspended: bool) {
        self.suspend_wanted = suspended;
    }

    /// Forgets the device and waits before it is [`Event::Attached`] once more.
    pub fn settle_again(&mut self, until: Ticks) {
        if self.port != Port::Empty {
            self.forget_device();
            self.port = Port::Settling { until };
        }
    }

    /// The configurations seen so far.
    pub fn configurations(&self) -> &[Configuration] {
        &self.configurations
    }

    /// Hands a transfer over; [`Event::Ended`] follows unless it is cancelled.
    pub fn submit(&mut self, transfer: Transfer) -> Ticket {
        self.tickets += 1;
        let ticket = Ticket(self.tickets);
        let accepted = match transfer {
            Transfer::Control(request) => {
                self.control.submit(ticket, request);
                true
            }
            Transfer::In { number, length } => self
                .pipe(number | 0x80)
                .map(|pipe| pipe.read(ticket, length))
                .is_some(),
            Transfer::Out {
                number,
                data,
                closed,
            } => self
                .pipe(number)
                .map(|pipe| pipe.write(ticket, data, closed))
                .is_some(),
        };
        if !accepted {
            let outcome = Outcome::Failed(Failure::NoEndpoint);
            self.events.push_back(Event::Ended(ticket, outcome));
        }
        ticket
    }

    /// The open pipe of the endpoint with this address.
    fn pipe(&mut self, address: u8) -> Option<&mut Pipe> {
        self.pipes
            .iter_mut()
            .find(|pipe| pipe.endpoint.address == address)
    }

    /// Gives a transfer up; whether it was still pending.
    pub fn cancel(&mut self, ticket: Ticket) -> bool {
        self.control.cancel(ticket) || self.pipes.iter_mut().any(|pipe| pipe.cancel(ticket))
    }

    /// What has happened since the last call.
    pub fn take_event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// When [`Bus::advance`] has to be called next.
    pub fn next_event(&self) -> Ticks {
        if self.reset_wanted || !self.events.is_empty() {
            return 0;
        }
        let due = match self.port {
            Port::Empty => return self.next_look,
            Port::Settling { until } | Port::Resetting { until } | Port::Resuming { until } => {
                until
            }
            Port::Idle if !self.suspend_wanted && self.address != 0 => return 0,
            Port::Idle => NEVER,
            Port::Running if self.suspend_wanted => return 0,
            Port::Running => return self.next_frame.min(self.next_transaction()),
        };
        due.min(self.next_look).min(self.idle_at)
    }

    fn next_transaction(&self) -> Ticks {
        let control = self.control.is_busy().then_some(self.control.ready_at);
        let pipes = self.pipes.iter().filter(|pipe| pipe.is_busy());
        let due = pipes.map(|pipe| pipe.ready_at).chain(control).min();
        due.map_or(NEVER, |at| at.max(self.free_at))
    }

    /// Does what is due at `now`. `clocked` tells whether the device's USB module has its 48 MHz.
    pub fn advance(
        &mut self,
        now: Ticks,
        clocked: bool,
        device: &mut UsbController,
        ram: &Ram,
        witness: &mut Witness,
    ) {
        let let_go = device.take_let_go();
        let attached = self.plugged && clocked && device.pulled_up() && !let_go;
        if now >= self.next_look {
            self.next_look = now + MILLISECOND;
        }
        if !attached {
            if self.port != Port::Empty {
                self.detach();
            }
            return;
        }
        if now >= self.idle_at {
            self.idle_at = NEVER;
            device.idle();
        }
        if self.reset_wanted {
            self.drive_reset(now, device);
            return;
        }
        let silent = matches!(self.port, Port::Settling { .. } | Port::Idle);
        if silent && device.drives_resume() && !self.wake_up_enabled {
            witness.saw(
                Trap::UsbWakeUp,
                "CTL[RESUME] was set while the bus was idle, and the host had not allowed it",
            );
        }
        match self.port {
            Port::Empty => {
                self.port = Port::Settling {
                    until: now + SETTLING,
                };
                self.idle_at = now + IDLE;
            }
            Port::Settling { until } if now >= until => {
                self.port = Port::Idle;
                self.events.push_back(Event::Attached);
            }
            Port::Resetting { until } if now >= until => {
                self.run_from(now, RESET_RECOVERY);
                self.events.push_back(Event::Reset);
            }
            Port::Resuming { until } if now >= until => self.run_from(now, RESUME_RECOVERY),
            Port::Idle => self.idle(now, device),
            Port::Running if self.suspend_wanted => {
                self.port = Port::Idle;
                self.idle_at = now + IDLE;
            }
            Port::Running => self.run_frames(now, device, ram, witness),
            _ => {}
        }
    }

    fn detach(&mut self) {
        self.forget_device();
        self.configurations.clear();
        self.port = Port::Empty;
        self.idle_at = NEVER;
        self.events.push_back(Event::Detached);
    }

    /// The device is in its default state, whatever it was before.
    fn forget_device(&mut self) {
        self.address = 0;
        self.configuration = 0;
        self.wake_up_enabled = false;
        self.reset_wanted = false;
        self.control.fresh_address = false;
        self.give_up_transfers();
        self.pipes.clear();
    }

    /// Ends whatever is pending.
    pub fn give_up_transfers(&mut self) {
        let pending = self.pipes.iter_mut().flat_map(Pipe::clear);
        for ticket in self.control.clear().chain(pending) {
            let outcome = Outcome::Failed(Failure::Gone);
            self.events.push_back(Event::Ended(ticket, outcome));
        }
    }

    fn drive_reset(&mut self, now: Ticks, device: &mut UsbController) {
        self.forget_device();
        self.idle_at = NEVER;
        self.port = Port::Resetting { until: now + RESET };
        device.bus_reset();
    }

    fn run_from(&mut self, now: Ticks, recovery: Ticks) {
        self.port = Port::Running;
        self.idle_at = NEVER;
        self.next_frame = now;
        self.free_at = now;
        self.control.ready_at = now + recovery;
        for pipe in &mut self.pipes {
            pipe.ready_at = now + recovery;
        }
    }

    /// No frames run: either side may end that.
    fn idle(&mut self, now: Ticks, device: &mut UsbController) {
        let woken = device.drives_resume();
        if self.address != 0 && (woken || !self.suspend_wanted) {
            self.suspend_wanted = false;
            self.port = Port::Resuming {
                until: now + RESUME,
            };
            self.idle_at = NEVER;
            device.resume_signalled();
        }
    }

    fn run_frames(
        &mut self,
        now: Ticks,
        device: &mut UsbController,
        ram: &Ram,
        witness: &mut Witness,
    ) {
        if now >= self.next_frame {
            self.frame = self.frame.wrapping_add(1);
            device.start_of_frame(self.frame, ram, witness);
            self.free_at = now + 4 * MICROSECOND;
            self.next_frame = now + MILLISECOND;
        }
        if now < self.next_transaction() {
            return;
        }
        if now >= self.next_frame - LONGEST_TRANSACTION {
            self.free_at = self.next_frame;
            return;
        }
        let mut noise = std::mem::take(&mut self.noise);
        let mut wire = Wire {
            now,
            frame_end: self.next_frame,
            address: self.address,
            device,
            ram,
            witness,
            noise: &mut noise,
        };
        let bytes = self.transact(&mut wire);
        self.noise = noise;
        // Token, data with its worst-case bit stuffing, handshake and the gaps between them, at 12 bits a µs.
        self.free_at = now + (100 + bytes as Ticks * 28 / 3) * MICROSECOND / 12;
    }

    /// One transaction of the most urgent pipe: periodic ones, then control, then bulk in turn.
    fn transact(&mut self, wire: &mut Wire<'_>) -> usize {
        let now = wire.now;
        let due = |pipe: &Pipe| pipe.is_busy() && pipe.ready_at <= now;
        let periodic = self
            .pipes
            .iter()
            .position(|pipe| pipe.is_periodic() && due(pipe));
        if periodic.is_none() && self.control.is_busy() && self.control.ready_at <= now {
            let (bytes, ended) = self.control.transact(wire);
            if let Some((ticket, request, outcome)) = ended {
                if let Outcome::Done(data) = &outcome {
                    self.took_effect(&request, data, wire);
                }
                self.events.push_back(Event::Ended(ticket, outcome));
            }
            return bytes;
        }
        let count = self.pipes.len();
        let in_turn = || {
            (1..=count)
                .map(|step| (self.last_served + step) % count)
                .find(|&n| due(&self.pipes[n]))
        };
        let Some(chosen) = periodic.or_else(in_turn) else {
            return 0;
        };
        if periodic.is_none() {
            self.last_served = chosen;
        }
        let (bytes, ended) = self.pipes[chosen].transact(wire);
        if let Some((ticket, outcome)) = ended {
            self.events.push_back(Event::Ended(ticket, outcome));
        }
        bytes
    }
}
