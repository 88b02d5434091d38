//! Hands the firmware its linker script.
//!
//! Here and not as a flag in `.cargo/config.toml`: a RUSTFLAGS in the environment replaces those
//! flags, and the result is an empty image without an error.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=memory.x");
    if std::env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
    }
}
