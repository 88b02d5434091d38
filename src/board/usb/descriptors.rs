//! Who the device says it is.

use core::fmt::Write;

use heapless::String;
use mk20dx_hal::pac;
use usb_device::LangID;
use usb_device::bus::UsbBusAllocator;
use usb_device::device::{StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbVidPid};

use super::bus::Bus;

/// PJRC's identity for a Teensy with a serial port.
const IDENTITY: UsbVidPid = UsbVidPid(0x16C0, 0x0483);
/// The course's server opens only ports of exactly this manufacturer.
const MANUFACTURER: &str = "Teensyduino";
const PRODUCT: &str = "VRduino head tracker";
const CDC_CLASS: u8 = 0x02;
/// The largest packet for endpoint 0 and the only one that every host takes.
const CONTROL_PACKET: u8 = 64;

/// A device on `allocator`'s bus with the chip's own number as its serial number.
pub fn device(allocator: &'static UsbBusAllocator<Bus>, sim: &pac::Sim) -> UsbDevice<'static, Bus> {
    let serial =
        cortex_m::singleton!(: String<16> = String::new()).expect("the board is taken once");
    // The lower half of the chip's unique number (K20 manual, 12.2.20); sixteen digits always fit.
    let _ = write!(
        serial,
        "{:08X}{:08X}",
        sim.uidml().read().bits(),
        sim.uidl().read().bits()
    );
    let strings = StringDescriptors::new(LangID::EN_US)
        .manufacturer(MANUFACTURER)
        .product(PRODUCT)
        .serial_number(serial);
    UsbDeviceBuilder::new(allocator, IDENTITY)
        .strings(&[strings])
        .expect("one language fits")
        .max_packet_size_0(CONTROL_PACKET)
        .expect("64 is a legal size")
        .device_class(CDC_CLASS)
        .build()
}
