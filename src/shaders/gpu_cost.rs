//! GPU costs of the shader texts: registers and instructions, as counted by a compiler.

/// A compiler's counts for one rectangle with a shader text, including the tangent frame. The sampler interpolates
/// tables. The counts are not timings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct GpuCost {
    /// Vector registers. With more registers, fewer pixels run at a time.
    pub registers: u32,
    /// Instructions.
    pub instructions: u32,
    /// Cycles that a SIMD needs for one group of threads, without stalls. Code after an early return counts less.
    pub inverse_throughput: u32,
}

/// Limits of the GPU cost of a shader, see [`GpuCost`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct GpuLimit {
    /// Maximum number of vector registers.
    pub registers: Option<u32>,
    /// Maximum number of instructions.
    pub instructions: Option<u32>,
}

impl GpuLimit {
    /// Whether a cost is within the limits. An unknown cost exceeds every limit.
    #[must_use]
    pub fn allows(self, cost: Option<GpuCost>) -> bool {
        let within = |limit: Option<u32>, count: fn(GpuCost) -> u32| {
            limit.is_none_or(|most| cost.is_some_and(|cost| count(cost) <= most))
        };
        within(self.registers, |cost| cost.registers) && within(self.instructions, |cost| cost.instructions)
    }
}

/// The compiler, as named by the driver: Mesa's for RDNA 2. It runs without such a GPU.
pub const COMPILER: &str = "Null hardware (RADV NAVI21), Mesa 22.3.6";

/// The costs of all texts: registers, instructions and inverse throughput. The names are those of
/// [`LitBy::name`](super::LitBy::name), with a suffix for the cheap horizon (`LTC_CHEAP_HORIZON`), for two lobes, or
/// for `layers` over a metal. The list also has the methods of engines. `cargo run --release -p ltcforge-studies --
/// gpu-costs` measures them.
const COSTS: &[(&str, [u32; 3])] = &[
    ("ltc reflected", [48, 692, 1261]),
    ("ltc kt2022", [40, 577, 1033]),
    ("ltc ltc2017", [32, 414, 752]),
    ("ltc ltc2016", [32, 423, 768]),
    ("ltc godot", [32, 411, 744]),
    ("ltc hdrp", [32, 414, 752]),
    ("ltc inverse", [32, 414, 752]),
    ("ltc matrix33", [32, 402, 728]),
    ("ltc materials", [48, 676, 1217]),
    ("sg reflected", [64, 2111, 3349]),
    ("sg kt2022", [64, 1996, 3119]),
    ("sg materials", [64, 2122, 3475]),
    ("asg reflected", [64, 2099, 3325]),
    ("asg kt2022", [64, 1984, 3095]),
    ("asg materials", [64, 2111, 3451]),
    ("ltc-formula", [48, 523, 988]),
    ("sg", [64, 1816, 2838]),
    ("asg", [64, 1804, 2814]),
    ("normals balanced", [72, 1421, 2145]),
    ("normals fast", [64, 1131, 1711]),
    ("normals fine", [72, 2239, 3370]),
    ("ltc reflected, two integrals", [64, 1049, 1941]),
    ("ltc reflected, blended", [64, 817, 1481]),
    ("ltc ltc2017, two integrals", [56, 711, 1328]),
    ("ltc ltc2017, blended", [40, 478, 866]),
    ("ltc-formula, plastic", [48, 536, 1010]),
    ("ltc reflected, cut", [48, 1112, 1599]),
    ("ltc reflected, cheap horizon", [48, 671, 1219]),
    ("ltc reflected, cut, cheap horizon", [48, 908, 1454]),
    ("ltc ltc2017, cut", [48, 834, 1090]),
    ("ltc ltc2017, cheap horizon", [40, 392, 706]),
    ("ltc ltc2017, cut, cheap horizon", [48, 629, 943]),
    ("ltc reflected, ltc_disk", [48, 1140, 1345]),
    ("ltc reflected, ltc_sphere", [48, 1168, 1237]),
    ("ltc reflected, ltc_tube", [80, 4222, 2564]),
    ("ltc reflected, ltc_line", [48, 664, 1118]),
    ("ltc reflected, ltc_cut_disk", [72, 2294, 1852]),
    ("ltc reflected, ltc_cut_sphere", [72, 2321, 1615]),
    ("ltc reflected, ltc_cut_tube", [96, 11274, 4737]),
    ("ltc reflected, ltc_cut_line", [48, 710, 1109]),
    ("ltc ltc2017, ltc_disk", [40, 866, 836]),
    ("ltc ltc2017, ltc_sphere", [40, 886, 728]),
    ("ltc ltc2017, ltc_tube", [80, 3936, 2055]),
    ("ltc ltc2017, ltc_line", [40, 386, 608]),
    ("ltc ltc2017, ltc_cut_disk", [72, 2021, 1343]),
    ("ltc ltc2017, ltc_cut_sphere", [72, 2048, 1109]),
    ("ltc ltc2017, ltc_cut_tube", [96, 10998, 4231]),
    ("ltc ltc2017, ltc_cut_line", [32, 433, 600]),
    ("ltc reflected, compensated", [48, 703, 1277]),
    ("ltc-formula, compensated", [48, 535, 1006]),
    ("normals balanced, compensated", [72, 1509, 2310]),
    ("asg, compensated", [64, 1898, 2992]),
    ("ltc reflected, layers", [64, 1565, 2961]),
    ("ltc ltc2017, layers", [64, 1022, 1942]),
    ("normals balanced, textured 4", [80, 2070, 3088]),
    ("normals balanced, textured 1", [80, 1797, 2694]),
    ("normals balanced, textured 2", [80, 1890, 2827]),
    ("normals balanced, textured 6", [80, 2253, 3355]),
    ("normals fast, textured 4", [80, 1783, 2655]),
    ("normals fine, textured 4", [80, 2891, 4317]),
    ("ltc reflected, textured 4", [64, 1147, 1916]),
    ("sampler of normals", [56, 835, 1601]),
    ("sampler of normals, a draw", [56, 983, 1871]),
    ("sampler of normals, two draws", [56, 1141, 2173]),
    ("sampler of normals, a density", [56, 789, 1513]),
    ("sampler about a mean normal", [56, 601, 1141]),
    ("sampler of a matrix, a draw", [48, 620, 1162]),
    ("ltc2017, clipless", [40, 311, 548]),
    ("ltc2017, stretched", [40, 328, 588]),
    ("kt2022, its own", [48, 713, 833]),
    ("representative point", [40, 368, 696]),
];

impl GpuCost {
    /// The cost of the shader that reads tables of a layout, with one or two lobes per entry.
    #[must_use]
    pub fn of_layout(layout: &str, is_two: bool) -> Option<Self> {
        Self::of(&format!("ltc {layout}{}", if is_two { ", blended" } else { "" }))
    }

    /// The cost of the text with this name. `None` for an unknown name.
    #[must_use]
    pub fn of(name: &str) -> Option<Self> {
        let (_, [registers, instructions, inverse_throughput]) = *COSTS.iter().find(|(known, _)| *known == name)?;
        Some(Self { registers, instructions, inverse_throughput })
    }

    /// The names of all texts and methods in the table.
    pub fn names() -> impl Iterator<Item = &'static str> {
        COSTS.iter().map(|(name, _)| *name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samplers_cost_less_than_the_light_of_their_rectangle() {
        let of = |name: &str| GpuCost::of(name).unwrap_or_else(|| panic!("no row {name}"));
        let [set_up, one, two] = ["", ", a draw", ", two draws"].map(|draws| of(&format!("sampler of normals{draws}")));
        assert!(set_up.instructions <= 900 && set_up.registers <= 64, "{set_up:?}");
        assert!(two.instructions - one.instructions <= 170, "{one:?} {two:?}");
        assert!(one.instructions < of("normals balanced").instructions);
    }

    /// The extra cost of four texture reads, compared with a rectangle without a picture, as in docs/textured.md.
    #[test]
    fn pictures_cost_little_compared_with_their_light() {
        for (text, registers) in
            [("normals balanced", 8), ("normals fast", 16), ("normals fine", 24), ("ltc reflected", 16)]
        {
            let [plain, with] = [text.to_owned(), format!("{text}, textured 4")]
                .map(|name| GpuCost::of(&name).unwrap_or_else(|| panic!("no row {name}")));
            assert!(with.instructions <= plain.instructions + 660, "{text}: {plain:?} {with:?}");
            assert!(with.registers <= plain.registers + registers, "{text}: {plain:?} {with:?}");
        }
    }
}
