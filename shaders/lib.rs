//! The WGSL of ltcforge: each file of this folder as a text. `ltcforge-shaders` joins them for a model and a layout.

/// `gaussians_compensation.wgsl`.
pub const GAUSSIANS_COMPENSATION: &str = include_str!("gaussians_compensation.wgsl");
/// `gaussians_example.wgsl`.
pub const GAUSSIANS_EXAMPLE: &str = include_str!("gaussians_example.wgsl");
/// `gaussians_light.wgsl`.
pub const GAUSSIANS_LIGHT: &str = include_str!("gaussians_light.wgsl");
/// `gaussians_table.wgsl`.
pub const GAUSSIANS_TABLE: &str = include_str!("gaussians_table.wgsl");
/// `gaussians_table_example.wgsl`.
pub const GAUSSIANS_TABLE_EXAMPLE: &str = include_str!("gaussians_table_example.wgsl");
/// `ggx_reference.wgsl`.
pub const GGX_REFERENCE: &str = include_str!("ggx_reference.wgsl");
/// `layers.wgsl`.
pub const LAYERS: &str = include_str!("layers.wgsl");
/// `layout_isotropic.wgsl`.
pub const LAYOUT_ISOTROPIC: &str = include_str!("layout_isotropic.wgsl");
/// `layout_kt2022.wgsl`.
pub const LAYOUT_KT2022: &str = include_str!("layout_kt2022.wgsl");
/// `layout_reflected.wgsl`.
pub const LAYOUT_REFLECTED: &str = include_str!("layout_reflected.wgsl");
/// `light_picture.wgsl`.
pub const LIGHT_PICTURE: &str = include_str!("light_picture.wgsl");
/// `ltc_albedo.wgsl`.
pub const LTC_ALBEDO: &str = include_str!("ltc_albedo.wgsl");
/// `ltc_compensation.wgsl`.
pub const LTC_COMPENSATION: &str = include_str!("ltc_compensation.wgsl");
/// `ltc_cut.wgsl`.
pub const LTC_CUT: &str = include_str!("ltc_cut.wgsl");
/// `ltc_cut_shapes.wgsl`.
pub const LTC_CUT_SHAPES: &str = include_str!("ltc_cut_shapes.wgsl");
/// `ltc_decode.wgsl`.
pub const LTC_DECODE: &str = include_str!("ltc_decode.wgsl");
/// `ltc_example.wgsl`.
pub const LTC_EXAMPLE: &str = include_str!("ltc_example.wgsl");
/// `ltc_formula.wgsl`.
pub const LTC_FORMULA: &str = include_str!("ltc_formula.wgsl");
/// `ltc_formula_compensation.wgsl`.
pub const LTC_FORMULA_COMPENSATION: &str = include_str!("ltc_formula_compensation.wgsl");
/// `ltc_formula_example.wgsl`.
pub const LTC_FORMULA_EXAMPLE: &str = include_str!("ltc_formula_example.wgsl");
/// `ltc_function.wgsl`.
pub const LTC_FUNCTION: &str = include_str!("ltc_function.wgsl");
/// `ltc_inverse.wgsl`.
pub const LTC_INVERSE: &str = include_str!("ltc_inverse.wgsl");
/// `ltc_rectangle.wgsl`.
pub const LTC_RECTANGLE: &str = include_str!("ltc_rectangle.wgsl");
/// `ltc_light.wgsl`.
pub const LTC_LIGHT: &str = include_str!("ltc_light.wgsl");
/// `ltc_lookup.wgsl`.
pub const LTC_LOOKUP: &str = include_str!("ltc_lookup.wgsl");
/// `ltc_lookup_among.wgsl`.
pub const LTC_LOOKUP_AMONG: &str = include_str!("ltc_lookup_among.wgsl");
/// `ltc_lookup_round.wgsl`.
pub const LTC_LOOKUP_ROUND: &str = include_str!("ltc_lookup_round.wgsl");
/// `ltc_math.wgsl`.
pub const LTC_MATH: &str = include_str!("ltc_math.wgsl");
/// `ltc_quadrant.wgsl`.
pub const LTC_QUADRANT: &str = include_str!("ltc_quadrant.wgsl");
/// `ltc_shapes.wgsl`.
pub const LTC_SHAPES: &str = include_str!("ltc_shapes.wgsl");
/// `ltc_smooth.wgsl`.
pub const LTC_SMOOTH: &str = include_str!("ltc_smooth.wgsl");
/// `ltc_table.wgsl`.
pub const LTC_TABLE: &str = include_str!("ltc_table.wgsl");
/// `ltc_textured.wgsl`.
pub const LTC_TEXTURED: &str = include_str!("ltc_textured.wgsl");
/// `ltc_two_lobes.wgsl`.
pub const LTC_TWO_LOBES: &str = include_str!("ltc_two_lobes.wgsl");
/// `normals_arcs.wgsl`.
pub const NORMALS_ARCS: &str = include_str!("normals_arcs.wgsl");
/// `normals_arcs_rough.wgsl`.
pub const NORMALS_ARCS_ROUGH: &str = include_str!("normals_arcs_rough.wgsl");
/// `normals_balanced.wgsl`.
pub const NORMALS_BALANCED: &str = include_str!("normals_balanced.wgsl");
/// `normals_compensation.wgsl`.
pub const NORMALS_COMPENSATION: &str = include_str!("normals_compensation.wgsl");
/// `normals_disk.wgsl`.
pub const NORMALS_DISK: &str = include_str!("normals_disk.wgsl");
/// `normals_edge.wgsl`.
pub const NORMALS_EDGE: &str = include_str!("normals_edge.wgsl");
/// `normals_example.wgsl`.
pub const NORMALS_EXAMPLE: &str = include_str!("normals_example.wgsl");
/// `normals_fast.wgsl`.
pub const NORMALS_FAST: &str = include_str!("normals_fast.wgsl");
/// `normals_fine.wgsl`.
pub const NORMALS_FINE: &str = include_str!("normals_fine.wgsl");
/// `normals_outline.wgsl`.
pub const NORMALS_OUTLINE: &str = include_str!("normals_outline.wgsl");
/// `normals_rectangle.wgsl`.
pub const NORMALS_RECTANGLE: &str = include_str!("normals_rectangle.wgsl");
/// `normals_textured.wgsl`.
pub const NORMALS_TEXTURED: &str = include_str!("normals_textured.wgsl");
/// `normals_view.wgsl`.
pub const NORMALS_VIEW: &str = include_str!("normals_view.wgsl");
/// `place_reflected.wgsl`.
pub const PLACE_REFLECTED: &str = include_str!("place_reflected.wgsl");
/// `place_materials.wgsl`.
pub const PLACE_MATERIALS: &str = include_str!("place_materials.wgsl");
/// `prefilter.wgsl`.
pub const PREFILTER: &str = include_str!("prefilter.wgsl");
/// `preview_cut.wgsl`.
pub const PREVIEW_CUT: &str = include_str!("preview_cut.wgsl");
/// `preview_lobes.wgsl`.
pub const PREVIEW_LOBES: &str = include_str!("preview_lobes.wgsl");
/// `preview_textured.wgsl`.
pub const PREVIEW_TEXTURED: &str = include_str!("preview_textured.wgsl");
/// `reference_solids.wgsl`.
pub const REFERENCE_SOLIDS: &str = include_str!("reference_solids.wgsl");
/// `sampler.wgsl`.
pub const SAMPLER: &str = include_str!("sampler.wgsl");
/// `sampler_polygon.wgsl`.
pub const SAMPLER_POLYGON: &str = include_str!("sampler_polygon.wgsl");
/// `sphere.wgsl`.
pub const SPHERE: &str = include_str!("sphere.wgsl");
/// `texels_array.wgsl`.
pub const TEXELS_ARRAY: &str = include_str!("texels_array.wgsl");
/// `texels_volumes.wgsl`.
pub const TEXELS_VOLUMES: &str = include_str!("texels_volumes.wgsl");
/// `textured.wgsl`.
pub const TEXTURED: &str = include_str!("textured.wgsl");
