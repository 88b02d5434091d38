//! Other programs: who holds a port, who runs, who is installed.

use std::env;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

/// Where Linux lists what runs.
const PROCESSES: &str = "/proc";

/// A program that runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    /// Its name.
    pub name: String,
    /// Its number.
    pub pid: u32,
}

impl fmt::Display for Program {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (process {})", self.name, self.pid)
    }
}

/// Who has this port open, besides this program; others' programs may not be seen.
pub fn holders(port: &str) -> Vec<Program> {
    let port = fs::canonicalize(port).unwrap_or_else(|_| port.into());
    let mut found = running(Path::new(PROCESSES));
    found.retain(|(program, folder)| {
        program.pid != std::process::id()
            && fs::read_dir(folder.join("fd")).is_ok_and(|handles| {
                handles
                    .flatten()
                    .any(|handle| fs::read_link(handle.path()).is_ok_and(|open| open == port))
            })
    });
    found.into_iter().map(|(program, _)| program).collect()
}

/// Whether a program of this name runs.
pub fn is_running(name: &str) -> bool {
    running(Path::new(PROCESSES))
        .iter()
        .any(|(program, _)| program.name == name)
}

/// Every process and its folder, by number.
fn running(processes: &Path) -> Vec<(Program, PathBuf)> {
    let Ok(entries) = fs::read_dir(processes) else {
        return Vec::new();
    };
    let mut found: Vec<_> = entries
        .flatten()
        .filter_map(|entry| {
            let pid = entry.file_name().to_str()?.parse().ok()?;
            let name = fs::read_to_string(entry.path().join("comm")).ok()?;
            let name = name.trim().to_owned();
            Some((Program { name, pid }, entry.path()))
        })
        .collect();
    found.sort_by_key(|(program, _)| program.pid);
    found
}

/// Where a program is installed, by the folders in PATH.
pub fn installed(name: &str) -> Option<PathBuf> {
    let file = format!("{name}{}", env::consts::EXE_SUFFIX);
    env::split_paths(&env::var_os("PATH")?)
        .map(|folder| folder.join(&file))
        .find(|path| is_executable(path))
}

#[cfg(unix)]
fn is_executable(path: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    fs::metadata(path).is_ok_and(|file| file.is_file() && file.permissions().mode() & 0o111 != 0)
}

#[cfg(not(unix))]
fn is_executable(path: &Path) -> bool {
    path.is_file()
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::{PROCESSES, holders, running};
    use std::fs::File;
    use std::path::Path;
    use std::process::{Command, Stdio};

    #[test]
    fn whoever_has_a_file_open_is_found() {
        let path = std::env::temp_dir().join(format!("vrduino-held-{}", std::process::id()));
        File::create(&path).unwrap();
        let name = path.to_str().unwrap();
        assert_eq!(holders(name), []);
        let input = Stdio::from(File::open(&path).unwrap());
        let sleep = Command::new("sleep").arg("30").stdin(input).spawn();
        let mut sleep = sleep.unwrap();
        // Its name is that of this program until it has become another.
        let held = (0..500).find_map(|_| {
            std::thread::sleep(std::time::Duration::from_millis(10));
            let held = holders(name);
            (held.len() == 1 && held[0].name == "sleep").then(|| held[0].pid)
        });
        sleep.kill().unwrap();
        sleep.wait().unwrap();
        assert_eq!(held, Some(sleep.id()));
        assert_eq!(holders(name), []);
        std::fs::remove_file(&path).unwrap();
        assert!(!running(Path::new(PROCESSES)).is_empty());
    }
}
