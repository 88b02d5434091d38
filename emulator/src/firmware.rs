//! Builds the firmware: the very image that is flashed, from a host program or a test.

use std::env;
use std::error::Error;
use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};

/// The chip's target: a Cortex-M4 without floating-point unit.
pub const TARGET: &str = "thumbv7em-none-eabi";

/// How what is flashed is compiled.
pub const PROFILE: &str = "image";

/// A package whose programs run on the chip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Package {
    /// Its manifest, from the workspace's root.
    pub manifest: &'static str,
    /// The feature without which its programs are not built; empty for none.
    pub feature: &'static str,
    /// The profile by which they are compiled.
    pub profile: &'static str,
}

/// The tracker.
const TRACKER: Package = Package {
    manifest: "Cargo.toml",
    feature: "firmware",
    profile: PROFILE,
};
const TRACKER_PROGRAM: &str = "firmware";

/// Variables that would make another image than the repository describes: flags from the
/// environment take the place of the configured ones. A profile's settings are removed as well.
const FOREIGN_FLAGS: [&str; 4] = [
    "RUSTFLAGS",
    "CARGO_ENCODED_RUSTFLAGS",
    "CARGO_BUILD_RUSTFLAGS",
    "CARGO_TARGET_THUMBV7EM_NONE_EABI_RUSTFLAGS",
];
const FOREIGN_PROFILE: &str = "CARGO_PROFILE_";

/// How to build.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct BuildOptions {
    /// Keep cargo's progress to itself; warnings and errors are shown all the same.
    pub quiet: bool,
}

/// Builds the firmware and returns the path of its ELF file.
///
/// The chip's target is added with rustup if it is missing. Whatever cargo, rustc and rustup say
/// goes to standard error: standard output may carry the board's lines.
///
/// # Errors
///
/// [`BuildError`]: the sources have moved, a tool is missing, or the firmware does not build.
pub fn build(options: BuildOptions) -> Result<PathBuf, BuildError> {
    let image = build_package(TRACKER, options)?.join(TRACKER_PROGRAM);
    if image.is_file() {
        Ok(image)
    } else {
        Err(BuildError::NoImage { path: image })
    }
}

/// Whether there is an image from before, of these sources or of older ones.
pub fn is_built() -> bool {
    target_dir().is_ok_and(|folder| {
        let image = folder.join(TARGET).join(PROFILE).join(TRACKER_PROGRAM);
        image.is_file()
    })
}

/// Builds all programs of `package` and returns the folder of their ELF files.
///
/// # Errors
///
/// As for [`build`].
pub fn build_package(package: Package, options: BuildOptions) -> Result<PathBuf, BuildError> {
    let root = workspace_root()?;
    provide_target(&root)?;
    let target_dir = target_dir()?;

    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(&cargo);
    command
        .args([
            "build",
            "--manifest-path",
            package.manifest,
            "--bins",
            "--features",
            package.feature,
        ])
        .args(["--target", TARGET, "--profile", package.profile])
        .arg("--target-dir")
        .arg(&target_dir)
        .current_dir(&root)
        .stdin(Stdio::null())
        .stdout(io::stderr());
    if options.quiet {
        command.arg("--quiet");
    }
    for (name, _) in env::vars_os() {
        let foreign_profile = name
            .to_str()
            .is_some_and(|name| name.starts_with(FOREIGN_PROFILE));
        if foreign_profile || FOREIGN_FLAGS.iter().any(|&flag| name == flag) {
            command.env_remove(name);
        }
    }
    let status = command.status().map_err(|source| BuildError::Tool {
        tool: "cargo",
        source,
    })?;
    if !status.success() {
        return Err(BuildError::Build { status });
    }
    Ok(target_dir.join(TARGET).join(package.profile))
}

/// The workspace's root, where this crate was built from.
///
/// # Errors
///
/// [`BuildError::NoSources`] if it is no longer there.
pub fn workspace_root() -> Result<PathBuf, BuildError> {
    let emulator = Path::new(env!("CARGO_MANIFEST_DIR"));
    let root = emulator.parent().unwrap_or(emulator);
    if root.join("Cargo.toml").is_file() {
        Ok(root.to_path_buf())
    } else {
        Err(BuildError::NoSources {
            root: root.to_path_buf(),
        })
    }
}

/// Where cargo puts what it builds, as an absolute path.
///
/// `CARGO_TARGET_DIR` is honoured, and taken from the current directory as cargo does.
///
/// # Errors
///
/// [`BuildError::NoSources`] if the workspace is no longer there.
pub fn target_dir() -> Result<PathBuf, BuildError> {
    let root = workspace_root()?;
    let named = ["CARGO_TARGET_DIR", "CARGO_BUILD_TARGET_DIR"]
        .iter()
        .filter_map(env::var_os)
        .find(|value| !value.is_empty());
    match (named, env::current_dir()) {
        (Some(named), Ok(here)) => Ok(here.join(named)),
        (Some(named), Err(_)) => Ok(root.join(named)),
        (None, _) => Ok(root.join("target")),
    }
}

/// Makes sure that the compiler has the core library for the chip.
fn provide_target(root: &Path) -> Result<(), BuildError> {
    if has_target(root)? {
        return Ok(());
    }
    // Where nobody can read it, it need not be said.
    let _ = writeln!(io::stderr(), "the target {TARGET} is missing; adding it");
    let status = Command::new("rustup")
        .args(["target", "add", TARGET])
        .current_dir(root)
        .stdin(Stdio::null())
        .stdout(io::stderr())
        .status()
        .map_err(|source| BuildError::NoTarget {
            reason: format!("rustup does not start: {source}"),
        })?;
    if !status.success() {
        return Err(BuildError::NoTarget {
            reason: format!("`rustup target add {TARGET}` failed: {status}"),
        });
    }
    if has_target(root)? {
        Ok(())
    } else {
        let reason = "rustup added it to another compiler than `rustc` is".to_owned();
        Err(BuildError::NoTarget { reason })
    }
}

fn has_target(root: &Path) -> Result<bool, BuildError> {
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(rustc)
        .args(["--print", "target-libdir", "--target", TARGET])
        .current_dir(root)
        .stdin(Stdio::null())
        .output()
        .map_err(|source| BuildError::Tool {
            tool: "rustc",
            source,
        })?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        let silent = said.is_empty();
        return Err(BuildError::Compiler {
            said: if silent {
                output.status.to_string()
            } else {
                said
            },
        });
    }
    Ok(Path::new(String::from_utf8_lossy(&output.stdout).trim()).is_dir())
}

/// Why there is no firmware.
#[derive(Debug)]
#[non_exhaustive]
pub enum BuildError {
    /// The sources this program was built from are gone.
    NoSources {
        /// Where they were.
        root: PathBuf,
    },
    /// A tool does not start.
    Tool {
        /// Its name.
        tool: &'static str,
        /// Why it does not start.
        source: io::Error,
    },
    /// The compiler does not answer a simple question.
    Compiler {
        /// What it said instead.
        said: String,
    },
    /// The core library for the chip is missing and could not be added.
    NoTarget {
        /// Why it could not be added.
        reason: String,
    },
    /// The firmware does not build; cargo has said why.
    Build {
        /// How cargo ended.
        status: ExitStatus,
    },
    /// Cargo is content but the image is not where it belongs.
    NoImage {
        /// Where it belongs.
        path: PathBuf,
    },
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSources { root } => write!(
                f,
                "the firmware's sources are no longer in {}; build this program again from where they are now",
                root.display()
            ),
            Self::Tool { tool, source } => {
                write!(
                    f,
                    "{tool} does not start: {source}; install Rust from https://rustup.rs"
                )
            }
            Self::Compiler { said } => {
                write!(
                    f,
                    "rustc does not know the target {TARGET}: {said}; install the compiler in rust-toolchain.toml"
                )
            }
            Self::NoTarget { reason } => write!(
                f,
                "the core library for {TARGET} is missing and could not be added ({reason}); run \
                 `rustup target add {TARGET}`, or install it the way your compiler was installed"
            ),
            Self::Build { status } => write!(
                f,
                "the firmware does not build (cargo: {status}); see its messages above"
            ),
            Self::NoImage { path } => write!(
                f,
                "cargo built the firmware but {} is not there; look for other settings in your cargo configuration",
                path.display()
            ),
        }
    }
}

impl Error for BuildError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Tool { source, .. } => Some(source),
            _ => None,
        }
    }
}
