//! A progress bar on standard error, if that is a terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar for this many entries, or a bar that draws nothing.
pub(super) fn bar(draws: bool, entries: u64) -> ProgressBar {
    let target = if draws { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let style = ProgressStyle::with_template("{wide_bar} {pos}/{len} entries  {elapsed} (left {eta})");
    ProgressBar::with_draw_target(Some(entries), target)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
