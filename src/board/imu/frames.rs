//! Reading by the host's frames instead of the sensor's clock.

use super::super::timer::TICKS_PER_US;
use super::super::usb;

/// A frame.
const FRAME: u32 = 1000 * TICKS_PER_US;
/// From a START to the packet at its endpoint: addresses, burst, filter and frame. Locked on USB, that is how long ahead
/// of the host's next frame a read begins.
const AHEAD: u32 = 510 * TICKS_PER_US;
/// Frames without word of which the host counts as away.
const FRAMES_MISSED: u32 = 5;

/// Ticks from `now` until a read has to begin to be done by the start of a frame, at least `pause`; none if there are
/// no frames.
#[inline(never)]
pub fn until_ahead(now: u32, pause: u32) -> Option<u32> {
    let since = now.wrapping_sub(usb::last_frame());
    if since > FRAMES_MISSED * FRAME {
        return None;
    }
    let wait = (2 * FRAME - AHEAD - since % FRAME) % FRAME;
    Some(if wait < pause { wait + FRAME } else { wait })
}
