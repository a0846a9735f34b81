//! The `ltcforge` command.

fn main() {}
