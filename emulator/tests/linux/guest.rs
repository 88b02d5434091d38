//! What the guest is made of, as far as this machine has it.

use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use object::{File, Object};

use crate::archive::Archive;

/// Modules the guest needs; those that they need in turn are found.
const MODULES: [&str; 3] = ["vhci-hcd", "cdc-acm", "e1000"];

/// Everything that is needed to boot.
pub struct Guest {
    pub qemu: PathBuf,
    pub kernel: PathBuf,
    busybox: PathBuf,
    /// Files in the order in which they are to be loaded.
    modules: Vec<PathBuf>,
}

impl Guest {
    /// Looks for all of it; what is missing is told in a few words.
    pub fn find() -> Result<Guest, String> {
        let qemu = program("qemu-system-x86_64")?;
        let busybox = program("busybox")?;
        let program = fs::read(&busybox).unwrap_or_default();
        let program = File::parse(program.as_slice())
            .map_err(|error| format!("{} is no program: {error}", busybox.display()))?;
        if program.section_by_name(".interp").is_some() {
            return Err("busybox is not the static one".into());
        }
        let (kernel, modules) = kernels()
            .into_iter()
            .find_map(|version| {
                let kernel = Path::new("/boot").join(format!("vmlinuz-{version}"));
                fs::File::open(&kernel).ok()?;
                let modules = modules(&Path::new("/lib/modules").join(version))?;
                Some((kernel, modules))
            })
            .ok_or(
                "no readable kernel in /boot with vhci-hcd, cdc-acm and e1000 in /lib/modules",
            )?;
        Ok(Guest {
            qemu,
            kernel,
            busybox,
            modules,
        })
    }

    /// The guest's first and only file system.
    pub fn file_system(&self) -> Result<Vec<u8>, String> {
        let read =
            |path: &Path| fs::read(path).map_err(|error| format!("{}: {error}", path.display()));
        let mut archive = Archive::default();
        archive.directory("bin");
        archive.directory("modules");
        archive.file("bin/busybox", &read(&self.busybox)?);
        archive.file("init", include_bytes!("init.sh"));
        archive.file("attach.sh", include_bytes!("attach.sh"));
        let mut order = String::new();
        for path in &self.modules {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            archive.file(&format!("modules/{name}"), &read(path)?);
            order += &format!("{name}\n");
        }
        archive.file("modules/order", order.as_bytes());
        Ok(archive.finish())
    }
}

fn program(name: &str) -> Result<PathBuf, String> {
    let path = env::var_os("PATH").unwrap_or_default();
    env::split_paths(&path)
        .map(|directory| directory.join(name))
        .find(|file| file.is_file())
        .ok_or(format!("{name} is not installed"))
}

/// Versions that have modules, the newest first as far as their names tell.
fn kernels() -> Vec<String> {
    let entries = fs::read_dir("/lib/modules").into_iter().flatten().flatten();
    let mut versions: Vec<String> = entries
        .filter_map(|entry| entry.file_name().into_string().ok())
        .collect();
    versions.sort();
    versions.reverse();
    versions
}

/// The modules' files, each after those that it needs; `None` if one is not there. What is built into the kernel needs
/// none.
fn modules(directory: &Path) -> Option<Vec<PathBuf>> {
    let list = fs::read_to_string(directory.join("modules.dep")).ok()?;
    let built_in = fs::read_to_string(directory.join("modules.builtin")).unwrap_or_default();
    // "path: paths of what it needs, the last to be loaded first"
    let needs: BTreeMap<&str, (&str, &str)> = list
        .lines()
        .filter_map(|line| line.split_once(':'))
        .map(|(path, needed)| (name(path), (path, needed)))
        .collect();
    let mut order = Vec::new();
    for module in MODULES {
        let Some((path, needed)) = needs.get(module) else {
            if built_in.lines().any(|line| name(line) == module) {
                continue;
            }
            return None;
        };
        for path in needed.split_whitespace().rev().chain([*path]) {
            let path = directory.join(path);
            if !order.contains(&path) {
                order.push(path);
            }
        }
    }
    Some(order)
}

/// A module's name: its file's, without what follows the first dot.
fn name(path: &str) -> &str {
    let file = path.rsplit('/').next().unwrap_or(path);
    file.split('.').next().unwrap_or(file)
}
