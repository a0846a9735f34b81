//! The layers, and what each may use.

/// Each layer, a folder or file of `src`, and those that it may use, upper layers last.
pub(crate) const ALLOWED: &[(&str, &[&str])] = &[
    ("fit::named_list", &[]),
    ("fit::pulse", &[]),
    ("fit::math", &[]),
    ("fit::axes", &["fit::math"]),
    ("fit::brdf", &["fit::named_list", "fit::axes", "fit::math"]),
    ("fit::lobe", &["fit::named_list", "fit::brdf", "fit::math"]),
    ("fit::layout", &["fit::named_list", "fit::lobe", "fit::brdf", "fit::axes", "fit::math"]),
    ("fit::table", &["fit::layout", "fit::lobe", "fit::brdf", "fit::axes", "fit::math"]),
    ("fit::metric", &["fit::named_list", "fit::pulse", "fit::lobe", "fit::brdf", "fit::math"]),
    ("fit::solver", &["fit::named_list", "fit::pulse", "fit::metric", "fit::lobe", "fit::brdf", "fit::math"]),
    (
        "fit",
        &[
            "fit::table",
            "fit::solver",
            "fit::metric",
            "fit::layout",
            "fit::lobe",
            "fit::brdf",
            "fit::axes",
            "fit::math",
            "fit::named_list",
            "fit::pulse",
        ],
    ),
    // The judge: it knows what a table and a recipe are, and nothing of what the fit minimised.
    ("fit::measure", &["fit", "fit::table", "fit::layout", "fit::lobe", "fit::brdf", "fit::axes", "fit::math"]),
    ("light::normals", &["fit", "fit::named_list", "fit::math"]),
    ("light::transmission", &["light::normals", "fit", "fit::brdf", "fit::math"]),
    (
        "light",
        &["light::transmission", "light::normals", "fit", "fit::named_list", "fit::brdf", "fit::lobe", "fit::math"],
    ),
    ("files", &["fit", "fit::measure", "fit::math"]),
    ("files::textures", &["files", "fit", "fit::named_list", "fit::math", "fit::lobe"]),
    ("view::shaders", &["light", "light::normals", "fit", "fit::math"]),
    ("library", &["view::shaders", "files", "light", "light::normals", "fit", "fit::brdf"]),
    ("view::parameters", &[]),
    ("view::picture", &[]),
    ("view::plots", &["view::parameters", "view::picture", "light", "light::normals", "light::transmission", "fit"]),
    (
        "view::preview",
        &[
            "view::shaders",
            "view::parameters",
            "view::picture",
            "light",
            "light::normals",
            "fit",
            "fit::brdf",
            "fit::lobe",
            "fit::math",
        ],
    ),
    ("view::tradeoff", &["files", "light", "light::normals", "fit"]),
    ("server::store", &["files"]),
    ("server::queue", &["server::store", "files"]),
    (
        "server::service",
        &[
            "server::queue",
            "server::store",
            "view::parameters",
            "view::picture",
            "view::plots",
            "view::preview",
            "files::textures",
            "files",
            "fit",
        ],
    ),
    (
        "server::http",
        &[
            "server::service",
            "server::queue",
            "view::parameters",
            "view::plots",
            "view::preview",
            "files::textures",
            "files",
            "fit",
        ],
    ),
    ("client", &["files"]),
    (
        "cli",
        &[
            "server::http",
            "server::service",
            "client",
            "view::picture",
            "view::plots",
            "view::preview",
            "view::shaders",
            "view::tradeoff",
            "files::textures",
            "files",
            "light",
            "light::normals",
            "fit",
            "fit::brdf",
            "fit::math",
        ],
    ),
];

/// What a layer must not name, beyond other layers: a path and what lies below it, or a word.
pub(crate) const ABSENT: &[(&[&str], &[&str])] = &[
    (
        &[
            "fit",
            "fit::named_list",
            "fit::pulse",
            "fit::math",
            "fit::axes",
            "fit::brdf",
            "fit::lobe",
            "fit::layout",
            "fit::table",
            "fit::metric",
            "fit::solver",
            "fit::measure",
        ],
        &[
            "serde_json",
            "tokio",
            "std::fs",
            "std::env",
            "std::time",
            "std::thread",
            "std::net",
            "num_threads",
            "current_num_threads",
        ],
    ),
    (&["view::tradeoff"], &["std::fs", "std::env", "std::time", "std::thread", "rustix"]),
    (&["server::queue", "server::store"], &["axum", "tower_http", "ureq"]),
    (&["view::picture", "view::plots", "view::preview"], &["axum", "tokio", "sled", "serde_json"]),
    (&["client"], &["axum", "tokio", "sled"]),
    (&["server::http", "cli"], &["sled"]),
];

/// The layer that a path of names below the crate belongs to: the longest that it begins with.
pub(crate) fn layer_of(names: &[String]) -> Option<&'static str> {
    let layers = ALLOWED.iter().map(|(layer, _)| *layer);
    let begins = |layer: &&str| layer.split("::").eq(names.iter().map(String::as_str).take(layer.split("::").count()));
    layers.filter(begins).max_by_key(|layer| layer.len())
}
