//! The table of all routes. The router is built from it. A test compares it with `openapi.yaml`.

use axum::{
    Router,
    http::{Method, Uri, header},
    response::{IntoResponse, Response},
    routing::MethodRouter,
};

use super::{
    api::Api, brdfs, events, exports, jobs, kind::ProblemKind, operations, page, pictures, plans, problem::Problem,
    recipes, tables,
};

/// One call of the interface. A `GET` route also answers `HEAD`, which is listed only if clients depend on it.
#[derive(Debug)]
pub struct Route {
    /// Request method.
    pub method: Method,
    /// Path with `{parameters}`, as in `openapi.yaml`.
    pub path: &'static str,
    add: fn(MethodRouter<Api>) -> MethodRouter<Api>,
}

const fn route(method: Method, path: &'static str, add: fn(MethodRouter<Api>) -> MethodRouter<Api>) -> Route {
    Route { method, path, add }
}

/// All calls. Routes of the same path are adjacent.
pub static ROUTES: &[Route] = &[
    route(Method::POST, "/v1/jobs", |on| on.post(jobs::submit)),
    route(Method::GET, "/v1/jobs", |on| on.get(jobs::list)),
    route(Method::GET, "/v1/jobs/{id}", |on| on.get(jobs::show)),
    route(Method::DELETE, "/v1/jobs/{id}", |on| on.delete(jobs::cancel)),
    route(Method::GET, "/v1/jobs/{id}/events", |on| on.get(events::follow)),
    route(Method::GET, "/v1/tables", |on| on.get(tables::list)),
    route(Method::GET, "/v1/tables/{digest}", |on| on.get(tables::download)),
    route(Method::HEAD, "/v1/tables/{digest}", |on| on.head(tables::download)),
    route(Method::DELETE, "/v1/tables/{digest}", |on| on.delete(tables::delete)),
    route(Method::GET, "/v1/tables/{digest}/manifest", |on| on.get(tables::manifest)),
    route(Method::GET, "/v1/tables/{digest}/exports", |on| on.get(exports::list)),
    route(Method::GET, "/v1/tables/{digest}/exports/{export}", |on| on.get(exports::show)),
    route(Method::GET, "/v1/tables/{digest}/exports/{export}/{file}", |on| on.get(exports::file)),
    route(Method::GET, "/v1/tables/{digest}/exports/{export}/{folder}/{file}", |on| on.get(exports::file)),
    route(Method::GET, "/v1/tables/{digest}/plots/error.json", |on| on.get(pictures::error_numbers)),
    route(Method::GET, "/v1/tables/{digest}/plots/error.png", |on| on.get(pictures::error_plot)),
    route(Method::GET, "/v1/tables/{digest}/plots/matrix.png", |on| on.get(pictures::matrix_plot)),
    route(Method::GET, "/v1/preview", |on| on.get(pictures::preview)),
    route(Method::POST, "/v1/brdfs", |on| on.post(brdfs::store)),
    route(Method::GET, "/v1/brdfs", |on| on.get(brdfs::list)),
    route(Method::GET, "/v1/brdfs/{digest}", |on| on.get(brdfs::download)),
    route(Method::HEAD, "/v1/brdfs/{digest}", |on| on.head(brdfs::download)),
    route(Method::DELETE, "/v1/brdfs/{digest}", |on| on.delete(brdfs::delete)),
    route(Method::POST, "/v1/plans", |on| on.post(plans::plan)),
    route(Method::POST, "/v1/recipes", |on| on.post(recipes::foresee)),
    route(Method::GET, "/v1/recipes/schema", |on| on.get(recipes::describe)),
    route(Method::GET, "/v1/recipes/{digest}", |on| on.get(recipes::show)),
    route(Method::GET, "/healthz", |on| on.get(operations::healthz)),
    route(Method::GET, "/readyz", |on| on.get(operations::readyz)),
    route(Method::GET, "/metrics", |on| on.get(operations::metrics)),
    route(Method::GET, "/version", |on| on.get(operations::version)),
    route(Method::GET, "/openapi.yaml", |on| on.get(operations::openapi)),
    route(Method::GET, "/", |on| on.get(page::index)),
    route(Method::GET, "/page/{file}", |on| on.get(page::file)),
    route(Method::GET, "/page/{folder}/{file}", |on| on.get(page::file_of_folder)),
];

/// Paths for operators. They show the state of the process, but no jobs or tables.
const OPERATIONS: [&str; 4] = ["/healthz", "/readyz", "/metrics", "/version"];

/// The router for all [`ROUTES`], or only for [`OPERATIONS`]. Other methods on a known path get 405, which lists the
/// allowed methods.
pub(super) fn router(only_operations: bool) -> Router<Api> {
    let is_served = |routes: &&[Route]| !only_operations || OPERATIONS.contains(&routes[0].path);
    ROUTES.chunk_by(|a, b| a.path == b.path).filter(is_served).fold(Router::new(), |router, routes| {
        let allowed = allowed_methods(routes);
        let refuse = move |method: Method, uri: Uri| {
            let allowed = allowed.clone();
            async move { method_not_allowed(&method, &uri, &allowed) }
        };
        let methods = routes.iter().fold(MethodRouter::new(), |methods, route| (route.add)(methods));
        router.route(routes[0].path, methods.fallback(refuse))
    })
}

/// The problem for an unknown path.
pub(super) async fn no_such_path(uri: Uri) -> Problem {
    Problem::new(
        ProblemKind::NoSuchPath,
        format!("«{}» is not a path of this service; /openapi.yaml lists all paths", uri.path()),
    )
}

/// The methods of a path in the format of `Allow`. Includes `HEAD` if the path has `GET`.
fn allowed_methods(routes: &[Route]) -> String {
    let mut names: Vec<&str> = routes.iter().map(|route| route.method.as_str()).collect();
    if names.contains(&"GET") && !names.contains(&"HEAD") {
        names.push("HEAD");
    }
    names.join(", ")
}

fn method_not_allowed(method: &Method, uri: &Uri, allowed: &str) -> Response {
    let detail = format!("{method} is not allowed on «{}»; allowed: {allowed}", uri.path());
    let problem = Problem::new(ProblemKind::MethodNotAllowed, detail);
    ([(header::ALLOW, allowed.to_owned())], problem).into_response()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn the_routes_of_a_path_are_adjacent_and_none_is_repeated() {
        let runs = ROUTES.chunk_by(|a, b| a.path == b.path).count();
        let paths: BTreeSet<&str> = ROUTES.iter().map(|route| route.path).collect();
        assert_eq!(runs, paths.len());
        let calls: BTreeSet<String> = ROUTES.iter().map(|route| format!("{} {}", route.method, route.path)).collect();
        assert_eq!(calls.len(), ROUTES.len());
    }

    #[test]
    fn the_router_can_be_built() {
        // axum panics if paths conflict.
        let _ = router(false);
        assert!(OPERATIONS.iter().all(|path| ROUTES.iter().any(|route| route.path == *path)));
    }

    #[tokio::test]
    async fn a_405_names_the_allowed_methods() {
        let response = method_not_allowed(&Method::PUT, &Uri::from_static("/v1/jobs"), &allowed_methods(&ROUTES[..2]));
        assert_eq!(response.status(), 405);
        assert_eq!(response.headers()[header::ALLOW], "POST, GET, HEAD");
        assert_eq!(response.headers()[header::CONTENT_TYPE], "application/problem+json");
    }
}
