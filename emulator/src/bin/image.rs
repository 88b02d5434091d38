//! `cargo image`: builds what is flashed, checks it, and says how large it is.

use std::env;
use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use vrduino_emulator::firmware::{self, BuildOptions};
use vrduino_emulator::image::{FLASH_SIZE, Image, RAM_SIZE};

/// Builds the firmware's image and prints how to flash it.
///
/// Writes vrduino.elf, with names for the emulator, and vrduino.hex, for the loader, into the target directory. An
/// image that would not start or would lock the chip is refused.
#[derive(Parser)]
#[command(name = "cargo image")]
struct Arguments {
    /// Show errors and warnings of the build only.
    #[arg(short, long)]
    quiet: bool,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("image: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let built = firmware::build(BuildOptions {
        quiet: arguments.quiet,
    })?;
    let image = Image::open(&built)?;

    let folder = firmware::target_dir()?;
    let (elf, hex) = (folder.join("vrduino.elf"), folder.join("vrduino.hex"));
    let contents =
        fs::read(&built).map_err(|error| format!("cannot read {}: {error}", built.display()))?;
    write(&elf, &contents)?;
    write(&hex, image.to_hex().as_bytes())?;

    print_use("flash", image.flash_used(), FLASH_SIZE);
    print_use("RAM", image.ram_used().unwrap_or(0), RAM_SIZE);
    println!("image  {}", from_here(&elf));
    println!(
        "flash it: teensy_loader_cli --mcu=TEENSY32 -w -v {}",
        from_here(&hex)
    );
    Ok(())
}

fn print_use(memory: &str, used: usize, size: usize) {
    let percent = 100.0 * used as f64 / size as f64;
    println!("{memory:<6} {used} of {size} bytes ({percent:.1} %)");
}

fn write(path: &Path, contents: &[u8]) -> Result<(), String> {
    fs::write(path, contents).map_err(|error| {
        format!(
            "cannot write {}: {error}; is the disk full?",
            path.display()
        )
    })
}

/// The path as it can be typed in the current directory.
fn from_here(path: &Path) -> String {
    let here = env::current_dir().unwrap_or_default();
    path.strip_prefix(&here)
        .unwrap_or(path)
        .display()
        .to_string()
}
