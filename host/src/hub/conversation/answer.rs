//! Which line answers which question, after `docs/commands.md`.

/// Whether it is an answer, to whatever question.
pub fn is_one(line: &str) -> bool {
    line.starts_with("OK ") || line.starts_with("ERR ")
}

/// What `line` answers to `question`: what follows its `OK`, or the whole `ERR`. None if it answers something
/// else, as one that comes too late.
pub fn to(question: &str, line: &str) -> Option<Result<String, String>> {
    let mut words = question.trim_start_matches(':').split_ascii_whitespace();
    let (verb, first) = (words.next().unwrap_or_default(), words.next());
    if let Some(answer) = line.strip_prefix("OK ") {
        let subject = match (verb, first) {
            ("help", _) => "verbs",
            ("version", _) => "vrduino",
            ("every", _) => "stream",
            ("get" | "set", name) => name?,
            ("forget", _) | ("keep", Some("done")) => "calibration",
            (verb, _) => verb,
        };
        let is_it = answer.split([' ', ':']).next() == Some(subject);
        return is_it.then(|| Ok(answer.to_owned()));
    }
    // It names the first word that is wrong, as far as it has room for it.
    let (wrong, _) = line.strip_prefix("ERR ")?.split_once(':')?;
    let mut words = question.trim_start_matches(':').split_ascii_whitespace();
    words
        .any(|word| word.starts_with(wrong))
        .then(|| Err(line.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::to;

    #[test]
    fn an_answer_is_known_by_its_first_word() {
        for (question, line) in [
            (":help", "OK verbs: help version"),
            (":version", "OK vrduino 0.1.0"),
            (":estimator notes", "OK estimator notes"),
            (":get tilt-time", "OK tilt-time 3.0000 s"),
            (":set tilt-time 2", "OK tilt-time 2.0000 s"),
            (":keep 24 00ff", "OK keep 2 bytes at 24"),
            (":keep done", "OK calibration: field 44.7 uT within 1.9 %"),
            (":forget", "OK calibration: none"),
            (":stream", "OK stream text every 10"),
            (":every 5", "OK stream text every 5"),
        ] {
            assert!(
                matches!(to(question, line), Some(Ok(_))),
                "{question}: {line}"
            );
        }
        for (question, line) in [
            (":set", "ERR set: tilt-time damping"),
            (":set tilt-time 1000", "ERR 1000: tilt-time is 0.1 to 100 s"),
            (":keep done", "ERR done: checksum"),
            (":banana", "ERR banana: no such verb, :help lists them"),
        ] {
            assert_eq!(to(question, line), Some(Err(line.to_owned())));
        }
    }

    #[test]
    fn what_answers_something_else_answers_nothing() {
        for (question, line) in [
            (":stream", "OK verbs: help version"),
            (":get damping", "OK tilt-time 3.0000 s"),
            (":version", "ERR no SD card"),
            (":version", "ERR card: none"),
            (":version", "vrduino 0.1.0"),
        ] {
            assert_eq!(to(question, line), None, "{question}: {line}");
        }
    }
}
