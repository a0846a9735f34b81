//! Tables as such: how near they are to the best fit, at the extremes, those of the example recipes, and the README's.

mod accuracy;
mod examples;
mod extremes;
mod plans;
mod readme;
