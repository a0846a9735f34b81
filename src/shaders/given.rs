//! The shader text for a table whose recipe lists its nodes. The code contains the nodes and searches them.
//!
//! All other texts compute the position, because their nodes are evenly spaced in a coordinate of the layout.

use std::fmt::Write as _;

use super::{Lights, LitBy, Namespace, Reading, commented, sources};
use crate::{Language, header};
use ltcforge_fit::{Layout, PerAxis, Table};

/// The axes on which the shader searches for nodes, for a table of LTCs.
#[derive(Debug, Clone, PartialEq)]
pub struct GivenAxes {
    layout: Layout,
    /// The nodes of each unevenly spaced axis. Empty for the other axes.
    nodes: PerAxis<Vec<f64>>,
}

/// The shader expression for the value on each axis.
const VALUES: [&str; 4] = ["alpha", "ratio", "angles.x", "angles.y"];

impl GivenAxes {
    /// The axes to search for a table. `None` if all nodes are evenly spaced, as in the layout.
    #[must_use]
    pub fn of(table: &Table) -> Option<Self> {
        let (layout, axes) = (table.layout(), table.axes());
        if layout.is_even(axes) {
            return None;
        }
        // Checks each axis on its own, with a single node on the other axes.
        let alone = |axis: usize| {
            let of = |other: usize, nodes: &Vec<f64>| if other == axis { nodes.clone() } else { nodes[..1].to_vec() };
            let PerAxis { alpha, ratio, theta, phi } = axes;
            PerAxis { alpha: of(0, alpha), ratio: of(1, ratio), theta: of(2, theta), phi: of(3, phi) }
        };
        let of = |axis: usize, nodes: &Vec<f64>| if layout.is_even(&alone(axis)) { Vec::new() } else { nodes.clone() };
        let PerAxis { alpha, ratio, theta, phi } = axes;
        let nodes = PerAxis { alpha: of(0, alpha), ratio: of(1, ratio), theta: of(2, theta), phi: of(3, phi) };
        Some(Self { layout, nodes })
    }

    /// The layout of the table.
    #[must_use]
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// A text of functions for the layout, with a search of these nodes.
    #[must_use]
    pub fn searched(&self, functions: &str) -> String {
        let place = self.layout.shader().place;
        let call = format!("return {place}(alpha, ratio, wo);");
        format!("{}\n{}", functions.replacen(&call, "return ltc_place_given(alpha, ratio, wo);", 1), self.part(place))
    }

    /// The nodes, the search, and the function that returns the position.
    fn part(&self, place: &str) -> String {
        let mut out = String::new();
        // Writing to a String cannot fail.
        let _ = self.write_part(&mut out, place);
        out
    }

    fn write_part(&self, out: &mut String, place: &str) -> std::fmt::Result {
        let given =
            || self.nodes.named().into_iter().zip(VALUES).enumerate().filter(|(_, ((_, nodes), _))| !nodes.is_empty());
        for (_, ((axis, nodes), _)) in given() {
            let (count, upper) = (nodes.len(), axis.to_uppercase());
            let listed = nodes.iter().map(|node| format!("{:?}", *node as f32)).collect::<Vec<_>>().join(", ");
            writeln!(out, "/// The nodes of {axis}.")?;
            writeln!(out, "const LTC_NODES_OF_{upper} = array<f32, {count}>({listed});\n")?;
            writeln!(out, "/// The last node at or below a value of {axis}, and the weight of the next node.")?;
            writeln!(out, "fn ltc_among_{axis}(x: f32) -> vec2<f32> {{")?;
            writeln!(out, "    var nodes = LTC_NODES_OF_{upper};")?;
            writeln!(out, "    var lower = 0u;")?;
            writeln!(out, "    for (var node = 1u; node < {}u; node++) {{", count - 1)?;
            writeln!(out, "        if (x >= nodes[node]) {{\n            lower = node;\n        }}\n    }}")?;
            writeln!(out, "    let weight = (x - nodes[lower]) / (nodes[lower + 1u] - nodes[lower]);")?;
            writeln!(out, "    return vec2(f32(lower), clamp(weight, 0.0, 1.0));\n}}\n")?;
        }
        writeln!(out, "/// The place of a configuration among the nodes, with a search of the listed nodes.")?;
        writeln!(out, "fn ltc_place_given(alpha: f32, ratio: f32, wo: vec3<f32>) -> LtcPlace {{")?;
        writeln!(out, "    var place = {place}(alpha, ratio, wo);")?;
        if !self.nodes.theta.is_empty() || !self.nodes.phi.is_empty() {
            writeln!(out, "    let angles = ltc_quadrant(vec2(length(wo.xy), wo.y), vec2(wo.z, wo.x));")?;
        }
        for (number, ((axis, _), value)) in given() {
            let component = ["x", "y", "z", "w"][number];
            writeln!(out, "    let of_{axis} = ltc_among_{axis}({value});")?;
            writeln!(out, "    place.lower.{component} = of_{axis}.x;")?;
            writeln!(out, "    place.weight.{component} = of_{axis}.y;")?;
        }
        writeln!(out, "    return place;\n}}")
    }

    /// The functions for other renderers.
    #[must_use]
    pub fn functions(&self, lit_by: LitBy, reading: Reading, lights: Lights) -> String {
        self.searched(&sources::functions(lit_by, reading, lights))
    }

    /// The comment of a shader text. The lines `about` describe the table.
    #[must_use]
    pub fn comment(
        &self,
        language: Language,
        reading: Reading,
        lights: Lights,
        namespace: &Namespace,
        about: &[String],
    ) -> String {
        let axes = self.nodes.named().into_iter().filter(|(_, nodes)| !nodes.is_empty()).map(|(axis, _)| axis);
        let axes = axes.collect::<Vec<_>>().join(", ");
        let table = format!(
            "TABLE\n  The text reads only this table. Its recipe lists nodes of {axes}, and the text contains them.\n  \
             `ltcforge lookup` prints values to check a port against.\n  {}\n",
            about.join("\n  ")
        );
        header::include_comment_of(language, self.layout, reading, lights, namespace, &commented(&table))
    }
}
