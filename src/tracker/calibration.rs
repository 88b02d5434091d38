//! What is known of the sensor's faults: applied to every sample, taken from a host in pieces, and
//! handed to whoever keeps it. Finding it is the host's work; checking it is done here again.

use crate::calibration::Correction;
use crate::calibration::record::{LENGTH, Record, RecordError};
use crate::command::request::Piece;
use crate::decimal::Decimal;
use crate::fixed::affine::{Accelerometer, Magnetometer};
use crate::fixed::fusion::{Field, Force};
use crate::fixed::multiply::Multiply;
use crate::sensor::magnetometer::{RawField, Resolution, SensitivityAdjustment};
use crate::sensor::{Ranges, Sample};
use crate::wire::{self, Line};

/// The record in use, and the one that is coming in.
#[derive(Clone, Debug)]
pub struct Calibration<M> {
    ranges: Ranges,
    record: Record,
    correction: Correction<f32>,
    /// The same for counts, which hold whatever a record may; none where nothing is known.
    accelerometer: Option<Accelerometer<M>>,
    /// None while there is no magnetometer.
    adjustment: Option<SensitivityAdjustment>,
    magnetometer: Option<Magnetometer<M>>,
    incoming: [u8; LENGTH],
    /// The record has changed and nobody has taken it yet.
    to_keep: bool,
}

impl<M: Multiply> Calibration<M> {
    /// Nothing known of a sensor set to these ranges.
    pub fn new(ranges: Ranges) -> Self {
        Self {
            ranges,
            record: Record::default(),
            correction: Correction::none(),
            accelerometer: None,
            adjustment: None,
            magnetometer: None,
            incoming: [0; LENGTH],
            to_keep: false,
        }
    }

    /// What was kept before.
    pub fn set(&mut self, record: &Record) {
        self.record = *record;
        self.correction = record.correction();
        self.accelerometer = match record.accelerometer {
            Some(_) => Accelerometer::new(&self.correction.accelerometer, self.ranges.accel),
            None => None,
        };
        self.prepare_magnetometer();
    }

    /// How sensitive the magnetometer is, if there is one.
    pub fn set_magnetometer(&mut self, adjustment: Option<SensitivityAdjustment>) {
        self.adjustment = adjustment;
        self.prepare_magnetometer();
    }

    fn prepare_magnetometer(&mut self) {
        let microtesla_per_count = Resolution::Bits16.microtesla_per_count() as f32;
        self.magnetometer = self.adjustment.and_then(|adjustment| {
            let sensitivity = adjustment.factors() * microtesla_per_count;
            Magnetometer::new(&self.correction.magnetometer, sensitivity)
        });
    }

    /// The record, once after each change.
    pub fn take_to_keep(&mut self) -> Option<Record> {
        core::mem::take(&mut self.to_keep).then_some(self.record)
    }

    /// The sample with its force corrected; the gyro's bias stays in it.
    pub fn sample(&self, sample: Sample<f32>) -> Sample<f32> {
        if self.record.accelerometer.is_none() {
            return sample;
        }
        self.correction.sample(sample)
    }

    /// The force corrected, in counts.
    #[inline(always)]
    pub fn force(&self, counts: [i16; 3]) -> Force {
        match &self.accelerometer {
            Some(accelerometer) => corrected(accelerometer, counts),
            None => Force::from_counts(counts),
        }
    }

    /// The field without the board's iron, body frame; none without a magnetometer.
    pub fn field(&self, raw: &RawField) -> Option<Field> {
        let counts = match raw.resolution {
            Resolution::Bits16 => raw.counts,
            // A count of these is four of the others.
            Resolution::Bits14 => raw.counts.map(|count| count.saturating_mul(4)),
        };
        match &self.magnetometer {
            Some(magnetometer) => Some(magnetometer.field(counts)),
            None => {
                let field = raw.field(self.adjustment?).ok()?;
                Some(Field::new(self.correction.field(field)))
            }
        }
    }

    /// Whether the board's iron is known.
    pub fn knows_field(&self) -> bool {
        self.record.magnetometer.is_some()
    }

    /// Some bytes of a record. Nothing changes before the whole was checked.
    pub fn take(&mut self, piece: &Piece) -> Line {
        let (at, bytes) = (piece.at(), piece.bytes());
        let Some(place) = self.incoming.get_mut(at..at + bytes.len()) else {
            return wire::text(format_args!("ERR {at}: a record has {LENGTH} bytes"));
        };
        place.copy_from_slice(bytes);
        wire::text(format_args!("OK keep {} bytes at {at}", bytes.len()))
    }

    /// All pieces are there: uses them if they are a record. What is not in it stays as it is known.
    ///
    /// # Errors
    ///
    /// A [`RecordError`] says why they are none; what was known stays in use.
    pub fn finish(&mut self) -> Result<Record, RecordError> {
        let new = Record::from_bytes(&self.incoming)?;
        let record = Record {
            gyro: new.gyro.or(self.record.gyro),
            accelerometer: new.accelerometer.or(self.record.accelerometer),
            magnetometer: new.magnetometer.or(self.record.magnetometer),
        };
        self.set(&record);
        self.to_keep = true;
        Ok(record)
    }

    /// As the sensor was made.
    pub fn forget(&mut self) {
        self.set(&Record::default());
        self.to_keep = true;
    }

    /// What is known.
    pub fn state(&self) -> Line {
        let Record {
            magnetometer,
            accelerometer,
            ..
        } = &self.record;
        let field = magnetometer.as_ref().map(|result| {
            let strength = Decimal(result.strength_microtesla, 1);
            (strength, Decimal(result.error_percent, 1))
        });
        let force = accelerometer
            .as_ref()
            .map(|result| Decimal(result.residual, 3));
        match (field, force) {
            (None, None) => wire::text("OK calibration: none"),
            (None, Some(force)) => wire::text(format_args!(
                "OK calibration: force within {force} m/s2, field none"
            )),
            (Some((strength, error)), None) => wire::text(format_args!(
                "OK calibration: field {strength} uT within {error} %, force none"
            )),
            (Some((strength, error)), Some(force)) => wire::text(format_args!(
                "OK calibration: field {strength} uT within {error} %, force within {force} m/s2"
            )),
        }
    }
}

/// Once in an image, for whoever asks for a force.
#[inline(never)] // in SRAM, see memory.x
fn corrected<M: Multiply>(accelerometer: &Accelerometer<M>, counts: [i16; 3]) -> Force {
    accelerometer.force(counts)
}
