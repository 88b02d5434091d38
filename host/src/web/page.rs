//! The page: its parts, compiled in, so that there is nothing to install.

/// A part of the page.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Its name, which is its path behind the slash.
    pub name: &'static str,
    /// What it is.
    pub text: &'static str,
}

macro_rules! parts {
    ($($name:literal),* $(,)?) => {
        &[$(Part {
            name: $name,
            text: include_str!(concat!("../page/", $name)),
        }),*]
    };
}

/// All of them; the first is the page itself.
pub const PARTS: &[Part] = parts![
    "index.html",
    "board.js",
    "charts.js",
    "console.js",
    "controls.js",
    "gl.js",
    "hand.js",
    "history.js",
    "hook.js",
    "icon.svg",
    "keys.js",
    "labels.js",
    "lanes.js",
    "latency.js",
    "layout.css",
    "main.js",
    "notice.js",
    "orbit.js",
    "paper.js",
    "picture.js",
    "room.js",
    "samples.js",
    "serial.js",
    "shaders.js",
    "shapes.js",
    "status.js",
    "stream.js",
    "style.css",
    "theme.js",
    "view.js",
    "wire.js",
];

/// The part at this path.
pub fn find(path: &str) -> Option<&'static Part> {
    let name = match path.strip_prefix('/')? {
        "" => PARTS[0].name,
        name => name,
    };
    PARTS.iter().find(|part| part.name == name)
}

impl Part {
    /// Its type, by its name.
    pub fn mime(&self) -> &'static str {
        match self.name.rsplit_once('.') {
            Some((_, "html")) => "text/html; charset=utf-8",
            Some((_, "css")) => "text/css; charset=utf-8",
            Some((_, "js")) => "text/javascript; charset=utf-8",
            Some((_, "svg")) => "image/svg+xml",
            _ => "text/plain; charset=utf-8",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{PARTS, find};

    #[test]
    fn every_file_of_the_page_is_a_part_of_a_type_that_browsers_take() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/page");
        let mut files: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|file| file.unwrap().file_name().into_string().unwrap())
            .collect();
        let mut parts: Vec<_> = PARTS.iter().map(|part| part.name.to_owned()).collect();
        files.sort();
        parts.sort();
        assert_eq!(parts, files);
        for part in PARTS {
            assert_ne!(part.mime(), "text/plain; charset=utf-8", "{}", part.name);
        }
    }

    #[test]
    fn there_is_nothing_else() {
        assert_eq!(find("/").unwrap().name, "index.html");
        for path in [
            "",
            "index.html",
            "//",
            "/../page.rs",
            "/%2e%2e/page.rs",
            "/INDEX.html",
        ] {
            assert!(find(path).is_none(), "{path}");
        }
    }
}
