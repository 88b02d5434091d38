//! The documents name items of the library and tests; every one of them is there.

use std::fs;
use std::path::{Path, PathBuf};

/// What stands between backquotes in the documents.
fn names() -> Vec<(String, String)> {
    let mut names = Vec::new();
    for document in ["equations.md", "errata.md", "conventions.md"] {
        let text = read(&root().join("docs").join(document));
        let quoted = text.split('`').skip(1).step_by(2);
        names.extend(quoted.map(|name| (document.to_owned(), name.to_owned())));
    }
    names
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Whether `text` defines or re-exports `name`.
fn defines(text: &str, name: &str) -> bool {
    const KEYWORDS: [&str; 8] = [
        "fn", "struct", "enum", "trait", "type", "const", "mod", "static",
    ];
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let found = text.match_indices(name).any(|(at, _)| {
        let (before, after) = (&text[..at], &text[at + name.len()..]);
        let word = before
            .trim_end()
            .rsplit(|c: char| !is_name(c))
            .next()
            .unwrap_or_default();
        KEYWORDS.contains(&word) && before.ends_with(' ') && !after.starts_with(is_name)
    });
    let re_exported = text.lines().any(|line| {
        line.trim_start().starts_with("pub use")
            && line.split(|c: char| !is_name(c)).any(|word| word == name)
    });
    // A variant of an enum or a field of a struct.
    let member = text.lines().any(|line| {
        let line = line.trim();
        let line = line.strip_prefix("pub ").unwrap_or(line);
        line.strip_prefix(name)
            .is_some_and(|rest| rest.starts_with([',', '(', ':']) || rest.starts_with(" {"))
    });
    found || re_exported || member
}

/// An item such as `vrduino::orientation::tilt::TiltCorrection::apply`.
fn item_exists(path: &str) -> bool {
    let mut segments = path.split("::").skip(1).peekable();
    let mut folder = root().join("src");
    let mut file = folder.join("lib.rs");
    while let Some(&segment) = segments.peek() {
        let module = folder.join(format!("{segment}.rs"));
        if !module.is_file() {
            break;
        }
        folder = folder.join(segment);
        file = module;
        segments.next();
    }
    // A module re-exports items of the files below it, which have their methods; those that lead
    // from one document to another stand in `frames`.
    let below = fs::read_dir(&folder).into_iter().flatten().flatten();
    let mut text = read(&file);
    for entry in below.filter(|entry| !folder.ends_with("src") && entry.path().is_file()) {
        text += &read(&entry.path());
    }
    // The module itself is enough, or an item in it and what belongs to the item.
    let Some(item) = segments.next() else {
        return true;
    };
    let implements = |text: &str| {
        let mut impls = text.lines().filter(|line| line.starts_with("impl"));
        impls.any(|line| line.contains(&format!(" {item}<")))
    };
    let frames = fs::read_dir(root().join("src/frames"))
        .into_iter()
        .flatten();
    for entry in frames.flatten() {
        let elsewhere = read(&entry.path());
        if implements(&elsewhere) {
            text += &elsewhere;
        }
    }
    defines(&text, item) && segments.all(|name| defines(&text, name))
}

/// A test such as `tests/tilt.rs::a_test` or `emulator/tests/sensor/fifo.rs::a_test`.
fn test_exists(path: &str) -> bool {
    let Some((file, name)) = path.split_once("::") else {
        return root().join(path).is_file();
    };
    let file: PathBuf = root().join(file);
    file.is_file() && tests(&read(&file), name)
}

/// Whether `text` has a function `name` that is run as a test.
fn tests(text: &str, name: &str) -> bool {
    text.split("#[test]").skip(1).any(|after| {
        let function = after.split_once("fn ").map(|(_, function)| function);
        function.is_some_and(|function| function.starts_with(&format!("{name}(")))
    })
}

#[test]
fn every_item_and_every_test_that_the_documents_name_is_there() {
    let mut seen = (0, 0);
    for (document, name) in names() {
        if name.starts_with("vrduino::") {
            seen.0 += 1;
            assert!(item_exists(&name), "{document}: no item {name}");
        } else if name.starts_with("examples/") {
            assert!(
                root().join(&name).is_file(),
                "{document}: no example {name}"
            );
        } else if name.starts_with("tests/") || name.starts_with("emulator/tests/") {
            seen.1 += 1;
            assert!(test_exists(&name), "{document}: no test {name}");
        } else if name.starts_with("examples/") {
            assert!(root().join(&name).is_file(), "{document}: no {name}");
        }
    }
    assert!(seen.0 > 50 && seen.1 > 50, "only {seen:?} names were found");
}

#[test]
fn no_path_in_the_tables_escapes_the_check() {
    for document in ["equations.md", "errata.md", "conventions.md"] {
        let text = read(&root().join("docs").join(document));
        let plain: String = text.split('`').step_by(2).collect();
        assert!(
            !plain.contains("::"),
            "{document} has a path that is not quoted"
        );
        let quoted = text.split('`').skip(1).step_by(2);
        for name in quoted.filter(|name| name.contains("::")) {
            let known = [
                "vrduino::",
                "tests/",
                "emulator/tests/",
                "nalgebra::",
                "glm::",
            ];
            assert!(
                known.iter().any(|start| name.starts_with(start)),
                "{document}: {name}"
            );
        }
    }
}

#[test]
fn what_is_not_there_is_found_out() {
    assert!(item_exists(
        "vrduino::orientation::complementary::Complementary::update"
    ));
    assert!(!item_exists(
        "vrduino::orientation::complementary::Complementary::levitate"
    ));
    assert!(!item_exists("vrduino::astrology::Horoscope"));
    assert!(test_exists(
        "tests/index.rs::what_is_not_there_is_found_out"
    ));
    assert!(item_exists("vrduino::virtual_gyro::TaitBryan::to_notes"));
    assert!(!item_exists("vrduino::frames::angles::TaitBryan::to_sea"));
    assert!(!test_exists("tests/index.rs::what_is_not"));
    assert!(!test_exists("tests/index.rs::test_exists"));
    assert!(!test_exists("tests/astrology.rs::anything"));
}

#[test]
fn every_numbered_equation_has_its_row() {
    let text = read(&root().join("docs/equations.md"));
    let has_row = |document: &str, number: u32| {
        let number = number.to_string();
        text.lines().any(|line| {
            let mut cells = line.split('|').skip(1);
            let (documents, place) = (cells.next().unwrap_or(""), cells.next().unwrap_or(""));
            documents.contains(document)
                && place.contains("eq.")
                && place
                    .split(|c: char| !c.is_ascii_digit())
                    .any(|digits| digits == number)
        })
    };
    for number in 1..=39 {
        assert!(
            has_row("000", number),
            "no row for equation {number} of the course notes"
        );
    }
    for number in 1..=7 {
        assert!(
            has_row("002", number),
            "no row for equation ({number}) of the paper"
        );
    }
}
