//! Exports of a table: the list of them, the files of each, and the files themselves.

use std::sync::Arc;

use axum::{
    extract::{FromRequestParts, Path, State},
    http::{HeaderMap, Method, request::Parts},
    response::Response,
};
use serde::{Deserialize, Serialize};

use super::{
    absent::absent,
    api::Api,
    coding::Coding,
    download::negotiate,
    error,
    extract::{NoParameters, QueryOf},
    file::{Contents, FOREVER, File},
    kind::ProblemKind,
    problem::Problem,
};
use crate::service::{ExportedFile, MadeExport};
use ltcforge_files::digest::Digest;
use ltcforge_textures::{Export, RoundingError};

/// Exports change with the version of the service, which the files state.
const ONE_DAY: &str = "public, max-age=86400";

/// A table, and if the path of the request goes so far an export and the path of a file.
pub(super) struct Address {
    table: Digest,
    export: Option<Export>,
    path: String,
}

impl<S: Send + Sync> FromRequestParts<S> for Address {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let Path(parameters) = Path::<Vec<(String, String)>>::from_request_parts(parts, state)
            .await
            .map_err(|rejection| Problem::new(ProblemKind::BadParameter, rejection.body_text()))?;
        let mut texts = parameters.into_iter().map(|(_, text)| text);
        let bad = |error: &dyn std::fmt::Display| Problem::new(ProblemKind::BadParameter, error.to_string());
        let table = texts.next().unwrap_or_default().parse().map_err(|error| bad(&error))?;
        let export = texts.next().map(|name| name.parse()).transpose();
        let export = export.map_err(|error| Problem::new(ProblemKind::UnknownExport, format!("{error}")))?;
        Ok(Self { table, export, path: texts.collect::<Vec<_>>().join("/") })
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileParameters {
    /// The digest that the file has to have.
    digest: Option<Digest>,
}

#[derive(Debug, Serialize)]
struct ExportsView {
    table: Digest,
    items: Vec<ItemView>,
}

/// An export that the table has.
#[derive(Debug, Serialize)]
struct ItemView {
    name: String,
    url: String,
}

/// An export that was made.
#[derive(Debug, Serialize)]
struct ExportView<'a> {
    table: Digest,
    name: String,
    files: Vec<FileView<'a>>,
    steps: &'a [String],
}

#[derive(Debug, Serialize)]
struct FileView<'a> {
    path: &'a str,
    bytes: usize,
    digest: Digest,
    /// An address under which nothing but these bytes is ever served.
    url: String,
    rounding: RoundingError,
}

/// `GET /v1/tables/{digest}/exports`.
pub(super) async fn list(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    Address { table, .. }: Address,
    method: Method,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let Some(exports) = api.read(move |service| service.exports(table)).await? else {
        return Err(absent(&api, table).await);
    };
    let item = |export: Export| ItemView { name: export.to_string(), url: url(table, export) };
    document(&ExportsView { table, items: exports.into_iter().map(item).collect() })?.respond(&method, &headers)
}

/// `GET /v1/tables/{digest}/exports/{export}`.
pub(super) async fn show(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    address: Address,
    method: Method,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let (table, export, made) = made(&api, &address).await?;
    let files = made.files.iter().map(|file| FileView {
        path: &file.path,
        bytes: file.bytes.len(),
        digest: file.digest,
        url: format!("{}/{}?digest={}", url(table, export), file.path, file.digest),
        rounding: file.rounding,
    });
    let view = ExportView { table, name: export.to_string(), files: files.collect(), steps: &made.steps };
    document(&view)?.respond(&method, &headers)
}

/// `GET` and `HEAD` of a file in the folder of an export, or in a folder below it.
pub(super) async fn file(
    State(api): State<Api>,
    QueryOf(FileParameters { digest: wanted }): QueryOf<FileParameters>,
    address: Address,
    method: Method,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let (table, export, made) = made(&api, &address).await?;
    let Some(file) = made.files.iter().find(|file| file.path == address.path) else {
        let paths: Vec<&str> = made.files.iter().map(|file| file.path.as_str()).collect();
        let detail = format!("export {export} of {table} has no file «{}»; it has {}", address.path, paths.join(", "));
        return Err(Problem::new(ProblemKind::UnknownFile, detail));
    };
    let ExportedFile { path, bytes, digest, .. } = file;
    if let Some(wanted) = wanted.filter(|wanted| wanted != digest) {
        let version = env!("CARGO_PKG_VERSION");
        let detail = format!("version {version} makes of the table a file that hashes to {digest}, not to {wanted}");
        return Err(Problem::new(ProblemKind::OtherBytes, detail));
    }
    let file = File {
        digest: *digest,
        contents: Contents::Memory(Arc::clone(bytes)),
        media_type: media_type(path),
        caching: if wanted.is_some() { FOREVER } else { ONE_DAY },
        name: path.rsplit('/').next().map(str::to_owned),
        coding: Coding::Identity,
    };
    negotiate(&api, file, &headers).await?.respond(&method, &headers)
}

async fn made(api: &Api, address: &Address) -> Result<(Digest, Export, Arc<MadeExport>), Problem> {
    let table = address.table;
    let export = address.export.ok_or_else(|| error::internal(&"a route of exports without one"))?;
    match api.call(move |service| service.export(table, export)).await? {
        Some(made) => Ok((table, export, made)),
        None => Err(absent(api, table).await),
    }
}

fn url(table: Digest, export: Export) -> String {
    format!("/v1/tables/{table}/exports/{export}")
}

/// A list as a file: its entity tag is the digest of its bytes.
fn document(view: &impl Serialize) -> Result<File, Problem> {
    let bytes = serde_json::to_vec(view).map_err(|error| error::internal(&error))?;
    let digest = Digest::of(&bytes);
    Ok(File {
        digest,
        contents: Contents::Memory(Arc::new(bytes)),
        media_type: "application/json",
        caching: ONE_DAY,
        name: None,
        coding: Coding::Fixed,
    })
}

/// The media type by the extension of a file's name.
fn media_type(path: &str) -> &'static str {
    match path.rsplit('.').next().unwrap_or_default() {
        "json" => "application/json",
        "js" => "text/javascript",
        "ktx2" => "image/ktx2",
        "dds" => "image/vnd.ms-dds",
        "exr" => "image/x-exr",
        "npz" => "application/zip",
        "h" | "rs" | "cs" | "wgsl" => "text/plain",
        _ => "application/octet-stream",
    }
}
