//! Who gets how much of the terminal.

use ratatui::layout::{Constraint, Layout, Rect};

/// Columns and rows without which there is no picture.
pub const LEAST: [u16; 2] = [80, 24];

/// From so many on the numbers and strips stand beside the picture.
const WIDE: [u16; 2] = [116, 30];

/// Columns of the numbers beside the picture where there are few.
const NUMBERS: u16 = 39;

/// Rows of the numbers above the strips where there are many.
const NUMBERS_ROWS: u16 = 12;

/// Where what is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Areas {
    /// One row: what is seen.
    pub title: Rect,
    /// The picture.
    pub view: Rect,
    /// The numbers, where there is room for them.
    pub numbers: Option<Rect>,
    /// Yaw, pitch and roll.
    pub strips: [Rect; 3],
    /// What the board says.
    pub lines: Rect,
    /// One row: the keys.
    pub keys: Rect,
}

impl Areas {
    /// For a terminal of this size; none if it is too small.
    pub fn of(whole: Rect, is_stereo: bool) -> Option<Self> {
        if whole.width < LEAST[0] || whole.height < LEAST[1] {
            return None;
        }
        let is_wide = whole.width >= WIDE[0] && whole.height >= WIDE[1];
        let said = if whole.height >= WIDE[1] {
            whole.height / 7
        } else {
            4
        };
        let [title, middle, lines, keys] = Layout::vertical([
            Constraint::Length(1),
            Constraint::Fill(1),
            Constraint::Length(said),
            Constraint::Length(1),
        ])
        .areas(whole);
        let (view, numbers, strips) = match (is_stereo, is_wide) {
            (true, _) => Self::beneath_both_eyes(middle, is_wide),
            (false, true) => Self::beside(middle),
            (false, false) => Self::beneath(middle),
        };
        Some(Self {
            title,
            view,
            numbers,
            strips,
            lines,
            keys,
        })
    }

    fn beside(middle: Rect) -> (Rect, Option<Rect>, [Rect; 3]) {
        let [view, right] =
            Layout::horizontal([Constraint::Fill(1), Constraint::Percentage(42)]).areas(middle);
        let [numbers, strips] =
            Layout::vertical([Constraint::Max(NUMBERS_ROWS), Constraint::Fill(1)]).areas(right);
        let strips = Layout::vertical([Constraint::Fill(1); 3]).areas(strips);
        (view, Some(numbers), strips)
    }

    fn beneath(middle: Rect) -> (Rect, Option<Rect>, [Rect; 3]) {
        let [upper, strips] =
            Layout::vertical([Constraint::Fill(2), Constraint::Fill(1)]).areas(middle);
        let [view, numbers] =
            Layout::horizontal([Constraint::Fill(1), Constraint::Length(NUMBERS)]).areas(upper);
        let strips = Layout::horizontal([Constraint::Fill(1); 3]).areas(strips);
        (view, Some(numbers), strips)
    }

    /// Two pictures want the whole width.
    fn beneath_both_eyes(middle: Rect, is_wide: bool) -> (Rect, Option<Rect>, [Rect; 3]) {
        let [view, beneath] =
            Layout::vertical([Constraint::Fill(2), Constraint::Fill(1)]).areas(middle);
        let width = if is_wide { NUMBERS } else { 0 };
        let [numbers, strips] =
            Layout::horizontal([Constraint::Length(width), Constraint::Fill(1)]).areas(beneath);
        let strips = Layout::horizontal([Constraint::Fill(1); 3]).areas(strips);
        (view, is_wide.then_some(numbers), strips)
    }
}
