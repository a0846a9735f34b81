//! A table's manifest: what it is, how large, how good.
//!
//! Invariant: it follows from the table's file alone; no time, host or duration is in it.

use serde::Serialize;

use crate::{
    digest::Digest,
    export::{self, TableFileError},
    ltc::Table,
    recipe,
};

/// Worst configurations that a summary names.
const WORST: usize = 5;

#[derive(Debug, Serialize)]
struct Manifest {
    table: Digest,
    recipe_digest: Digest,
    recipe: serde_json::Value,
    bytes: usize,
    entries: usize,
    report: Report,
    exports: Vec<Export>,
}

/// Errors at the nodes: sliced Wasserstein distance on samples and directions that the fit did not see.
#[derive(Debug, PartialEq, Serialize)]
struct Report {
    nodes: Summary,
}

#[derive(Debug, PartialEq, Serialize)]
struct Summary {
    mean: f64,
    p95: f64,
    max: f64,
    worst: Vec<Node>,
}

/// One configuration and its error.
#[derive(Debug, PartialEq, Serialize)]
struct Node {
    alpha: f64,
    ratio: f64,
    theta: f64,
    phi: f64,
    error: f64,
}

/// Another file made of the same table.
#[derive(Debug, Serialize)]
struct Export {
    name: String,
    digest: Digest,
    bytes: usize,
}

/// The manifest of a canonical file as JSON, with a newline at its end.
///
/// # Errors
/// When `file_bytes` is not a canonical table file.
pub fn manifest_json(file_bytes: &[u8]) -> Result<Vec<u8>, TableFileError> {
    let file = export::decode(file_bytes)?;
    let text = recipe::canonical_json(&file.recipe);
    let not_json = |error: serde_json::Error| TableFileError::Recipe(error.to_string());
    let manifest = Manifest {
        table: Digest::of(file_bytes),
        recipe_digest: Digest::of(text.as_bytes()),
        recipe: serde_json::from_str(&text).map_err(not_json)?,
        bytes: file_bytes.len(),
        entries: file.table.node_error.len(),
        report: Report { nodes: summary(&file.table) },
        exports: vec![],
    };
    let mut json = serde_json::to_vec_pretty(&manifest).map_err(not_json)?;
    json.push(b'\n');
    Ok(json)
}

/// Mean, 95th percentile (nearest rank), maximum and the worst configurations of the error at the nodes; equal
/// errors in storage order.
fn summary(table: &Table) -> Summary {
    let mut order: Vec<usize> = (0..table.node_error.len()).collect();
    order.sort_by(|a, b| table.node_error[*b].total_cmp(&table.node_error[*a]).then(a.cmp(b)));
    let error = |rank: usize| order.get(rank).map_or(0.0, |index| f64::from(table.node_error[*index]));
    let count = order.len();
    let sum: f64 = table.node_error.iter().map(|error| f64::from(*error)).sum();
    // The nearest rank from below is ceil(0.95 n); counted from the largest, that leaves floor(0.05 n) above it.
    let above_p95 = count / 20;
    Summary {
        mean: if count == 0 { 0.0 } else { sum / count as f64 },
        p95: error(above_p95),
        max: error(0),
        worst: order.iter().take(WORST).map(|index| node(table, *index)).collect(),
    }
}

fn node(table: &Table, index: usize) -> Node {
    let axes = &table.axes;
    // Storage order: phi varies fastest.
    let (rest, phi) = (index / axes.phi.len(), index % axes.phi.len());
    let (rest, theta) = (rest / axes.theta.len(), rest % axes.theta.len());
    let (alpha, ratio) = (rest / axes.ratio.len(), rest % axes.ratio.len());
    Node {
        alpha: axes.alpha[alpha],
        ratio: axes.ratio[ratio],
        theta: axes.theta[theta],
        phi: axes.phi[phi],
        error: f64::from(table.node_error[index]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ltc::{Layout, PerAxis};

    #[test]
    fn the_summary_names_the_worst_configurations() {
        let axes = PerAxis {
            alpha: vec![0.1, 0.2],
            ratio: vec![0.3, 0.4, 0.5],
            theta: vec![0.0, 1.0],
            phi: vec![0.0, 0.5, 1.0, 1.5],
        };
        let node_error: Vec<f32> = (0_u8..48).map(f32::from).collect();
        let table = Table { layout: Layout::Kt2022, axes, matrix: vec![], terms: None, node_error };
        let summary = summary(&table);
        assert_eq!((summary.mean, summary.p95, summary.max), (23.5, 45.0, 47.0));
        assert_eq!(summary.worst.len(), WORST);
        assert_eq!(summary.worst[0], Node { alpha: 0.2, ratio: 0.5, theta: 1.0, phi: 1.5, error: 47.0 });
        assert_eq!(summary.worst[4], Node { alpha: 0.2, ratio: 0.5, theta: 0.0, phi: 1.5, error: 43.0 });
    }
}
