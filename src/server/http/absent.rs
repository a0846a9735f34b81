//! The problem of a table that is not there.

use super::{api::Api, kind::ProblemKind, problem::Problem};
use crate::service::RemovedTable;
use ltcforge_files::digest::Digest;

/// The problem of a table that never was there, as far as is known, or that was removed: then with the recipe that fits it again.
pub(super) async fn absent(api: &Api, digest: Digest) -> Problem {
    match api.call(move |service| service.removed_table(digest)).await {
        Err(problem) => problem,
        Ok(None) => Problem::new(ProblemKind::UnknownTable, format!("no table with the digest {digest} is stored")),
        Ok(Some(RemovedTable { at, why, recipe, .. })) => {
            let detail =
                format!("the table {digest} was removed at {at}: {why}; submit its recipe, and it is fitted again");
            let problem = Problem::new(ProblemKind::RemovedTable, detail);
            match serde_json::from_str(&recipe) {
                Ok(recipe) => problem.with_recipe(recipe),
                Err(_) => problem,
            }
        }
    }
}
