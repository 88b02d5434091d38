//! Builds sketches with PJRC's own core, if its sources and the compiler for the chip are here.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};

use vrduino_emulator::firmware;

/// The registry package that carries Teensyduino's core. Its own build script is never run.
const PACKAGE: &str = "teensy3-sys";
const VERSION: &str = "0.2.0";

const PREFIX: &str = "arm-none-eabi-";
const FLAGS: [&str; 13] = [
    "-D__MK20DX256__",
    "-DUSB_SERIAL",
    "-DLAYOUT_US_ENGLISH",
    "-DARDUINO=10805",
    "-DTEENSYDUINO=159",
    "-Os",
    "-g",
    "-mcpu=cortex-m4",
    "-mthumb",
    "-ffunction-sections",
    "-fdata-sections",
    "-w",
    "-c",
];
const C: [&str; 2] = ["-fgnu89-inline", "-fcommon"];
const CPP: [&str; 5] = [
    "-std=gnu++14",
    "-fno-exceptions",
    "-fno-rtti",
    "-fno-threadsafe-statics",
    "-felide-constructors",
];
const LINK: [&str; 5] = [
    "-Os",
    "-mcpu=cortex-m4",
    "-mthumb",
    "--specs=nano.specs",
    "-Wl,--gc-sections,--relax,--defsym=__rtc_localtime=0",
];

/// The compiler and the core's sources.
pub struct Toolchain {
    sources: PathBuf,
    output: PathBuf,
    /// Object files of the core by clock; each is compiled once.
    cores: Mutex<BTreeMap<u32, Arc<Mutex<Vec<PathBuf>>>>>,
}

impl Toolchain {
    /// Looks for what is needed; an error says what is missing, in a few words.
    pub fn find() -> Result<Toolchain, String> {
        let gcc = Command::new(format!("{PREFIX}g++"))
            .arg("--version")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .status();
        if !gcc.is_ok_and(|status| status.success()) {
            return Err(format!("{PREFIX}g++ is not installed"));
        }
        let output = firmware::target_dir()
            .map_err(|error| error.to_string())?
            .join("vendor");
        fs::create_dir_all(&output).map_err(|error| format!("{}: {error}", output.display()))?;
        let sources = sources(&output)?;
        Ok(Toolchain {
            sources,
            output,
            cores: Mutex::default(),
        })
    }

    /// Builds `emulator/tests/sketches/<name>.cpp` for a clock of `f_cpu` (Hz); returns the ELF file.
    pub fn build(&self, name: &str, f_cpu: u32) -> PathBuf {
        let mut objects = self.core(f_cpu);
        let sketch = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("tests/sketches")
            .join(name)
            .with_extension("cpp");
        let folder = self.folder(f_cpu);
        let object = folder.join(name).with_extension("o");
        self.compile(&sketch, &object, f_cpu);
        objects.push(object);
        let elf = folder.join(name).with_extension("elf");
        let script = self.sources.join("cores/teensy3/mk20dx256.ld");
        let mut link = Command::new(format!("{PREFIX}g++"));
        link.args(LINK)
            .arg("-T")
            .arg(script)
            .args(&objects)
            .arg("-o")
            .arg(&elf);
        finish(link);
        elf
    }

    fn folder(&self, f_cpu: u32) -> PathBuf {
        self.output.join(f_cpu.to_string())
    }

    /// The core and its bundled Wire and SPI, compiled once for each clock and kept in the target directory.
    fn core(&self, f_cpu: u32) -> Vec<PathBuf> {
        let slot = {
            let mut cores = self
                .cores
                .lock()
                .expect("no test panics while it holds this");
            Arc::clone(cores.entry(f_cpu).or_default())
        };
        let mut objects = slot
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        if objects.is_empty() {
            let folder = self.folder(f_cpu).join("core");
            fs::create_dir_all(&folder).expect("the target directory can be written");
            let mut sources: Vec<PathBuf> = ["cores/teensy3", "Wire", "SPI"]
                .iter()
                .flat_map(|part| {
                    fs::read_dir(self.sources.join(part)).expect("the package is whole")
                })
                .map(|entry| entry.expect("the package can be read").path())
                .filter(|path| {
                    ["c", "cpp", "S"]
                        .iter()
                        .any(|kind| path.extension() == Some(OsStr::new(kind)))
                })
                .collect();
            sources.sort();
            *objects = sources
                .iter()
                .map(|source| {
                    let name = source
                        .file_name()
                        .expect("a file has a name")
                        .to_string_lossy();
                    let object = folder.join(format!("{name}.o"));
                    // A compiler that was interrupted leaves no object under this name.
                    if !object.is_file() {
                        let partial = object.with_extension("partial");
                        self.compile(source, &partial, f_cpu);
                        fs::rename(&partial, &object).expect("the target directory can be written");
                    }
                    object
                })
                .collect();
        }
        objects.clone()
    }

    fn compile(&self, source: &Path, object: &Path, f_cpu: u32) {
        let cpp = source.extension() == Some(OsStr::new("cpp"));
        let mut compile = Command::new(format!("{PREFIX}{}", if cpp { "g++" } else { "gcc" }));
        compile.args(FLAGS).arg(format!("-DF_CPU={f_cpu}"));
        for part in ["cores/teensy3", "cores/teensy3/avr", "Wire", "SPI"] {
            compile.arg("-I").arg(self.sources.join(part));
        }
        if cpp {
            compile.args(CPP);
        } else {
            compile.args(C);
        }
        compile.arg(source).arg("-o").arg(object);
        finish(compile);
    }
}

fn finish(mut command: Command) {
    let output = command.output().expect("the compiler starts");
    assert!(
        output.status.success(),
        "{command:?}\n{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

/// The unpacked package in cargo's registry; fetched through a manifest of its own if it is not there.
fn sources(output: &Path) -> Result<PathBuf, String> {
    if let Some(found) = in_registry() {
        return Ok(found);
    }
    let scratch = output.join("fetch");
    let write = || -> std::io::Result<()> {
        fs::create_dir_all(scratch.join("src"))?;
        fs::write(scratch.join("src/lib.rs"), "")?;
        let manifest = format!(
            "[package]\nname = \"fetch\"\nedition = \"2024\"\n\n[dependencies]\n{PACKAGE} = \"={VERSION}\"\n\n[workspace]\n"
        );
        fs::write(scratch.join("Cargo.toml"), manifest)
    };
    write().map_err(|error| format!("{}: {error}", scratch.display()))?;
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let fetched = Command::new(cargo)
        .args(["fetch", "--quiet"])
        .current_dir(&scratch)
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .status();
    match in_registry() {
        Some(found) => Ok(found),
        None if fetched.is_ok_and(|status| status.success()) => {
            Err(format!("{PACKAGE} is not where cargo keeps its sources"))
        }
        None => Err(format!(
            "{PACKAGE} {VERSION} is not in cargo's registry and cannot be fetched"
        )),
    }
}

fn in_registry() -> Option<PathBuf> {
    let home = std::env::var_os("CARGO_HOME")
        .map(PathBuf::from)
        .or_else(|| Some(std::env::home_dir()?.join(".cargo")))?;
    fs::read_dir(home.join("registry/src"))
        .ok()?
        .flatten()
        .map(|registry| registry.path().join(format!("{PACKAGE}-{VERSION}")))
        .find(|package| package.join("cores/teensy3/mk20dx256.ld").is_file())
}
