//! What the debugger is told of the processor and its memory.

/// The registers, as GDB names them for an M-profile processor (*Debugging with GDB*, G.5.3).
pub(super) fn target() -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?><!DOCTYPE target SYSTEM \"gdb-target.dtd\"><target version=\"1.0\">\
         <architecture>arm</architecture><feature name=\"org.gnu.gdb.arm.m-profile\">",
    );
    for number in 0..13 {
        text += &format!("<reg name=\"r{number}\" bitsize=\"32\" type=\"uint32\"/>");
    }
    text += "<reg name=\"sp\" bitsize=\"32\" type=\"data_ptr\"/>\
             <reg name=\"lr\" bitsize=\"32\"/>\
             <reg name=\"pc\" bitsize=\"32\" type=\"code_ptr\"/>\
             <reg name=\"xpsr\" bitsize=\"32\" regnum=\"25\"/></feature>\
             <feature name=\"org.gnu.gdb.arm.m-system\">\
             <reg name=\"msp\" bitsize=\"32\" type=\"data_ptr\"/>\
             <reg name=\"psp\" bitsize=\"32\" type=\"data_ptr\"/></feature></target>";
    text
}

/// The memories (K20 manual, section 4.2); everything else is registers, which may be read as well.
pub(super) const MEMORY: &str = "<?xml version=\"1.0\"?><!DOCTYPE memory-map SYSTEM \"gdb-memory-map.dtd\"><memory-map>\
    <memory type=\"rom\" start=\"0x0\" length=\"0x40000\"/>\
    <memory type=\"ram\" start=\"0x14000000\" length=\"0x800\"/>\
    <memory type=\"ram\" start=\"0x1fff8000\" length=\"0x10000\"/>\
    <memory type=\"ram\" start=\"0x40000000\" length=\"0x100000\"/>\
    <memory type=\"ram\" start=\"0xe0000000\" length=\"0x100000\"/></memory-map>";

/// Where register `number` of the debugger's stands among ours.
pub(super) fn index(number: usize) -> Option<usize> {
    match number {
        0..=15 => Some(number),
        25..=27 => Some(number - 9),
        _ => None,
    }
}
