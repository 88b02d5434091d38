//! The course's own programs find the four numbers in either line.
//!
//! Each is read here as its program reads it: the visualizer and the render page of the starter code in
//! JavaScript, and the Unity script.

use vrduino::wire::{self, Decimals, Q30, Stamp, Tag};

const Q: Q30 = Q30([759_250_125, -1_000_000, 123_456_789, -759_250_125]);

fn stamp(sequence: u16) -> Stamp {
    Stamp {
        sequence,
        micros: 4_200_000_000 + u32::from(sequence),
    }
}

fn lines() -> Vec<(u32, String)> {
    let decimals = (3..=6).map(|number| Decimals::new(number).expect("3 to 6"));
    decimals
        .flat_map(|decimals| {
            let plain = wire::quaternion(Tag::Fused, Q, decimals);
            let timed = wire::timed(Q, stamp(65_535), decimals);
            let written = decimals.get();
            [
                (written, plain.to_string()),
                (written.min(5), timed.to_string()),
            ]
        })
        .collect()
}

fn check(decimals: u32, numbers: [f64; 4]) {
    for (number, bits) in numbers.into_iter().zip(Q.0) {
        let exact = f64::from(bits) / f64::from(1 << 30);
        let half = 0.5 / 10_f64.powi(decimals as i32);
        assert!(
            (number - exact).abs() <= half + 1e-12,
            "{number} of {exact}"
        );
    }
}

/// `parseFloat`: the number a word begins with; here NaN if it begins with none.
fn parse_float(word: &str) -> f64 {
    let end = word
        .find(|c: char| !(c.is_ascii_digit() || "+-.".contains(c)))
        .unwrap_or(word.len());
    word[..end].parse().unwrap_or(f64::NAN)
}

#[test]
fn the_visualizer_splits_at_single_spaces_and_parses_what_a_word_begins_with() {
    for (decimals, line) in lines() {
        // Its server cuts at the newline and may leave a carriage return.
        for line in [line.trim_end().to_owned(), format!("{}\r", line.trim_end())] {
            let data: Vec<&str> = line.split(' ').collect();
            assert_eq!(data[0], "QC");
            check(decimals, [1, 2, 3, 4].map(|word| parse_float(data[word])));
        }
    }
}

#[test]
fn the_render_page_strips_quotes_and_wants_whole_words_to_be_numbers() {
    for (decimals, line) in lines() {
        let line = format!("\"{}\"", line.trim_end()).replace('"', "");
        let data: Vec<&str> = line.split(' ').collect();
        assert_eq!(data[0], "QC");
        // `Number` of a word that is no number is NaN, which no comparison below survives.
        let number = |word: usize| data[word].parse().unwrap_or(f64::NAN);
        check(decimals, [1, 2, 3, 4].map(number));
    }
}

/// What the Unity script takes of 64 bytes: the line before the last newline, if it begins with QC.
fn unity(window: &str) -> Option<[f64; 4]> {
    let lines: Vec<&str> = window.split('\n').collect();
    let line = lines.get(lines.len().checked_sub(2)?)?;
    let words: Vec<&str> = line.split(' ').collect();
    (words[0] == "QC").then(|| [1, 2, 3, 4].map(|word| words[word].parse().expect("a number")))
}

#[test]
fn the_unity_script_takes_a_whole_line_or_none_and_of_the_default_always_one() {
    let course = |_| wire::quaternion(Tag::Fused, Q, Decimals::COURSE).to_string();
    let timed = |n: u16| wire::timed(Q, stamp(n), Decimals::COURSE).to_string();
    let stream = |line: &dyn Fn(u16) -> String| (0..2000).map(line).collect::<String>();
    let taken = |text: &str| {
        let windows = (0..text.len() / 64).map(|n| unity(&text[64 * n..64 * n + 64]));
        let windows: Vec<_> = windows.collect();
        windows
            .iter()
            .flatten()
            .for_each(|&numbers| check(3, numbers));
        windows.iter().flatten().count() as f64 / windows.len() as f64
    };
    assert_eq!(taken(&stream(&course)), 1.0);
    // A line of its own packet is whole in few windows of 64: nothing wrong comes, but little.
    let share = taken(&stream(&timed));
    assert!(share > 0.05 && share < 0.5, "{share}");
}
