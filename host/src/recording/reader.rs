//! A recording read again, as far as it is whole.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};

use super::csv::{Said, header, read};
use super::lines::{Lines, Trouble};
#[cfg(feature = "parquet")]
use super::parquet;
use super::{Entry, Head, Row, SIGNATURE, VERSION};
use crate::failure::{Failure, Kind};

/// What a Parquet file begins with.
const PARQUET: &[u8] = b"PAR1";

/// Reads a recording.
#[derive(Debug)]
pub struct Reader {
    path: PathBuf,
    head: Head,
    rows: Rows,
    ending: Ending,
    damage: Option<Damage>,
    segment: Option<i32>,
}

/// How far it got.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ending {
    /// Rows so far.
    pub samples: u64,
    /// Arrivals of the first and the latest of them, in s on the source's clock.
    pub span: Option<(f64, f64)>,
    /// The file is over, and its end is missing.
    pub is_cut: bool,
}

/// What was passed over for what is whole behind it.
#[derive(Debug)]
struct Damage {
    /// Where the first is and what is wrong with it.
    first: String,
    lines: u64,
}

#[derive(Debug)]
enum Rows {
    Csv {
        lines: Lines<BufReader<File>>,
        has_ended: bool,
    },
    #[cfg(feature = "parquet")]
    Parquet(Box<parquet::Rows>),
}

impl Reader {
    /// Opens it and reads its head.
    ///
    /// # Errors
    ///
    /// It is not there, no recording, one of another version, or over before its first row.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let file = File::open(path).map_err(|error| unreadable(path, &error))?;
        let mut input = BufReader::with_capacity(1 << 16, file);
        let first = input.fill_buf().map_err(|error| unreadable(path, &error))?;
        let (head, rows) = if first.starts_with(PARQUET) {
            columns(path, input.into_inner())?
        } else {
            let mut lines = Lines::new(input);
            let head = read_head(path, &mut lines)?;
            let has_ended = false;
            (head, Rows::Csv { lines, has_ended })
        };
        Ok(Self {
            path: path.to_owned(),
            head,
            rows,
            ending: Ending::default(),
            damage: None,
            segment: None,
        })
    }

    /// What is known of it as a whole.
    pub fn head(&self) -> &Head {
        &self.head
    }

    /// The next entry; none behind the last that is whole. A damaged line is passed over, see [`Reader::warning`].
    ///
    /// # Errors
    ///
    /// The file cannot be read.
    pub fn read(&mut self) -> Result<Option<Entry>, Failure> {
        match &mut self.rows {
            #[cfg(feature = "parquet")]
            Rows::Parquet(rows) => match rows.read() {
                Ok(Some(parquet::Next::Row(row, segment))) => {
                    Ok(Some(Entry::Row(self.count(row, segment))))
                }
                Ok(Some(parquet::Next::Remark(remark))) => Ok(Some(Entry::Remark(remark))),
                Ok(None) => Ok(None),
                Err(what) => Err(parquet::damaged(&self.path, &what)),
            },
            Rows::Csv { .. } => self.read_line(),
        }
    }

    fn read_line(&mut self) -> Result<Option<Entry>, Failure> {
        loop {
            let has_counts = self.head.has_counts;
            #[cfg_attr(not(feature = "parquet"), expect(irrefutable_let_patterns))]
            let Rows::Csv { lines, has_ended } = &mut self.rows else {
                return Ok(None);
            };
            let line = match lines.next() {
                Ok(Some(line)) => line,
                Ok(None) => {
                    self.ending.is_cut = !*has_ended;
                    return Ok(None);
                }
                Err(trouble @ Trouble::Io(_)) => return Err(explain(&self.path, &trouble)),
                Err(trouble) => {
                    let what = explain(&self.path, &trouble).sentence;
                    self.pass_over(what);
                    continue;
                }
            };
            let number = line.number;
            let said = if *has_ended {
                Err("nothing should be behind the end marker".into())
            } else {
                read(line.text, has_counts)
            };
            if !line.is_whole && !*has_ended && !matches!(said, Ok(Said::End(_))) {
                self.ending.is_cut = true;
                return Ok(None);
            }
            match said {
                Ok(Said::Row(row, segment)) => {
                    return Ok(Some(Entry::Row(self.count(row, segment))));
                }
                Ok(Said::Remark(remark)) => return Ok(Some(Entry::Remark(remark))),
                Ok(Said::End(promised)) => {
                    *has_ended = true;
                    if let Some(what) = self.differs_from(promised) {
                        self.pass_over(misread(&self.path, number, &what).sentence);
                    }
                }
                Ok(Said::Nothing) => {}
                Err(what) => self.pass_over(misread(&self.path, number, &what).sentence),
            }
        }
    }

    fn pass_over(&mut self, what: String) {
        let damage = self.damage.get_or_insert(Damage {
            first: what,
            lines: 0,
        });
        damage.lines += 1;
    }

    /// Fewer or more rows than the end marker says, where damaged lines do not account for it.
    fn differs_from(&self, promised: u64) -> Option<String> {
        let found = self.ending.samples;
        let damaged = self.damage.as_ref().map_or(0, |damage| damage.lines);
        (promised < found || promised > found + damaged).then(|| {
            format!("it should hold {promised} samples, and holds {found}: rows were taken out or put in")
        })
    }

    fn count(&mut self, mut row: Row, segment: i32) -> Row {
        row.sample.is_first = self.segment.replace(segment) != Some(segment);
        let arrival = row.sample.arrival;
        self.ending.samples += 1;
        let (began, _) = self.ending.span.unwrap_or((arrival, arrival));
        self.ending.span = Some((began, arrival));
        row
    }

    /// How far it has got.
    pub fn ending(&self) -> Ending {
        self.ending
    }

    /// What is to be said of a file that is not whole, as far as it has been read.
    pub fn warning(&self) -> Option<String> {
        let path = self.path.display();
        let Ending {
            samples,
            span,
            is_cut,
        } = self.ending;
        let seconds = span.map_or(0.0, |(began, ended)| ended - began);
        let cut = is_cut.then(|| {
            format!("{path} is cut off: its {samples} samples of {seconds:.1} s are read, and what came behind is missing")
        });
        let damaged = self.damage.as_ref().map(|Damage { first, lines }| {
            let more = match lines - 1 {
                0 => String::new(),
                1 => " (and one more line)".into(),
                more => format!(" (and {more} more lines)"),
            };
            format!("{first}{more}; the {samples} samples that are whole are read")
        });
        let said: Vec<_> = damaged.into_iter().chain(cut).collect();
        (!said.is_empty()).then(|| said.join("; "))
    }
}

fn read_head(path: &Path, lines: &mut Lines<BufReader<File>>) -> Result<Head, Failure> {
    let cut = || {
        let path = path.display();
        Failure::new(
            Kind::File,
            format!("{path} is cut off before its first sample: there is nothing in it to read"),
        )
    };
    let mut head = Head::default();
    loop {
        let line = lines.next().map_err(|trouble| explain(path, &trouble))?;
        let line = line.ok_or_else(cut)?;
        let wrong = |what: &str| misread(path, line.number, what);
        if line.number == 1 {
            // Editors of some systems put it before any text.
            let text = line.text.trim_start_matches('\u{FEFF}');
            match text.strip_prefix(SIGNATURE).map(str::parse) {
                Some(Ok(VERSION)) => {}
                _ if !line.is_whole && SIGNATURE.starts_with(line.text) => return Err(cut()),
                Some(Ok(other)) => return Err(other_version(path, other)),
                _ => return Err(no_recording(path)),
            }
            continue;
        }
        if !line.is_whole {
            return Err(cut());
        }
        match line.text.strip_prefix("# ") {
            Some(comment) => head.learn(comment),
            None if line.text == header(true) => {
                head.has_counts = true;
                return Ok(head);
            }
            None if line.text == header(false) => return Ok(head),
            None => return Err(wrong(&format!("the columns should be {}", header(false)))),
        }
    }
}

#[cfg(feature = "parquet")]
fn columns(path: &Path, file: File) -> Result<(Head, Rows), Failure> {
    let (head, rows) = parquet::open(path, file)?;
    Ok((head, Rows::Parquet(Box::new(rows))))
}

#[cfg(not(feature = "parquet"))]
fn columns(path: &Path, _: File) -> Result<(Head, Rows), Failure> {
    let sentence = format!(
        "{} is a Parquet file, which this program was built without: build it with --features parquet",
        path.display()
    );
    Err(Failure::new(Kind::File, sentence))
}

/// A file of a version that is not known here.
pub(super) fn other_version(path: &Path, version: u32) -> Failure {
    let sentence = format!(
        "{} is a recording of version {version}, and this program reads version {VERSION}: take the vrduino that made it",
        path.display()
    );
    Failure::new(Kind::File, sentence)
}

/// A file of something else.
pub(super) fn no_recording(path: &Path) -> Failure {
    let sentence = format!(
        "{} is no recording: one begins with `{SIGNATURE}{VERSION}`, and `vrduino record` makes it",
        path.display()
    );
    Failure::new(Kind::File, sentence)
}

fn misread(path: &Path, line: u64, what: &str) -> Failure {
    let sentence = format!("{}, line {line}: {what}", path.display());
    Failure::new(Kind::File, sentence)
}

fn explain(path: &Path, trouble: &Trouble) -> Failure {
    match trouble {
        Trouble::Io(error) => unreadable(path, error),
        Trouble::TooLong(1) | Trouble::NotText(1) => no_recording(path),
        Trouble::TooLong(line) => misread(path, *line, "no line of a recording is so long"),
        Trouble::NotText(line) => misread(path, *line, "text is expected, and bytes are there"),
    }
}

fn unreadable(path: &Path, error: &io::Error) -> Failure {
    let path = path.display();
    let sentence = match error.kind() {
        io::ErrorKind::NotFound => format!("there is no file {path}"),
        io::ErrorKind::IsADirectory => format!("{path} is a folder: name a recording"),
        io::ErrorKind::PermissionDenied => format!("{path} may not be read by you"),
        _ => format!("{path} cannot be read: {error}"),
    };
    Failure::new(Kind::File, sentence)
}
