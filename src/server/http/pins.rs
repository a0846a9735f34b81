//! Pins of tables, one by one and by the lock file of a project.

use axum::{
    Extension, Json,
    body::Bytes,
    extract::{FromRequest, FromRequestParts, Path, Request, State},
    http::{HeaderMap, StatusCode, request::Parts},
    response::{IntoResponse, Response},
};
use serde::Serialize;

use super::{
    absent::absent,
    access::Caller,
    api::Api,
    conditional::check_untagged,
    extract::{NoParameters, PathOf, QueryOf, read_body},
    kind::ProblemKind,
    problem::Problem,
};
use crate::service::{PinError, PinName, PinnedLock, TablePin};
use ltcforge_files::digest::Digest;

/// Longest lock file that is taken, as commands take it. It holds some thousand tables.
pub(super) const LOCK_LIMIT_BYTES: u64 = 4 << 20;

/// A table and the name of a pin.
pub(super) struct PinAddress {
    table: Digest,
    name: PinName,
}

impl<S: Send + Sync> FromRequestParts<S> for PinAddress {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let bad = |error: &dyn std::fmt::Display| Problem::new(ProblemKind::BadParameter, error.to_string());
        let Path((table, name)) = Path::<(String, String)>::from_request_parts(parts, state)
            .await
            .map_err(|rejection| bad(&rejection.body_text()))?;
        Ok(Self {
            table: table.parse().map_err(|error| bad(&error))?,
            name: name.parse().map_err(|error| bad(&error))?,
        })
    }
}

/// The bytes of a lock file. `PUT` is never sent by a page of another site without a question, so any content type will do.
pub(super) struct LockBody(Bytes);

impl FromRequest<Api> for LockBody {
    type Rejection = Problem;

    async fn from_request(request: Request, api: &Api) -> Result<Self, Problem> {
        read_body(request, api, "a lock file", LOCK_LIMIT_BYTES).await.map(Self)
    }
}

/// A pin as it is answered.
#[derive(Debug, Serialize)]
struct PinView {
    table: Digest,
    #[serde(flatten)]
    pin: TablePin,
}

/// The pins of a table.
#[derive(Debug, Serialize)]
pub(super) struct PinsView {
    table: Digest,
    items: Vec<TablePin>,
}

/// What became of a lock file.
#[derive(Debug, Serialize)]
pub(super) struct LockView {
    name: PinName,
    #[serde(flatten)]
    tables: PinnedLock,
}

fn name(caller: Option<&Extension<Caller>>) -> Option<&str> {
    caller.map(|Extension(Caller(by))| by.name.as_str())
}

/// `GET /v1/tables/{digest}/pins`.
pub(super) async fn list(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    PathOf(table): PathOf<Digest>,
) -> Result<Json<PinsView>, Problem> {
    match api.call(move |service| service.pins(table)).await? {
        Some(items) => Ok(Json(PinsView { table, items })),
        None => Err(absent(&api, table).await),
    }
}

/// `PUT /v1/tables/{digest}/pins/{name}`.
pub(super) async fn put(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    PinAddress { table, name: pin }: PinAddress,
    caller: Option<Extension<Caller>>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    check_untagged(&headers)?;
    let put = api.call(move |service| match service.pin(table, &pin, name(caller.as_ref())) {
        Err(PinError::Unknown(_)) => Ok(None),
        put => put.map(Some),
    });
    let Some((pin, was_there)) = put.await? else { return Err(absent(&api, table).await) };
    let status = if was_there { StatusCode::OK } else { StatusCode::CREATED };
    Ok((status, Json(PinView { table, pin })).into_response())
}

/// `DELETE /v1/tables/{digest}/pins/{name}`.
pub(super) async fn delete(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    PinAddress { table, name }: PinAddress,
    headers: HeaderMap,
) -> Result<StatusCode, Problem> {
    check_untagged(&headers)?;
    let pin = name.clone();
    if api.call(move |service| service.unpin(table, &pin)).await? {
        return Ok(StatusCode::NO_CONTENT);
    }
    Err(Problem::new(ProblemKind::UnknownPin, format!("the table {table} has no pin «{name}»")))
}

/// `PUT /v1/pins/{name}`.
pub(super) async fn put_lock(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    PathOf(pin): PathOf<PinName>,
    caller: Option<Extension<Caller>>,
    headers: HeaderMap,
    LockBody(lock): LockBody,
) -> Result<Json<LockView>, Problem> {
    check_untagged(&headers)?;
    let put = move |service: &crate::service::Service| {
        let tables = service.pin_lock(&pin, &lock, name(caller.as_ref()))?;
        Ok::<_, PinError>(LockView { name: pin, tables })
    };
    Ok(Json(api.call(put).await?))
}
