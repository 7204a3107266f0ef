//! How pieces tell how far they have come, and keep what they yield on the way.

use std::sync::atomic::{AtomicBool, Ordering};
use twinslip::integrate::Control;
use twinslip_output::RowList;
use twinslip_tasks::scene::Sink;

/// How far a piece has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reached {
    /// Such a part of its run, in percent.
    Percent(u32),
    /// So many points of its branches or curves.
    Points(usize),
    /// All of it.
    Whole,
}

/// A piece on its way.
#[derive(Debug, Clone, Copy)]
pub struct Going<'a> {
    /// Its scene.
    pub scene: &'a str,
    /// What it computes, in words.
    pub what: &'a str,
    /// How far it has come.
    pub reached: Reached,
}

/// Whom pieces tell how far they have come.
pub(super) type Hears<'a> = &'a (dyn Fn(Going<'_>) + Sync);

/// One piece's part of the talk.
pub(super) struct Voice<'a> {
    pub hears: Hears<'a>,
    pub scene: &'a str,
    pub what: &'a str,
}

impl Voice<'_> {
    pub fn says(&self, reached: Reached) {
        (self.hears)(Going {
            scene: self.scene,
            what: self.what,
            reached,
        });
    }
}

/// Keeps what a run yields.
pub(super) struct Kept<'a> {
    pub rows: RowList,
    /// Points of the picture are kept and not rows.
    pub pictured: bool,
    pub stop: &'a AtomicBool,
    pub voice: &'a Voice<'a>,
    /// What was told last.
    pub percent: u32,
}

impl Sink for Kept<'_> {
    fn row(&mut self, row: &[f64]) -> Control {
        if !self.pictured {
            self.rows.numbers.extend_from_slice(row);
        }
        Control::Continue
    }

    fn drawn(&mut self, point: &[f64]) {
        self.rows.numbers.extend_from_slice(point);
    }

    fn reached(&mut self, fraction: f64) -> Control {
        let percent = (100.0 * fraction) as u32;
        if percent > self.percent {
            self.percent = percent;
            self.voice.says(Reached::Percent(percent));
        }
        if self.stop.load(Ordering::Relaxed) {
            Control::Stop
        } else {
            Control::Continue
        }
    }
}
