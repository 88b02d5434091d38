//! The sensor as a driver sees it: through its bus alone, against the figures of the data sheets.

#[path = "sensor/aux_bus.rs"]
mod aux_bus;

#[path = "sensor/driver.rs"]
mod driver;

#[path = "sensor/fifo.rs"]
mod fifo;

#[path = "sensor/interrupts.rs"]
mod interrupts;

#[path = "sensor/low_pass.rs"]
mod low_pass;

#[path = "sensor/magnetometer.rs"]
mod magnetometer;

#[path = "sensor/outputs.rs"]
mod outputs;

#[path = "sensor/parts.rs"]
mod parts;

#[path = "sensor/power.rs"]
mod power;

#[path = "sensor/registers.rs"]
mod registers;

#[path = "sensor/sampling.rs"]
mod sampling;

#[path = "sensor/self_test.rs"]
mod self_test;
