//! Figure 12: spheres lit by tables with few and with many nodes.

use std::sync::Arc;

use super::{error::FigureError, fits::entries};
use ltcforge::{
    fit::assemble,
    view::{
        picture::{Panel, Picture, beside, caption, grid, headed},
        preview::{Material, Mode, Preview, Scene, ShaderTable, TexelFormat},
    },
};

/// The paper's larger roughnesses.
const ALPHAS: [f64; 4] = [0.06, 0.31, 0.56, 0.81];
/// The ratio of the smaller to the larger roughness.
const RATIO: f64 = 0.3;
/// Nodes on each axis. The paper has 8 and 64. The fits with our numbers take a minute.
const NODES: [u32; 2] = [8, 16];
/// Side of a sphere's picture in pixels, and samples per pixel of the reference.
const SIDE: u32 = 192;
const SAMPLES: u32 = 1024;

/// Draws the difference between each table and the reference.
pub(super) fn draw(preview: &mut Preview) -> Result<Picture, FigureError> {
    let mut rows = Vec::new();
    for nodes in NODES {
        let resolution = ["alpha", "ratio", "theta", "phi"].map(|axis| format!("\"{axis}\": {nodes}")).join(", ");
        let recipe = format!("{{\"preset\": \"paper\", \"resolution\": {{{resolution}}}}}");
        let (plan, fitted) = entries(&recipe)?;
        let table = Arc::new(ShaderTable::new(&assemble(&plan, &fitted), TexelFormat::F32));
        let mut spheres = Vec::new();
        for alpha in ALPHAS {
            let material = Material { alpha_x: alpha, alpha_y: RATIO * alpha, rotation: 0.0 };
            let materials = vec![material];
            let scene = Scene { materials, size: SIDE, spp: SAMPLES, mode: Mode::Difference, ..Scene::default() };
            spheres.push(preview.render(&table, &scene, &|| false)?.picture);
        }
        rows.push((format!("{nodes} nodes an axis"), beside(&spheres)));
    }
    let panels: Vec<Panel<'_>> = rows
        .iter()
        .map(|(title, picture)| Panel { title, picture: picture.clone(), foot: caption(picture.width, &[""]) })
        .collect();
    let what = "How far light by a table is from GGX, under a light of radiance 3";
    Ok(headed(&[&[what]], &grid(&panels, 1)))
}
