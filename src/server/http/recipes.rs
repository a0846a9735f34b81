//! Recipes: the forecast for a document, known recipes and their tables, and the fields of a recipe.

use axum::{Json, extract::State};

use super::{
    api::Api,
    etag::check_untagged,
    extract::{Asked, NoQuery, PathOf, RecipeBody},
    file::{File, REVALIDATE},
    kind::ProblemKind,
    problem::{Answer, Problem},
    views::{ForeseenView, RecipeView},
};
use crate::service::{Service, SubmitError};
use ltcforge_files::{
    digest::Digest,
    recipe_document::{RecipeError, schema},
};

/// `POST /v1/recipes`. A recipe with faults gets 200 with the list of faults.
pub(super) async fn foresee(
    State(api): State<Api>,
    asked: Asked,
    RecipeBody(document): RecipeBody,
) -> Result<Json<ForeseenView>, Problem> {
    check_untagged(&asked.headers)?;
    let foresee = move |service: &Service| match service.foresee(&document) {
        Err(SubmitError::Recipe(error @ RecipeError::Faults(_))) => Ok(Err(error)),
        foreseen => foreseen.map(Ok),
    };
    let foreseen: Result<_, RecipeError> = api.call::<_, SubmitError>(foresee).await?;
    Ok(Json(match foreseen {
        Ok(foreseen) => ForeseenView::new(foreseen)?,
        Err(faults) => ForeseenView::refused(faults.into()),
    }))
}

/// `GET /v1/recipes/{digest}`.
pub(super) async fn show(
    State(api): State<Api>,
    _: NoQuery,
    PathOf(digest): PathOf<Digest>,
) -> Result<Json<RecipeView>, Problem> {
    let known = api.call(move |service| service.recipe(digest)).await?;
    let (recipe, table) = known.ok_or_else(|| {
        Problem::new(ProblemKind::UnknownRecipe, format!("no recipe with the digest {digest} is known"))
    })?;
    Ok(Json(RecipeView::new(digest, &recipe, table)?))
}

/// `GET /v1/recipes/schema`: the fields of a recipe in JSON Schema.
pub(super) async fn describe(asked: Asked) -> Answer {
    File { caching: REVALIDATE, ..File::json(&schema())? }.respond(&asked.method, &asked.headers)
}
