//! How a long fit tells that it is alive, and is stopped.

use std::ops::ControlFlow;

/// Called now and then in a long fit, so that its caller knows that it is alive, and can stop it.
pub type Pulse<'a> = dyn FnMut() -> ControlFlow<()> + 'a;
