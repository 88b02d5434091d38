//! What a host can set: a number each, with a unit and a range.

/// What can be set, one number each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting {
    /// τ of the default estimator's tilt.
    TiltTime,
    /// ζ of it.
    Damping,
    /// How far ahead of the last sample the orientation is given.
    Lead,
    /// τ of its heading.
    HeadingTime,
    /// How far the field may lie from the reference.
    FieldTolerance,
    /// τ of the notes' filter.
    NotesTime,
    /// α of the notes' filter, the gyro's weight in a sample of a millisecond.
    NotesAlpha,
}

impl Setting {
    /// The names of all of them.
    pub(super) const NAMES: &str =
        "tilt-time damping lead heading-time field-tolerance notes-time notes-alpha";

    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::TiltTime,
        Self::Damping,
        Self::Lead,
        Self::HeadingTime,
        Self::FieldTolerance,
        Self::NotesTime,
        Self::NotesAlpha,
    ];

    /// As it is typed.
    pub const fn name(self) -> &'static str {
        match self {
            Self::TiltTime => "tilt-time",
            Self::Damping => "damping",
            Self::Lead => "lead",
            Self::HeadingTime => "heading-time",
            Self::FieldTolerance => "field-tolerance",
            Self::NotesTime => "notes-time",
            Self::NotesAlpha => "notes-alpha",
        }
    }

    /// Of its value; empty for a plain number.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::TiltTime | Self::HeadingTime | Self::NotesTime => "s",
            Self::Lead => "ms",
            Self::Damping | Self::FieldTolerance | Self::NotesAlpha => "",
        }
    }

    /// Of its value, as the board answers it: of a weight close to 1, what matters is what it lacks.
    pub const fn decimals(self) -> u32 {
        match self {
            Self::NotesAlpha => 6,
            _ => 4,
        }
    }

    /// Least and greatest value.
    pub const fn range(self) -> [f32; 2] {
        match self {
            Self::TiltTime => [0.1, 100.0],
            Self::Damping => [0.1, 5.0],
            Self::Lead => [0.0, 100.0],
            Self::HeadingTime => [0.1, 1000.0],
            Self::FieldTolerance => [0.01, 1.0],
            Self::NotesTime => [0.0, 1000.0],
            Self::NotesAlpha => [0.0, 1.0],
        }
    }
}
