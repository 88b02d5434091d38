//! The page of `vrduino view` as a person uses it: the program runs, with the emulated board that boots the
//! image which is flashed, and Chromium shows it. Without Chromium the tests are shown as ignored.
//!
//! Pictures are kept in `target/pictures`; `VRDUINO_PICTURES=docs/pictures cargo test -p vrduino-host --test browser
//! pictures` makes those of the README anew.

mod absence;
mod bytes;
mod chromium;
mod controls;
mod eyes;
mod graphics;
mod memory;
mod moving;
mod pictures;
#[path = "../program/mod.rs"]
mod program;
mod serial;

#[path = "../program/server.rs"]
mod server;

mod tab;
mod wire;

use std::process::ExitCode;
use std::sync::Arc;

use chromium::Chromium;
use libtest_mimic::{Arguments, Failed, Trial};

type Test = fn(&Chromium) -> Result<(), Failed>;

const TESTS: [(&str, Test); 18] = [
    ("the_board_turns_as_the_sensor_does", moving::turns),
    ("a_drag_turns_the_emulated_sensor", moving::by_hand),
    ("two_pages_show_the_same_board", moving::two_pages),
    ("two_eyes_see_what_the_library_says", eyes::matrices),
    ("controls_reach_the_board", controls::reach_the_board),
    ("ahead_is_where_the_board_points", controls::recenter),
    ("a_pulled_cable_shows_and_is_put_back", absence::cable),
    (
        "without_a_board_there_is_the_emulated_one",
        absence::no_board,
    ),
    (
        "an_emulated_board_that_starts_or_has_stopped_says_so",
        absence::not_yet_and_no_more,
    ),
    ("a_program_that_ended_is_found_again", absence::no_program),
    ("a_lost_context_comes_back", graphics::lost_context),
    ("without_webgl_there_are_numbers", graphics::no_webgl),
    ("a_phone_shows_all_of_it", graphics::phone),
    ("the_page_decodes_as_the_library_does", wire::decodes),
    ("a_board_on_web_serial_is_read", serial::read),
    (
        "ten_minutes_at_a_kilohertz_take_no_memory",
        memory::ten_minutes,
    ),
    ("a_hidden_page_piles_nothing_up", memory::hidden),
    ("pictures_for_the_readme", pictures::for_the_readme),
];

fn main() -> ExitCode {
    let mut arguments = Arguments::from_args();
    // Every one of them keeps all cores busy with drawing.
    arguments.test_threads.get_or_insert(1);
    let Some(chromium) = Chromium::installed().map(Arc::new) else {
        // Whoever includes what is ignored has the recordings, not Chromium; asked for by `--ignored`, they fail:
        // a test that did not run has not passed.
        arguments.include_ignored = false;
        let trials = TESTS.map(|(name, _)| {
            Trial::test(name, || Err("Chromium is not installed".into()))
                .with_kind("Chromium is not installed")
                .with_ignored_flag(true)
        });
        return libtest_mimic::run(&arguments, trials.into()).exit_code();
    };
    let trials = TESTS.map(|(name, test)| {
        let chromium = Arc::clone(&chromium);
        Trial::test(name, move || test(&chromium))
    });
    libtest_mimic::run(&arguments, trials.into()).exit_code()
}
