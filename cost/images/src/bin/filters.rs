//! Our filters, and the course's filter as others write it. Those in fixed point run from SRAM (`memory.x`), as in the
//! tracker.

#![no_std]
#![no_main]

#[path = "../../../../src/board/multiply.rs"]
mod multiply;
#[path = "../watchdog.rs"]
mod watchdog;

use multiply::Instructions;
use panic_halt as _;
use vrduino::fixed::multiply::Portable;
use vrduino_cost_images::head::{FEW, HEAD, SAMPLES};
use vrduino_cost_images::ours::{Course, CourseInFixedPoint, Default, DefaultInFixedPoint};
use vrduino_cost_images::straightforward::Straightforward;
use vrduino_cost_images::textbook::Textbook;

vrduino_cost_images::filters! {
    #[unsafe(link_section = ".fast")]
    course_fixed: CourseInFixedPoint<Instructions>, on FEW of HEAD;
    #[unsafe(link_section = ".fast")]
    course_fixed_portable: CourseInFixedPoint<Portable>, on FEW of HEAD;
    #[unsafe(link_section = ".fast")]
    default_fixed: DefaultInFixedPoint<Instructions, false>, on SAMPLES of HEAD;
    #[unsafe(link_section = ".fast")]
    default_fixed_portable: DefaultInFixedPoint<Portable, false>, on SAMPLES of HEAD;
    #[unsafe(link_section = ".fast")]
    default_fixed_compass: DefaultInFixedPoint<Instructions, true>, on SAMPLES of HEAD;
    #[unsafe(link_section = ".fast")]
    default_fixed_compass_portable: DefaultInFixedPoint<Portable, true>, on SAMPLES of HEAD;
    course_f32: Course<f32>, on FEW of HEAD;
    default_f32: Default<f32, false>, on SAMPLES of HEAD;
    default_f32_compass: Default<f32, true>, on SAMPLES of HEAD;
    textbook_f64: Textbook<f64>, on FEW of HEAD;
    textbook_f32: Textbook<f32>, on FEW of HEAD;
    straightforward: Straightforward, on FEW of HEAD;
}
