//! Where a value stands on an axis, and which values are written beside it.

/// How an axis is laid out.
#[derive(Clone, Copy, Default, PartialEq)]
pub enum Scale {
    /// Evenly, from the smallest value to the largest.
    #[default]
    Even,
    /// Degrees from −180 to 180. A line that jumps from one end to the other is interrupted.
    Circle,
    /// By powers of ten; what is not above zero has no place.
    Decades,
}

/// An axis that fits what is drawn over it.
pub struct Axis {
    scale: Scale,
    /// In values, or in their logarithms.
    ends: [f64; 2],
    /// Values and how they are written: four to eight, by decades at times one or two more.
    pub ticks: Vec<(f64, String)>,
}

impl Scale {
    /// Fits all values that are finite.
    pub fn axis(self, values: impl Iterator<Item = f64>) -> Axis {
        let fold = |[low, high]: [f64; 2], value: f64| [low.min(value), high.max(value)];
        let values = values.map(|value| self.even(value));
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let [low, high] = values.filter(|value| value.is_finite()).fold(none, fold);
        let ends = match self {
            Self::Circle => [-180.0, 180.0],
            _ if low > high => [0.0, 1.0],
            _ if low == high => [low - 1.0, high + 1.0],
            _ => [low, high],
        };
        let ticks = match self {
            Self::Even => even_ticks(ends),
            Self::Circle => [-180, -90, 0, 90, 180]
                .map(|degrees| (f64::from(degrees), written(f64::from(degrees), 0)))
                .into(),
            Self::Decades => decade_ticks(ends),
        };
        Axis {
            scale: self,
            ends,
            ticks,
        }
    }

    /// Whether a line from one value to the next would cross the whole axis for nothing.
    pub fn jumps(self, from: f64, to: f64) -> bool {
        self == Self::Circle && (to - from).abs() > 180.0
    }

    fn even(self, value: f64) -> f64 {
        if self == Self::Decades {
            value.log10()
        } else {
            value
        }
    }
}

impl Axis {
    /// From 0 at its beginning to 1 at its end.
    pub fn place(&self, value: f64) -> f64 {
        let [low, high] = self.ends;
        (self.scale.even(value) - low) / (high - low)
    }
}

/// Most ticks on an axis.
const MOST: f64 = 8.0;

/// Multiples of the finest round step that are not too many.
fn even_ticks([low, high]: [f64; 2]) -> Vec<(f64, String)> {
    let decade = ((high - low) / MOST).log10().floor();
    let steps = [1.0, 2.0, 2.5, 5.0, 10.0, 20.0].map(|factor| factor * 10_f64.powf(decade));
    let count = |step: f64| (high / step).floor() - (low / step).ceil() + 1.0;
    let step = steps.into_iter().find(|step| count(*step) <= MOST);
    let step = step.unwrap_or(high - low);
    let quarters = step / 10_f64.powf(decade) == 2.5;
    let digits = (f64::from(u8::from(quarters)) - decade).max(0.0) as usize;
    let first = (low / step).ceil();
    (0..count(step) as u32)
        .map(|k| (first + f64::from(k)) * step)
        .map(|value| (value, written(value, digits)))
        .collect()
}

/// 1 of every decade, or 1 and 3, or 1, 2 and 5: the fewest that are four.
fn decade_ticks([low, high]: [f64; 2]) -> Vec<(f64, String)> {
    let ticks = |factors: &[f64]| -> Vec<(f64, String)> {
        let decades = low.floor() as i32..=high.ceil() as i32;
        let all = decades.flat_map(|decade| {
            let digits = (-decade).max(0) as usize;
            let values = factors.iter().map(move |f| f * 10_f64.powi(decade));
            values.map(move |value| (value, written(value, digits)))
        });
        let inside = |value: f64| (low - 1e-9..=high + 1e-9).contains(&value.log10());
        all.filter(|(value, _)| inside(*value)).collect()
    };
    let sets: [&[f64]; 3] = [&[1.0], &[1.0, 3.0], &[1.0, 2.0, 5.0]];
    let enough = sets.into_iter().map(ticks).find(|ticks| ticks.len() >= 4);
    enough.unwrap_or_else(|| ticks(sets[2]))
}

/// With a minus that is one, and no minus at zero.
fn written(value: f64, digits: usize) -> String {
    format!("{:.digits$}", value + 0.0).replace('-', "−")
}
