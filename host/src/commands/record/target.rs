//! The file that is asked for, and how it is written.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use indicatif::DecimalBytes;
use jiff::Zoned;

use super::tally::Tally;
use crate::failure::{Failure, Kind};
#[cfg(feature = "parquet")]
use crate::recording::{self, Reader};

/// How the file is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// Text, a line to a sample
    Csv,
    /// Columns for data frames, in a third of the space
    Parquet,
}

/// The file that is asked for.
#[derive(Debug)]
pub struct Target {
    path: PathBuf,
    /// Parquet cannot be read before its end is written, so until then it is CSV, here.
    meanwhile: Option<PathBuf>,
}

impl Target {
    /// By its name, or with the time for a name.
    pub fn of(file: Option<&Path>, format: Option<Format>, force: bool) -> Result<Self, Failure> {
        let ending = |path: &Path| {
            path.extension()
                .is_some_and(|ending| ending.eq_ignore_ascii_case("parquet"))
        };
        let as_parquet = match format {
            Some(format) => format == Format::Parquet,
            None => file.is_some_and(ending),
        };
        let path = match file {
            Some(path) => path.to_owned(),
            None => {
                let ending = if as_parquet { "parquet" } else { "csv" };
                let now = Zoned::now().strftime("%Y-%m-%d-%H%M%S");
                format!("vrduino-{now}.{ending}").into()
            }
        };
        if as_parquet && cfg!(not(feature = "parquet")) {
            let sentence = "this program was built without Parquet: build it with --features parquet, or record *.csv";
            return Err(Failure::new(Kind::File, sentence));
        }
        if as_parquet && path.exists() && !force {
            let sentence = format!(
                "{} is there already: choose another name, or --force to write over it",
                path.display()
            );
            return Err(Failure::new(Kind::File, sentence));
        }
        let meanwhile = as_parquet.then(|| {
            let mut name = path.clone().into_os_string();
            name.push(".csv");
            name.into()
        });
        Ok(Self { path, meanwhile })
    }

    /// What is read is not written over.
    pub fn is_not(&self, read: &Path) -> Result<(), Failure> {
        let same = |path: &Path| {
            let written = path.canonicalize().ok();
            written.is_some() && written == read.canonicalize().ok()
        };
        if same(&self.path) || same(self.written()) {
            let sentence = format!("{} is what is read: name another file", read.display());
            return Err(Failure::new(Kind::File, sentence));
        }
        Ok(())
    }

    /// Where it is written while it is made.
    pub fn written(&self) -> &Path {
        self.meanwhile.as_ref().unwrap_or(&self.path)
    }

    /// Makes of it what was asked for: its size.
    #[cfg(feature = "parquet")]
    pub fn convert(&self, bytes: u64) -> Result<u64, Failure> {
        let Some(meanwhile) = &self.meanwhile else {
            return Ok(bytes);
        };
        let converted = Reader::open(meanwhile)
            .and_then(|mut reader| recording::parquet::write(&mut reader, &self.path));
        converted.map_err(|failure| {
            let sentence = format!("{failure}; all of it is in {}", meanwhile.display());
            Failure::new(failure.kind, sentence)
        })?;
        // The same twice does no harm.
        let _ = std::fs::remove_file(meanwhile);
        Ok(std::fs::metadata(&self.path).map_or(0, |metadata| metadata.len()))
    }

    /// As it is.
    #[cfg(not(feature = "parquet"))]
    pub fn convert(&self, bytes: u64) -> Result<u64, Failure> {
        Ok(bytes)
    }

    /// Says what has been recorded.
    pub fn tell(&self, tally: &Tally, bytes: u64) {
        let file = self.path.display();
        let (done, size) = (tally.describe(), DecimalBytes(bytes));
        // Where nobody reads it, it is in the file all the same.
        let _ = writeln!(io::stdout(), "{file}: {done}, {size}");
    }
}
