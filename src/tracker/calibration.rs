//! What is known of the sensor's faults: applied to every sample, taken from a host in pieces, and
//! handed to whoever keeps it. Finding it is the host's work; checking it is done here again.

use crate::calibration::Correction;
use crate::calibration::record::{LENGTH, Record, RecordError};
use crate::command::request::Piece;
use crate::decimal::Decimal;
use crate::fixed::fusion::Force;
use crate::sensor::{Ranges, RawSample, Sample};
use crate::units::MagneticField;
use crate::wire::{self, Line};

/// The record in use, and the one that is coming in.
#[derive(Clone, Debug)]
pub struct Calibration {
    ranges: Ranges,
    record: Record,
    correction: Correction<f32>,
    incoming: [u8; LENGTH],
    /// The record has changed and nobody has taken it yet.
    to_keep: bool,
}

impl Calibration {
    /// Nothing known of a sensor set to these ranges.
    pub fn new(ranges: Ranges) -> Self {
        Self {
            ranges,
            record: Record::default(),
            correction: Correction::none(),
            incoming: [0; LENGTH],
            to_keep: false,
        }
    }

    /// What was kept before.
    pub fn set(&mut self, record: &Record) {
        self.record = *record;
        self.correction = record.correction();
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
        if self.record.accelerometer.is_none() {
            return Force::from_counts(counts);
        }
        self.corrected(counts)
    }

    #[inline(never)]
    fn corrected(&self, counts: [i16; 3]) -> Force {
        let raw = RawSample {
            accel: counts,
            ..RawSample::default()
        };
        let sample = self.correction.sample(self.ranges.sample(&raw));
        Force::new(sample.force, self.ranges.accel)
    }

    /// The field without the board's iron.
    pub fn field(&self, field: MagneticField<f32>) -> MagneticField<f32> {
        if self.record.magnetometer.is_none() {
            return field;
        }
        self.correction.field(field)
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
