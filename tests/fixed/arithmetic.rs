//! The vocabulary against integers wide enough not to round.

use crate::random::Random;
use vrduino::fixed::multiply::{Multiply, Portable};
use vrduino::fixed::number::Q;

const ENDS: [i32; 11] = [
    i32::MIN,
    i32::MIN + 1,
    -1 << 30,
    -1 << 16,
    -1,
    0,
    1,
    1 << 16,
    1 << 30,
    i32::MAX - 1,
    i32::MAX,
];

fn any(random: &mut Random) -> i32 {
    (random.unit() * 4_294_967_296.0) as u32 as i32
}

/// ARMv7-M manual: the result is bits 63 to 32 of the sum of sum:0, ± the product, and 0x8000_0000.
fn upper(sum: i32, product: i128) -> i32 {
    (((i128::from(sum) << 32) + product + 0x8000_0000) >> 32) as i32
}

fn check(sum: i32, a: i32, b: i32) {
    let product = i128::from(a) * i128::from(b);
    assert_eq!(Portable::high(a, b), upper(0, product), "{a} {b}");
    assert_eq!(
        Portable::add_high(sum, a, b),
        upper(sum, product),
        "{sum} {a} {b}"
    );
    assert_eq!(
        Portable::subtract_high(sum, a, b),
        upper(sum, -product),
        "{sum} {a} {b}"
    );
}

#[test]
fn a_product_is_the_upper_half_rounded() {
    for sum in ENDS {
        for a in ENDS {
            for b in ENDS {
                check(sum, a, b);
            }
        }
    }
    let mut random = Random(3);
    for _ in 0..1_000_000 {
        check(any(&mut random), any(&mut random), any(&mut random));
    }
}

#[test]
fn half_a_bit_is_rounded_up() {
    assert_eq!(Portable::high(1 << 30, 2), 1);
    assert_eq!(Portable::high(1 << 30, -2), 0);
    assert_eq!(Portable::subtract_high(0, 1 << 30, 2), 0);
    assert_eq!(Portable::subtract_high(0, 1 << 30, -2), 1);
}

#[test]
fn a_constant_is_the_nearest_there_is() {
    let mut random = Random(5);
    for _ in 0..100_000 {
        let value = random.between(-1.999, 1.999);
        let bits = Q::<Portable, 30>::constant(value).bits();
        let error = f64::from(bits) - value * f64::from(1 << 30);
        assert!(error.abs() <= 0.5, "{value}");
    }
    assert_eq!(Q::<Portable, 30>::constant(7.0).bits(), i32::MAX);
    assert_eq!(Q::<Portable, 30>::constant(-7.0).bits(), i32::MIN);
}

#[test]
fn a_product_has_the_value_of_the_product() {
    let mut random = Random(7);
    for _ in 0..100_000 {
        let (a, b) = (random.between(-0.49, 0.49), random.between(-1.9, 1.9));
        let (qa, qb) = (
            Q::<Portable, 32>::constant(a),
            Q::<Portable, 30>::constant(b),
        );
        let product: Q<Portable, 30> = Q::product(qa, qb);
        let exact =
            f64::from(qa.bits()) * f64::from(qb.bits()) / f64::from(1 << 16) / f64::from(1 << 16);
        assert!((f64::from(product.bits()) - exact).abs() <= 0.5, "{a} {b}");
    }
}
