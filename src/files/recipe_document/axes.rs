//! The axes of a recipe document: their domain, the number of nodes, and listed nodes.

use std::f64::consts::FRAC_PI_2;

use serde_json::Value;

use super::reader::{Faults, Object, echo};
use ltcforge_fit::{GivenNodes, Layout, PerAxis};

pub(super) const AXES: [&str; 4] = ["alpha", "ratio", "theta", "phi"];
/// Maximum number of nodes on an axis, which is enough for the largest textures.
pub(super) const MOST_NODES: u32 = 16_384;

/// The bounds of each axis's range. They are the default for anisotropic surfaces in every preset.
pub(super) const DOMAIN: PerAxis<[f64; 2]> =
    PerAxis { alpha: [0.0, 1.0], ratio: [0.0, 1.0], theta: [0.0, FRAC_PI_2], phi: [0.0, FRAC_PI_2] };
/// The ratio of isotropic surfaces, and the azimuth that represents all azimuths.
pub(super) const ISOTROPIC: PerAxis<[f64; 2]> = PerAxis { ratio: [1.0, 1.0], phi: [0.0, 0.0], ..DOMAIN };

/// Reads listed nodes, for layouts whose readers support any nodes.
pub(super) fn read_nodes(root: &Object, layout: Layout, faults: &mut Faults) -> GivenNodes {
    let object = root.object("nodes", &AXES, faults);
    let mut axis = |name: &str, [low, high]: [f64; 2]| -> Vec<f64> {
        let Some(value) = object.get(name) else { return Vec::new() };
        let mut note = |detail: String| faults.note(object.pointer(name), detail);
        if layout.is_of_materials() && (name == "alpha" || name == "ratio") {
            note(format!("layout \"{layout}\" takes these nodes from the field materials; leave this field out"));
            return Vec::new();
        }
        if layout.only_ranges().is_some() {
            note(format!("layout \"{layout}\" has fixed nodes, which its readers expect; leave this field out"));
            return Vec::new();
        }
        let numbers = value.as_array().and_then(|list| list.iter().map(Value::as_f64).collect::<Option<Vec<f64>>>());
        let Some(nodes) = numbers.filter(|nodes| !nodes.is_empty() && nodes.len() <= MOST_NODES as usize) else {
            note(format!("{} is not a list of 1 to {MOST_NODES} numbers", echo(value)));
            return Vec::new();
        };
        if let Some(node) = nodes.iter().find(|node| !(low..=high).contains(*node)) {
            note(format!("{node} is not within [{low}, {high}]"));
        } else if let Some((node, next)) = nodes.iter().zip(&nodes[1..]).find(|(node, next)| node >= next) {
            note(format!("{next} follows {node}: nodes must ascend without duplicates"));
        } else {
            // -0 and 0 are equal numbers and must give the same recipe.
            return nodes.into_iter().map(|node| node + 0.0).collect();
        }
        Vec::new()
    };
    GivenNodes::new(PerAxis {
        alpha: axis("alpha", DOMAIN.alpha),
        ratio: axis("ratio", DOMAIN.ratio),
        theta: axis("theta", DOMAIN.theta),
        phi: axis("phi", DOMAIN.phi),
    })
}

/// The listed nodes of an axis.
fn given_on<'a>(given: &'a GivenNodes, axis: &str) -> &'a [f64] {
    given.axes().named().into_iter().find(|(name, _)| *name == axis).map_or(&[], |(_, nodes)| nodes)
}

/// The smallest and the largest listed node.
pub(super) fn ends_of(given: &GivenNodes, axis: &str) -> Option<[f64; 2]> {
    let nodes = given_on(given, axis).iter().copied();
    nodes.clone().reduce(f64::min).zip(nodes.reduce(f64::max)).map(|(low, high)| [low, high])
}

/// Reads the numbers of nodes. A range of a single value has one node, any other range at least two. Listed nodes
/// determine their number.
pub(super) fn read_resolution(
    root: &Object,
    layout: Layout,
    range: &PerAxis<[f64; 2]>,
    given: &GivenNodes,
    faults: &mut Faults,
) -> PerAxis<u32> {
    let object = root.object("resolution", &AXES, faults);
    let default = layout.default_resolution();
    let mut axis = |name: &str, default: u32, [low, high]: [f64; 2]| {
        let given = match name {
            // Each material has one ratio.
            "ratio" if layout.is_of_materials() => 1,
            _ => given_on(given, name).len() as u32,
        };
        if given > 0 {
            return object.integer32(name, given, given, given, faults);
        }
        if low < high {
            return object.integer32(name, 2, MOST_NODES, default, faults);
        }
        if let Some(value) = object.get(name)
            && value.as_u64() != Some(1)
        {
            let detail = format!("{} does not match a range of the single value {low}, which has 1 node", echo(value));
            faults.note(object.pointer(name), detail);
        }
        1
    };
    PerAxis {
        alpha: axis("alpha", default.alpha, range.alpha),
        ratio: axis("ratio", default.ratio, range.ratio),
        theta: axis("theta", default.theta, range.theta),
        phi: axis("phi", default.phi, range.phi),
    }
}
