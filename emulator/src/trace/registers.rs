//! Names of registers and of their bits (K20 manual, the memory map of each chapter).

use crate::chip;

/// A register by its offset in its peripheral.
type Registers = &'static [(u32, &'static str)];

/// Bits from bit 0 upwards; `-` has no name.
type Bits = [&'static str; 8];

#[rustfmt::skip]
const I2C: Registers = &[
    (0, "A1"), (1, "F"), (2, "C1"), (3, "S"), (4, "D"), (5, "C2"), (6, "FLT"), (7, "RA"), (8, "SMB"), (9, "A2"),
    (10, "SLTH"), (11, "SLTL"),
];
#[rustfmt::skip]
const USB: Registers = &[
    (0x00, "PERID"), (0x04, "IDCOMP"), (0x08, "REV"), (0x0C, "ADDINFO"), (0x10, "OTGISTAT"), (0x14, "OTGICR"),
    (0x18, "OTGSTAT"), (0x1C, "OTGCTL"), (0x80, "ISTAT"), (0x84, "INTEN"), (0x88, "ERRSTAT"), (0x8C, "ERREN"),
    (0x90, "STAT"), (0x94, "CTL"), (0x98, "ADDR"), (0x9C, "BDTPAGE1"), (0xA0, "FRMNUML"), (0xA4, "FRMNUMH"),
    (0xA8, "TOKEN"), (0xAC, "SOFTHLD"), (0xB0, "BDTPAGE2"), (0xB4, "BDTPAGE3"), (0x100, "USBCTRL"),
    (0x104, "OBSERVE"), (0x108, "CONTROL"), (0x10C, "USBTRC0"), (0x114, "USBFRMADJUST"),
];
#[rustfmt::skip]
const MCG: Registers = &[
    (0, "C1"), (1, "C2"), (2, "C3"), (3, "C4"), (4, "C5"), (5, "C6"), (6, "S"), (8, "SC"), (10, "ATCVH"),
    (11, "ATCVL"), (12, "C7"), (13, "C8"),
];
#[rustfmt::skip]
const SIM_LOW: Registers = &[(0, "SOPT1"), (4, "SOPT1CFG")];
#[rustfmt::skip]
const SIM: Registers = &[
    (0x04, "SOPT2"), (0x0C, "SOPT4"), (0x10, "SOPT5"), (0x18, "SOPT7"), (0x24, "SDID"), (0x28, "SCGC1"),
    (0x2C, "SCGC2"), (0x30, "SCGC3"), (0x34, "SCGC4"), (0x38, "SCGC5"), (0x3C, "SCGC6"), (0x40, "SCGC7"),
    (0x44, "CLKDIV1"), (0x48, "CLKDIV2"), (0x4C, "FCFG1"), (0x50, "FCFG2"), (0x54, "UIDH"), (0x58, "UIDMH"),
    (0x5C, "UIDML"), (0x60, "UIDL"),
];
#[rustfmt::skip]
const WDOG: Registers = &[
    (0x00, "STCTRLH"), (0x02, "STCTRLL"), (0x04, "TOVALH"), (0x06, "TOVALL"), (0x08, "WINH"), (0x0A, "WINL"),
    (0x0C, "REFRESH"), (0x0E, "UNLOCK"), (0x10, "TMROUTH"), (0x12, "TMROUTL"), (0x14, "RSTCNT"), (0x16, "PRESC"),
];
#[rustfmt::skip]
const FTFL: Registers = &[
    (0x00, "FSTAT"), (0x01, "FCNFG"), (0x02, "FSEC"), (0x03, "FOPT"), (0x04, "FCCOB3"), (0x05, "FCCOB2"),
    (0x06, "FCCOB1"), (0x07, "FCCOB0"), (0x08, "FCCOB7"), (0x09, "FCCOB6"), (0x0A, "FCCOB5"), (0x0B, "FCCOB4"),
    (0x0C, "FCCOBB"), (0x0D, "FCCOBA"), (0x0E, "FCCOB9"), (0x0F, "FCCOB8"), (0x10, "FPROT3"), (0x11, "FPROT2"),
    (0x12, "FPROT1"), (0x13, "FPROT0"), (0x16, "FEPROT"), (0x17, "FDPROT"),
];
#[rustfmt::skip]
const GPIO: [&str; 6] = ["PDOR", "PSOR", "PCOR", "PTOR", "PDIR", "PDDR"];

fn registers_of(peripheral: &str, address: u32) -> Registers {
    match peripheral {
        "I2C0" | "I2C1" => I2C,
        "USB0" => USB,
        "MCG" => MCG,
        "SIM" if address & 0xF000 == 0x7000 => SIM_LOW,
        "SIM" => SIM,
        "WDOG" => WDOG,
        "FTFL" => FTFL,
        "SMC" => &[(0, "PMPROT"), (1, "PMCTRL"), (2, "VLLSCTRL"), (3, "PMSTAT")],
        "PMC" => &[(0, "LVDSC1"), (1, "LVDSC2"), (2, "REGSC")],
        "RCM" => &[
            (0, "SRS0"),
            (1, "SRS1"),
            (4, "RPFC"),
            (5, "RPFW"),
            (7, "MR"),
        ],
        "OSC" => &[(0, "CR")],
        "PIT" => &[(0, "MCR")],
        _ => &[],
    }
}

/// The register's name, such as `I2C0_C1`.
fn name(address: u32) -> String {
    let Some(peripheral) = chip::peripheral_at(address) else {
        return format!("{address:#010x}");
    };
    let offset = address & 0xFFF;
    let known = registers_of(peripheral, address)
        .iter()
        .find(|(at, _)| *at == offset);
    if let Some((_, register)) = known {
        return format!("{peripheral}_{register}");
    }
    match peripheral {
        "PORTA" | "PORTB" | "PORTC" | "PORTD" | "PORTE" if offset < 0x80 => {
            format!("{peripheral}_PCR{}", offset / 4)
        }
        "GPIO" if offset < 0x140 && offset % 0x40 < 0x18 => {
            let port = char::from(b'A' + (offset / 0x40) as u8);
            format!("GPIO{port}_{}", GPIO[(offset % 0x40 / 4) as usize])
        }
        "PIT" if (0x100..0x140).contains(&offset) => {
            let register = ["LDVAL", "CVAL", "TCTRL", "TFLG"][(offset % 0x10 / 4) as usize];
            format!("PIT_{register}{}", (offset - 0x100) / 0x10)
        }
        "USB0" if (0xC0..0x100).contains(&offset) => format!("USB0_ENDPT{}", (offset - 0xC0) / 4),
        _ => format!("{peripheral} + {offset:#x}"),
    }
}

#[rustfmt::skip]
fn bits(name: &str) -> Option<Bits> {
    Some(match name {
        "I2C0_C1" => ["DMAEN", "WUEN", "RSTA", "TXAK", "TX", "MST", "IICIE", "IICEN"],
        "I2C0_S" => ["RXAK", "IICIF", "SRW", "RAM", "ARBL", "BUSY", "IAAS", "TCF"],
        "USB0_ISTAT" | "USB0_INTEN" =>
            ["USBRST", "ERROR", "SOFTOK", "TOKDNE", "SLEEP", "RESUME", "ATTACH", "STALL"],
        "USB0_CTL" =>
            ["USBENSOFEN", "ODDRST", "RESUME", "HOSTMODEEN", "RESET", "TXSUSPENDTOKENBUSY", "SE0", "JSTATE"],
        "USB0_ERRSTAT" | "USB0_ERREN" =>
            ["PIDERR", "CRC5EOF", "CRC16", "DFN8", "BTOERR", "DMAERR", "-", "BTSERR"],
        "MCG_S" => ["IRCST", "OSCINIT0", "-", "-", "IREFST", "PLLST", "LOCK0", "LOLS0"],
        "FTFL_FSTAT" => ["MGSTAT0", "-", "-", "-", "FPVIOL", "ACCERR", "RDCOLERR", "CCIF"],
        "RCM_SRS0" => ["WAKEUP", "LVD", "LOC", "LOL", "-", "WDOG", "PIN", "POR"],
        "RCM_SRS1" => ["JTAG", "LOCKUP", "SW", "MDM_AP", "EZPT", "SACKERR", "-", "-"],
        _ => return None,
    })
}

/// An access in words, such as `I2C0_S -> 0xA2 TCF BUSY IICIF`.
pub(super) fn access(address: u32, width: u8, value: Option<u32>, store: bool) -> String {
    let name = name(address);
    let arrow = if store { "<-" } else { "->" };
    let Some(value) = value else {
        return format!("{name} {arrow} bus fault");
    };
    let digits = usize::from(width) * 2;
    let mut text = format!("{name} {arrow} 0x{value:0digits$x}");
    let bits = bits(&name).unwrap_or(["-"; 8]);
    for (bit, label) in bits.into_iter().enumerate().rev() {
        if value >> bit & 1 != 0 && label != "-" {
            text.push(' ');
            text += label;
        }
    }
    text
}
