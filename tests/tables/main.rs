//! Tables as such: how near they are to the best fit, at the extremes, and those of the example recipes.

mod accuracy;
mod examples;
mod extremes;
