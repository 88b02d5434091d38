//! CRC-16/IBM-3740, also called CCITT-FALSE: polynomial 0x1021, from 0xFFFF, most significant bit first,
//! nothing inverted. In a message as short as ours it finds any three wrong bits, any burst of up to
//! sixteen, and all but one in 65536 of everything else.

/// Of these bytes.
///
/// ```
/// assert_eq!(vrduino::wire::crc::crc16(b"123456789"), 0x29B1);
/// ```
pub fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(u16::MAX, |crc, &byte| {
        // Eight steps of the polynomial x¹⁶ + x¹² + x⁵ + 1 at once: what leaves at the top comes back at
        // these three places, and its upper four bits once more.
        let mut top = crc >> 8 ^ u16::from(byte);
        top ^= top >> 4;
        crc << 8 ^ top << 12 ^ top << 5 ^ top
    })
}
