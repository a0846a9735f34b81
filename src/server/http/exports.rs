//! Exports of a table: their list, the files of each export, and the bytes of a file.

use std::sync::Arc;

use axum::{
    extract::{FromRequestParts, Path, State},
    http::{HeaderMap, Method, request::Parts},
};
use serde::Deserialize;
use serde_json::{Value, json};

use super::{
    api::Api,
    error::{self, bad_parameter},
    extract::{Asked, QueryOf},
    file::{FOREVER, File, ONE_DAY, absent, media_type},
    kind::ProblemKind,
    problem::{Answer, Problem},
};
use crate::service::{ExportedFile, MadeExport};
use ltcforge_files::digest::Digest;
use ltcforge_textures::Export;

/// The parameters of a path: a table, and optionally an export and the path of a file.
pub(super) struct Address {
    table: Digest,
    export: Option<Export>,
    path: String,
}

impl<S: Send + Sync> FromRequestParts<S> for Address {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let path = Path::<Vec<(String, String)>>::from_request_parts(parts, state).await;
        let Path(parameters) = path.map_err(|rejection| bad_parameter(&rejection.body_text()))?;
        let mut texts = parameters.into_iter().map(|(_, text)| text);
        let table = texts.next().unwrap_or_default().parse().map_err(|error| bad_parameter(&error))?;
        let export = texts.next().map(|name| name.parse()).transpose();
        let export = export.map_err(|error| Problem::new(ProblemKind::UnknownExport, format!("{error}")))?;
        Ok(Self { table, export, path: texts.collect::<Vec<_>>().join("/") })
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileParameters {
    /// The digest that the client expects the file to have.
    digest: Option<Digest>,
}

/// `GET /v1/tables/{digest}/exports`.
pub(super) async fn list(State(api): State<Api>, asked: Asked, Address { table, .. }: Address) -> Answer {
    let Some(exports) = api.read(move |service| service.exports(table)).await? else {
        return Err(absent(&api, table).await);
    };
    let item = |export: Export| json!({ "name": export.to_string(), "url": url(table, export) });
    let items: Vec<Value> = exports.into_iter().map(item).collect();
    File::json(&json!({ "table": table, "items": items }))?.respond(&asked.method, &asked.headers)
}

/// `GET /v1/tables/{digest}/exports/{export}`.
pub(super) async fn show(State(api): State<Api>, asked: Asked, address: Address) -> Answer {
    let (table, export, made) = made(&api, &address).await?;
    let file = |file: &ExportedFile| {
        // This URL never serves other bytes.
        let url = format!("{}/{}?digest={}", url(table, export), file.path, file.digest);
        let ExportedFile { path, bytes, digest, rounding } = file;
        json!({ "path": path, "bytes": bytes.len(), "digest": digest, "url": url, "rounding": rounding })
    };
    let files: Vec<Value> = made.files.iter().map(file).collect();
    let view = json!({ "table": table, "name": export.to_string(), "files": files, "steps": made.steps });
    File::json(&view)?.respond(&asked.method, &asked.headers)
}

/// `GET` and `HEAD` of a file of an export, or of a file in one of its folders.
pub(super) async fn file(
    State(api): State<Api>,
    QueryOf(FileParameters { digest: wanted }): QueryOf<FileParameters>,
    address: Address,
    method: Method,
    headers: HeaderMap,
) -> Answer {
    let (table, export, made) = made(&api, &address).await?;
    let Some(file) = made.files.iter().find(|file| file.path == address.path) else {
        let paths: Vec<&str> = made.files.iter().map(|file| file.path.as_str()).collect();
        let detail = format!("export {export} of {table} has no file «{}»; it has {}", address.path, paths.join(", "));
        return Err(Problem::new(ProblemKind::UnknownFile, detail));
    };
    let ExportedFile { path, bytes, digest, .. } = file;
    if let Some(wanted) = wanted.filter(|wanted| wanted != digest) {
        let version = env!("CARGO_PKG_VERSION");
        let detail = format!("the file that ltcforge {version} exports has the digest {digest}, not {wanted}");
        return Err(Problem::new(ProblemKind::OtherBytes, detail));
    }
    let caching = if wanted.is_some() { FOREVER } else { ONE_DAY };
    let name = path.rsplit('/').next().map(str::to_owned);
    File { digest: *digest, bytes: bytes.clone(), media_type: media_type(path), caching, name }
        .respond(&method, &headers)
}

async fn made(api: &Api, address: &Address) -> Result<(Digest, Export, Arc<MadeExport>), Problem> {
    let table = address.table;
    let export = address.export.ok_or_else(|| error::internal(&"the path of an export route has no export"))?;
    match api.call(move |service| service.export(table, export)).await? {
        Some(made) => Ok((table, export, made)),
        None => Err(absent(api, table).await),
    }
}

fn url(table: Digest, export: Export) -> String {
    format!("/v1/tables/{table}/exports/{export}")
}
