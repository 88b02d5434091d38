//! A recording as it is made: whole lines only, on the disk within a second.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::csv::{write_end, write_entry, write_head};
use super::{Entry, Head};
use crate::failure::{Failure, Kind};

/// What has come is on the disk after this time: a crash loses no more.
const AT_LEAST_EVERY: Duration = Duration::from_millis(500);

/// And as soon as there is so much of it.
const AT_MOST: usize = 64 * 1024;

/// Writes a recording.
#[derive(Debug)]
pub struct Writer {
    path: PathBuf,
    file: File,
    /// There was none of this name before.
    is_new: bool,
    /// Lines that are not on the disk yet, and the rows among them.
    pending: String,
    pending_rows: u64,
    /// On the disk: bytes and rows.
    bytes: u64,
    rows: u64,
    segment: i32,
    has_counts: bool,
    has_begun: bool,
    has_failed: bool,
    flushed: Instant,
}

impl Writer {
    /// Opens the file: a new one, unless `force` says that what it holds may go. That goes once something is written.
    ///
    /// # Errors
    ///
    /// There is one already, or it cannot be made.
    pub fn create(path: &Path, force: bool) -> Result<Self, Failure> {
        let (file, is_new) = open(path, force)?;
        Ok(Self {
            path: path.to_owned(),
            file,
            is_new,
            pending: String::new(),
            pending_rows: 0,
            bytes: 0,
            rows: 0,
            segment: 0,
            has_counts: false,
            has_begun: false,
            has_failed: false,
            flushed: Instant::now(),
        })
    }

    /// Writes the head. Before it nothing is written.
    ///
    /// # Errors
    ///
    /// As for [`Writer::write`].
    pub fn begin(&mut self, head: &Head) -> Result<(), Failure> {
        self.has_begun = true;
        if self.is_on_a_disk() {
            self.file.set_len(0).map_err(|error| self.refused(&error))?;
        }
        self.has_counts = head.has_counts;
        write_head(head, &mut self.pending);
        self.flush()
    }

    /// Whether the head is written.
    pub fn has_begun(&self) -> bool {
        self.has_begun
    }

    /// Whether the file takes nothing any more.
    pub fn has_failed(&self) -> bool {
        self.has_failed
    }

    /// Takes an entry.
    ///
    /// # Errors
    ///
    /// The disk is full or fails; what is on it is whole lines.
    pub fn write(&mut self, entry: &Entry) -> Result<(), Failure> {
        if let Entry::Row(row) = entry {
            if row.sample.is_first && self.rows() > 0 {
                self.segment = self.segment.saturating_add(1);
            }
            self.pending_rows += 1;
        }
        write_entry(entry, self.segment, self.has_counts, &mut self.pending);
        if self.pending.len() >= AT_MOST {
            self.flush()?;
        }
        Ok(())
    }

    /// Sees to it that nothing waits for long; to be called often.
    ///
    /// # Errors
    ///
    /// As for [`Writer::write`].
    pub fn keep_up(&mut self) -> Result<(), Failure> {
        if self.flushed.elapsed() >= AT_LEAST_EVERY {
            self.flush()?;
        }
        Ok(())
    }

    /// Rows so far.
    pub fn rows(&self) -> u64 {
        self.rows + self.pending_rows
    }

    /// Bytes so far.
    pub fn bytes(&self) -> u64 {
        self.bytes + self.pending.len() as u64
    }

    /// Writes the end marker.
    ///
    /// # Errors
    ///
    /// As for [`Writer::write`].
    pub fn finish(&mut self) -> Result<(), Failure> {
        write_end(self.rows(), &mut self.pending);
        self.flush()?;
        match self.file.sync_all() {
            // Some systems tell only now that there was no room.
            Err(error) if self.is_on_a_disk() => Err(self.refused(&error)),
            _ => Ok(()),
        }
    }

    /// There is nothing to record: no file is left behind, where one was made.
    pub fn abandon(self) {
        if self.is_new && !self.has_begun {
            // An empty file that cannot be removed does no harm.
            let _ = fs::remove_file(&self.path);
        }
    }

    fn is_on_a_disk(&self) -> bool {
        self.file
            .metadata()
            .is_ok_and(|metadata| metadata.is_file())
    }

    fn flush(&mut self) -> Result<(), Failure> {
        self.flushed = Instant::now();
        let mut written = 0;
        while written < self.pending.len() {
            match self.file.write(&self.pending.as_bytes()[written..]) {
                Ok(0) => return Err(self.give_up(written, &io::ErrorKind::WriteZero.into())),
                Ok(count) => written += count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(self.give_up(written, &error)),
            }
        }
        self.bytes += self.pending.len() as u64;
        self.rows += self.pending_rows;
        self.pending.clear();
        self.pending_rows = 0;
        Ok(())
    }

    /// So much of what was pending is in the file, and no more will be: half a line of it is none.
    fn give_up(&mut self, written: usize, error: &io::Error) -> Failure {
        let written = &self.pending.as_bytes()[..written];
        let whole = written.iter().rposition(|&byte| byte == b'\n');
        let whole = &written[..whole.map_or(0, |end| end + 1)];
        self.bytes += whole.len() as u64;
        self.rows += whole
            .split_inclusive(|&byte| byte == b'\n')
            .filter(|line| line[0].is_ascii_digit() || line[0] == b'-')
            .count() as u64;
        // What cannot be cut off either is passed over by the reader.
        let _ = self.file.set_len(self.bytes);
        self.pending.clear();
        self.pending_rows = 0;
        self.has_failed = true;
        self.refused(error)
    }

    fn refused(&self, error: &io::Error) -> Failure {
        let path = self.path.display();
        let why = match error.kind() {
            io::ErrorKind::StorageFull => "the disk is full".into(),
            io::ErrorKind::FileTooLarge | io::ErrorKind::QuotaExceeded => {
                "it may not grow any further here".into()
            }
            _ => error.to_string(),
        };
        let kept = match self.rows {
            0 => "nothing is recorded".into(),
            rows => format!("its {rows} samples so far are kept and can be read"),
        };
        let sentence = format!(
            "{path} cannot be written to: {why}; {kept}. Make room, or record to another disk"
        );
        Failure::new(Kind::File, sentence)
    }
}

fn open(path: &Path, force: bool) -> Result<(File, bool), Failure> {
    let refuse = |sentence| Failure::new(Kind::File, sentence);
    let shown = path.display();
    let mut options = OpenOptions::new();
    options.write(true);
    // What is there and no file, as /dev/stdout, cannot be lost.
    let is_there = fs::metadata(path).ok();
    match &is_there {
        Some(metadata) if metadata.is_dir() => {
            return Err(refuse(format!("{shown} is a folder: name a file")));
        }
        Some(metadata) if metadata.is_file() && !force => {
            return Err(refuse(format!(
                "{shown} is there already: choose another name, or --force to write over it"
            )));
        }
        Some(_) => &options,
        None => options.create_new(true),
    };
    let file = options.open(path).map_err(|error| {
        let sentence = match error.kind() {
            io::ErrorKind::NotFound => {
                format!("{shown} cannot be made: there is no such folder")
            }
            io::ErrorKind::PermissionDenied => {
                format!("{shown} may not be written by you: choose another folder")
            }
            _ => format!("{shown} cannot be made: {error}"),
        };
        refuse(sentence)
    })?;
    Ok((file, is_there.is_none()))
}
