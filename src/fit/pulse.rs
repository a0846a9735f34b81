//! The callback that shows that a long fit is alive and can stop it.

use std::ops::ControlFlow;

/// A callback that a long fit calls at intervals, so that the caller knows that the fit is alive and can stop it.
pub type Pulse<'a> = dyn FnMut() -> ControlFlow<()> + 'a;
