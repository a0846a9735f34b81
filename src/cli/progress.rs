//! A progress bar on standard error, if that is a terminal.

use std::ops::ControlFlow;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::Interrupt;

/// A bar for this many entries, or a bar that draws nothing.
pub(super) fn bar(draws: bool, entries: u64) -> ProgressBar {
    let target = if draws { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let style = ProgressStyle::with_template("{wide_bar} {pos}/{len} entries  {elapsed} (left {eta})");
    ProgressBar::with_draw_target(Some(entries), target)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// Draws the progress of a fit, and stops it when the user asks.
pub(super) fn follow(done: u64, bar: &ProgressBar, interrupt: &Interrupt) -> ControlFlow<()> {
    // Threads may report out of order, but the bar must not move backwards.
    bar.update(|bar| bar.set_pos(bar.pos().max(done)));
    if interrupt.is_set() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}
