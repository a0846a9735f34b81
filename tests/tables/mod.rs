//! Tests of tables: errors against the best fits, extremes, example recipes, and figures of the README.

mod accuracy;
mod examples;
mod extremes;
mod plans;
mod readme;
