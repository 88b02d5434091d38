//! Other people's filters on the chip: on the parameters their authors chose, in single precision, each fed as it asks
//! to be.
//!
//! They are told that z is up. What they are given without being asked (a bias, a start that is level) they do without.

#![no_std]
#![no_main]

#[path = "../../images/src/watchdog.rs"]
mod watchdog;

use ahrs::{Madgwick, Mahony};
use cortex_m_rt as _;
use fusion_ahrs::{Ahrs, AhrsSettings, Convention, Vector};
use mk20dx_hal as _;
use nalgebra::Vector3;
use panic_halt as _;
use vqf_rs::VQF;
use vrduino_cost_images::filter::{Counts, Filter, PERIOD_S};
use vrduino_cost_images::head::{FEW, HEAD_Z_UP};

const DPS_PER_COUNT: f32 = 2000.0 / 32768.0;
const G_PER_COUNT: f32 = 2.0 / 32768.0;
const MICROTESLA_PER_COUNT: f32 = 0.15;
const RADIANS_PER_COUNT: f32 = DPS_PER_COUNT * core::f32::consts::PI / 180.0;
const STANDARD_GRAVITY: f32 = 9.806_65;
const PERIOD: f32 = PERIOD_S as f32;

#[inline(always)]
fn scaled(counts: [i16; 3], unit: f32) -> [f32; 3] {
    counts.map(|count| f32::from(count) * unit)
}

/// With the magnetometer, every time, if `COMPASS`.
struct OfAhrs<F, const COMPASS: bool>(F, [f32; 4]);

/// Gain of `Madgwick::default()`, and those of `Mahony::default()`.
trait Gains: ahrs::Ahrs<f32> {
    fn with_its_gains() -> Self;
}

impl Gains for Madgwick<f32> {
    fn with_its_gains() -> Self {
        Madgwick::new(PERIOD, 0.1)
    }
}

impl Gains for Mahony<f32> {
    fn with_its_gains() -> Self {
        Mahony::new(PERIOD, 0.5, 0.0)
    }
}

impl<F: Gains, const COMPASS: bool> Filter for OfAhrs<F, COMPASS> {
    fn start() -> Self {
        Self(F::with_its_gains(), [1.0, 0.0, 0.0, 0.0])
    }

    #[inline]
    fn update(&mut self, counts: &Counts) {
        let rate = Vector3::from(scaled(counts.sample.gyro, RADIANS_PER_COUNT));
        let force = Vector3::from(scaled(counts.sample.accel, G_PER_COUNT));
        let fused = if COMPASS {
            let field = Vector3::from(scaled(counts.field, MICROTESLA_PER_COUNT));
            self.0.update(&rate, &force, &field)
        } else {
            self.0.update_imu(&rate, &force)
        };
        if let Ok(q) = fused {
            self.1 = [q.w, q.i, q.j, q.k];
        }
    }

    /// From a world with x north and y west to one with x east and y north: a quarter turn about up.
    fn orientation(&self) -> [f64; 4] {
        let [w, x, y, z] = self.1.map(f64::from);
        let half = core::f64::consts::FRAC_1_SQRT_2;
        [
            half * (w - z),
            half * (x - y),
            half * (y + x),
            half * (z + w),
        ]
    }
}

/// With the magnetometer, every time, if `COMPASS`.
struct XioFusion<const COMPASS: bool>(Ahrs);

impl<const COMPASS: bool> Filter for XioFusion<COMPASS> {
    fn start() -> Self {
        Self(Ahrs::with_settings(AhrsSettings {
            sample_rate: 1.0 / PERIOD,
            convention: Convention::Enu,
            ..Default::default()
        }))
    }

    #[inline]
    fn update(&mut self, counts: &Counts) {
        let vector = |[x, y, z]: [f32; 3]| Vector::new(x, y, z);
        let rate = vector(scaled(counts.sample.gyro, DPS_PER_COUNT));
        let force = vector(scaled(counts.sample.accel, G_PER_COUNT));
        if COMPASS {
            let field = vector(scaled(counts.field, MICROTESLA_PER_COUNT));
            self.0.update(rate, force, field);
        } else {
            self.0.update_no_magnetometer(rate, force);
        }
    }

    fn orientation(&self) -> [f64; 4] {
        let q = self.0.quaternion();
        [q.w, q.x, q.y, q.z].map(f64::from)
    }
}

/// With the magnetometer, whenever there is something new, if `COMPASS`.
struct Vqf<const COMPASS: bool>(VQF);

impl<const COMPASS: bool> Filter for Vqf<COMPASS> {
    fn start() -> Self {
        let field_period = COMPASS.then_some(10.0 * PERIOD);
        Self(VQF::new(PERIOD, None, field_period, None))
    }

    #[inline]
    fn update(&mut self, counts: &Counts) {
        let field =
            (COMPASS && counts.field_is_new).then(|| scaled(counts.field, MICROTESLA_PER_COUNT));
        self.0.update(
            scaled(counts.sample.gyro, RADIANS_PER_COUNT),
            scaled(counts.sample.accel, G_PER_COUNT * STANDARD_GRAVITY),
            field,
        );
    }

    fn orientation(&self) -> [f64; 4] {
        let q = if COMPASS {
            self.0.quat_9d()
        } else {
            self.0.quat_6d()
        };
        [q.0, q.1, q.2, q.3].map(f64::from)
    }
}

vrduino_cost_images::filters! {
    madgwick_6: OfAhrs<Madgwick<f32>, false>, on FEW of HEAD_Z_UP;
    madgwick_9: OfAhrs<Madgwick<f32>, true>, on FEW of HEAD_Z_UP;
    mahony_6: OfAhrs<Mahony<f32>, false>, on FEW of HEAD_Z_UP;
    mahony_9: OfAhrs<Mahony<f32>, true>, on FEW of HEAD_Z_UP;
    xio_fusion_6: XioFusion<false>, on FEW of HEAD_Z_UP;
    xio_fusion_9: XioFusion<true>, on FEW of HEAD_Z_UP;
    vqf_6: Vqf<false>, on FEW of HEAD_Z_UP;
    vqf_9: Vqf<true>, on FEW of HEAD_Z_UP;
}
