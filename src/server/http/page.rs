//! The web page at `/`. It serves the files of `src/server/page`, which are embedded in the binary, the shaders of the
//! viewer, and the textures of a published table.
//!
//! Invariant: the page calls only routes of this service, by relative addresses, so it works behind a path prefix. It
//! loads no script, style or font from other sites, and contains no inline scripts or styles.

use std::sync::LazyLock;

use axum::{
    body::Bytes,
    extract::{Path, State},
    http::{HeaderName, HeaderValue, header},
};

use super::{
    api::Api,
    error,
    extract::Asked,
    file::{File, REVALIDATE, media_type},
    kind::ProblemKind,
    problem::{Answer, Problem},
};
use crate::service::published_table;
use ltcforge_files::digest::Digest;
use ltcforge_fit::Layout;
use ltcforge_light::{LightModel, normals::NormalsRule, textured::Readings};
use ltcforge_shaders::{Additions, Language, Lights, LitBy, Namespace, Reading};
use ltcforge_translate::{include, include_prefilter, include_samplers};

/// The page may run its own modules and call this service. Pictures and videos have `blob:` URLs.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; media-src blob:; \
                      connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; require-trusted-types-for 'script'";

/// The name of a file, its bytes and their digest.
type PageFile = (&'static str, Bytes, Digest);

macro_rules! page_files {
    ($($name:literal),* $(,)?) => {
        static FILES: LazyLock<Vec<PageFile>> =
            LazyLock::new(|| vec![$(page_file($name, include_bytes!(concat!("../page/", $name)))),*]);
    };
}

page_files![
    "elements/dom.js",
    "elements/format.js",
    "elements/recipe.js",
    "form/document.js",
    "form/fields.js",
    "form/inputs.js",
    "form/plan.js",
    "glsl/blended_lobes.glsl",
    "glsl/covered.glsl",
    "glsl/diffuse.glsl",
    "glsl/display.glsl",
    "glsl/edge.glsl",
    "glsl/engines.glsl",
    "glsl/errors.glsl",
    "glsl/estevez.glsl",
    "glsl/formula.glsl",
    "glsl/ggx.glsl",
    "glsl/glow.glsl",
    "glsl/lights.glsl",
    "glsl/mesh.glsl",
    "glsl/mesh_vertex.glsl",
    "glsl/neubelt.glsl",
    "glsl/normals.glsl",
    "glsl/one.glsl",
    "glsl/outlines.glsl",
    "glsl/reflected.glsl",
    "glsl/sampled_lights.glsl",
    "glsl/sampling.glsl",
    "glsl/sheen.glsl",
    "glsl/sides.glsl",
    "glsl/sum.glsl",
    "glsl/surface.glsl",
    "glsl/surface_point.glsl",
    "glsl/targets.glsl",
    "glsl/truth.glsl",
    "glsl/two_lobes.glsl",
    "glsl/visible.glsl",
    "gltf/read.js",
    "gltf/textures.js",
    "icon.svg",
    "index.html",
    "main.js",
    "pages/compare.js",
    "pages/job.js",
    "pages/jobs.js",
    "pages/new.js",
    "pages/table.js",
    "pages/tables.js",
    "pages/viewer.js",
    "published/kt2022.npy",
    "published/kt2022_LICENSE.txt",
    "published/ltc2017_1.dds",
    "published/ltc2017_2.dds",
    "published/ltc2017_LICENSE.txt",
    "report/downloads.js",
    "report/errors.js",
    "report/first.js",
    "report/quality.js",
    "service/api.js",
    "service/jobs.js",
    "service/kept.js",
    "service/pictures.js",
    "service/token.js",
    "service/zip.js",
    "style.css",
    "viewer/controls.js",
    "viewer/errors.js",
    "viewer/lights.js",
    "viewer/models.js",
    "viewer/own_lights.js",
    "viewer/picture.js",
    "viewer/planned.js",
    "viewer/scene.js",
    "viewer/screens.js",
    "viewer/shader_ball.js",
    "viewer/stage.js",
    "webgl/context.js",
    "webgl/device.js",
    "webgl/pictures.js",
    "webgl/shaders.js",
];

/// The shader for a file name without extension: `normals`, `normals-RULE`, `ltc-formula` or `ltc-LAYOUT`, with
/// `-two-lobes` for tables with two lobes. All names can end in `-textured` for lights that show pictures.
fn lit_by(name: &str) -> Option<(LitBy, Reading)> {
    let (name, is_textured) = without(name, "-textured");
    let additions = Additions { textured: is_textured.then(|| Readings::ALL[0]), ..Additions::default() };
    if let Some(model) = [LightModel::Normals, LightModel::LtcFormula].iter().find(|model| model.name() == name) {
        return Some((LitBy::new(*model, None).ok()?.with(additions).ok()?, Reading::default()));
    }
    if let Some(rule) = name.strip_prefix("normals-") {
        let rule = NormalsRule::SHADED.iter().copied().find(|known| known.name() == rule)?;
        let by_rule = LitBy::new(LightModel::Normals, None).ok()?.by_rule(Some(rule)).ok()?;
        return Some((by_rule.with(additions).ok()?, Reading::default()));
    }
    let (layout, two_lobes) = without(name.strip_prefix("ltc-")?, "-two-lobes");
    let layout = Layout::ALL.iter().find(|known| known.name() == layout)?;
    Some((LitBy::from(*layout).with(additions).ok()?, Reading { two_lobes, ..Reading::default() }))
}

/// Removes the suffix `end` from a name. Returns the rest, and whether the name had the suffix.
fn without<'name>(name: &'name str, end: &str) -> (&'name str, bool) {
    name.strip_suffix(end).map_or((name, false), |name| (name, true))
}

fn page_file(name: &'static str, bytes: &'static [u8]) -> PageFile {
    (name, Bytes::from_static(bytes), Digest::of(bytes))
}

/// The languages of shaders by the extension of their files.
const LANGUAGES: [(&str, Language); 3] =
    [("glsl", Language::GlslEs), ("wgsl", Language::Wgsl), ("hlsl", Language::Hlsl)];

/// The shader that `ltcforge shader` prints, the samplers, or the prefilter for pictures on lights.
fn shader_text(file: &str) -> Result<String, Problem> {
    let (name, extension) = file.rsplit_once('.').ok_or_else(|| no_file(file))?;
    let (_, language) = LANGUAGES.into_iter().find(|(known, _)| *known == extension).ok_or_else(|| no_file(file))?;
    let text = match name {
        "prefilter" => include_prefilter(language),
        "samplers" => include_samplers(language),
        _ => {
            let (lit_by, reading) = lit_by(name).ok_or_else(|| no_file(file))?;
            include(language, lit_by, reading, Lights::All, &Namespace::default())
        }
    };
    text.map_err(|error| error::internal(&error))
}

/// `GET /`.
pub(super) async fn index(asked: Asked) -> Answer {
    respond("index.html", &asked)
}

/// `GET /page/{file}`.
pub(super) async fn file(asked: Asked, Path(name): Path<String>, State(api): State<Api>) -> Answer {
    let Some(path) = name.strip_prefix("kt2022-") else { return respond(&name, &asked) };
    // The first request computes the table, which takes a moment.
    let made = api.call(|_| published_table().map_err(|error| error::internal(&error))).await?;
    let found = made.files.iter().find(|file| file.path == path).ok_or_else(|| no_file(&name))?;
    send(path, found.digest, found.bytes.clone(), &asked)
}

/// `GET /page/{folder}/{file}`.
pub(super) async fn file_of_folder(asked: Asked, Path((folder, name)): Path<(String, String)>) -> Answer {
    respond(&format!("{folder}/{name}"), &asked)
}

fn respond(name: &str, asked: &Asked) -> Answer {
    if let Some((name, bytes, digest)) = FILES.iter().find(|(known, ..)| *known == name) {
        return send(name, *digest, bytes.clone(), asked);
    }
    let text = Bytes::from(shader_text(name)?);
    send("shader.txt", Digest::of(&text), text, asked)
}

fn send(name: &str, digest: Digest, bytes: Bytes, asked: &Asked) -> Answer {
    let file = File { digest, bytes, media_type: media_type(name), caching: REVALIDATE, name: None };
    let mut response = file.respond(&asked.method, &asked.headers)?;
    let fields = [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "same-origin"),
        (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    ];
    response.headers_mut().extend(fields.map(|(name, value)| (name, HeaderValue::from_static(value))));
    Ok(response)
}

fn no_file(name: &str) -> Problem {
    Problem::new(ProblemKind::NoSuchPath, format!("the page has no file «{name}»; /openapi.yaml lists all paths"))
}

#[cfg(test)]
mod tests {
    use std::{collections::BTreeSet, fs};

    use super::*;

    #[test]
    fn every_file_of_the_folder_is_served() {
        let root = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/page"));
        let mut in_folder = BTreeSet::new();
        let mut folders = vec![root.to_path_buf()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).expect("a folder") {
                let path = entry.expect("a file").path();
                if path.is_dir() {
                    folders.push(path);
                } else {
                    in_folder.insert(path.strip_prefix(root).expect("below it").to_str().expect("UTF-8").to_owned());
                }
            }
        }
        let served: BTreeSet<String> = FILES.iter().map(|(name, ..)| (*name).to_owned()).collect();
        assert_eq!(served, in_folder);
    }

    /// Folders of modules. Each may import only from folders further right; see `docs/architecture.md`.
    const FOLDERS: [&str; 8] = ["pages", "form", "report", "viewer", "webgl", "gltf", "service", "elements"];

    #[test]
    fn modules_import_from_folders_below_their_own() {
        let place = |folder: &str| FOLDERS.iter().position(|known| *known == folder).expect(folder);
        let mut imports = 0;
        for (name, bytes, _) in FILES.iter() {
            let Some((folder, _)) = name.split_once('/').filter(|(_, file)| file.rsplit('.').next() == Some("js"))
            else {
                continue;
            };
            let text = std::str::from_utf8(bytes).expect("UTF-8");
            for (used, _) in text.split("'../").skip(1).filter_map(|rest| rest.split_once('/')) {
                assert!(place(folder) < place(used), "{name}: {used}");
                imports += 1;
            }
        }
        assert!(imports > 50, "{imports}");
    }

    /// Largest number of lines of JavaScript.
    const MOST_LINES: usize = 4500;

    #[test]
    fn the_page_stays_small() {
        let scripts = FILES.iter().filter(|(name, ..)| name.rsplit('.').next() == Some("js"));
        let lines: usize = scripts.map(|(_, bytes, _)| String::from_utf8_lossy(bytes).lines().count()).sum();
        assert!(lines > 1000 && lines <= MOST_LINES, "{lines} lines");
    }

    #[test]
    fn there_is_a_shader_for_every_layout_and_for_none() {
        let layouts = Layout::ALL.iter().flat_map(|layout| ["", "-two-lobes"].map(|of| format!("ltc-{layout}{of}")));
        let models =
            layouts.chain(["normals".to_owned()]).flat_map(|of| ["", "-textured"].map(|end| format!("{of}{end}")));
        let others = ["prefilter", "samplers", "normals-fast"].map(str::to_owned);
        for name in models.chain(others) {
            let answer = respond(&format!("{name}.glsl"), &Asked::default()).expect(&name);
            assert_eq!(answer.headers()[header::CONTENT_TYPE], "text/plain; charset=utf-8", "{name}");
        }
        for name in ["normals-fast.wgsl", "ltc-ltc2017.hlsl"] {
            assert!(respond(name, &Asked::default()).is_ok(), "{name}");
        }
        for name in ["ltc-none.glsl", "normals", "normals.msl", "normals-exact.glsl", "-textured.glsl"] {
            assert_eq!(respond(name, &Asked::default()).expect_err(name).status(), 404);
        }
    }

    #[test]
    fn a_client_that_has_a_file_gets_304() {
        let first = respond("index.html", &Asked::default()).expect("a page");
        assert_eq!(first.headers()[header::CONTENT_TYPE], "text/html; charset=utf-8");
        assert!(
            first.headers()[header::CONTENT_SECURITY_POLICY].to_str().is_ok_and(|it| it.contains("script-src 'self'"))
        );
        let headers = [(header::IF_NONE_MATCH, first.headers()[header::ETAG].clone())].into_iter().collect();
        let repeated = Asked { headers, ..Asked::default() };
        assert_eq!(respond("index.html", &repeated).expect("an answer").status(), 304);
        assert_eq!(respond("none.js", &repeated).expect_err("no file").status(), 404);
    }
}
