//! Stored files for download, each in the coding that the client prefers.

use std::sync::Arc;

use axum::{
    http::{HeaderMap, Method, StatusCode, header},
    response::Response,
};

use super::{
    absent::absent,
    api::Api,
    coding::{Coding, wants_zstd},
    file::{Contents, FOREVER, File},
    kind::ProblemKind,
    problem::Problem,
};
use crate::service::{Checked, FileKind, SHORT_BYTES, Service, ServiceError, Zstd};
use ltcforge_files::{digest::Digest, tabulated::kept_name};

/// A stored file, all of it or less. It is checked against its digest before any of it is sent, unless that was done since
/// it last changed; only in a store elsewhere it is not read whole for less than all of it.
pub(super) async fn stored_file(
    api: Api,
    kind: FileKind,
    digest: Digest,
    method: &Method,
    headers: &HeaderMap,
) -> Result<Response, Problem> {
    let hex = digest.hex();
    let octets = "application/octet-stream";
    let (problem, noun, name, media_type) = match kind {
        FileKind::Table => (ProblemKind::UnknownTable, "table", format!("{hex}.safetensors"), octets),
        FileKind::Brdf => (ProblemKind::UnknownBrdf, "BRDF", kept_name(digest.as_bytes()), octets),
        FileKind::LightTexture => {
            (ProblemKind::UnknownLightTexture, "light texture", format!("{hex}.ktx2"), "image/ktx2")
        }
    };
    let is_plain = [header::IF_NONE_MATCH, header::IF_MATCH, header::RANGE].iter().all(|f| !headers.contains_key(f));
    let asks_for_all = method == Method::GET && is_plain;
    let read = async |all: bool| {
        let read =
            move |service: &Service| if all { service.checked(kind, digest) } else { service.glance(kind, digest) };
        match api.read(read).await? {
            Some(read) => Ok(read),
            None if kind == FileKind::Table => Err(absent(&api, digest).await),
            None => Err(Problem::new(problem, format!("no {noun} with the digest {digest} is stored"))),
        }
    };
    // Most requests are for a file that was checked before, and need no other thread.
    let checked = match api.service.known(kind, digest) {
        Some(known) => known,
        None => read(asks_for_all).await?,
    };
    let is_negotiable = kind == FileKind::Table;
    // Of a store elsewhere only the length is known, and the entity tag follows from the compressed bytes.
    let lacks_bytes = matches!(checked, Checked::Long(length) if length <= SHORT_BYTES);
    let reads_for_coding = is_negotiable && lacks_bytes && wants_zstd(digest, headers);
    let checked = if reads_for_coding { read(true).await? } else { checked };
    let contents = match checked {
        Checked::Bytes(bytes) => Contents::Memory(bytes),
        Checked::Long(length) => Contents::Stored { api: api.clone(), length },
    };
    let file = File { digest, contents, media_type, caching: FOREVER, name: Some(name), coding: Coding::Fixed };
    let file = if is_negotiable { negotiate(&api, file, headers).await? } else { file };
    let response = file.respond(method, headers)?;
    if !(asks_for_all || reads_for_coding)
        && method == Method::GET
        && response.status() == StatusCode::OK
        && api.service.known(kind, digest).is_none()
    {
        read(true).await?;
    }
    Ok(response)
}

/// A file in the coding that the request prefers: another representation, with its own entity tag and digests. Long
/// files and those that hardly get shorter are sent as they are.
pub(super) async fn negotiate(api: &Api, file: File, headers: &HeaderMap) -> Result<File, Problem> {
    let file = File { coding: Coding::Identity, ..file };
    let Contents::Memory(bytes) = &file.contents else { return Ok(file) };
    if bytes.len() as u64 > SHORT_BYTES || !wants_zstd(file.digest, headers) {
        return Ok(file);
    }
    let compressed = if let Some(known) = api.service.known_compressed(file.digest) {
        known
    } else {
        let (digest, bytes) = (file.digest, Arc::clone(bytes));
        api.read(move |service| Ok::<_, ServiceError>(service.compressed(digest, &bytes))).await?
    };
    Ok(match compressed {
        Zstd::Shorter(bytes, digest) => {
            File { digest, contents: Contents::Memory(bytes), coding: Coding::Zstd, ..file }
        }
        Zstd::NotWorthwhile => file,
    })
}
