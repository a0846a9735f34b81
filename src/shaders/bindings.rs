//! Descriptions of a table's bindings, by language.

use super::{Bound, Filter, Language, Namespace, Reading};

/// The bindings of a program.
pub(super) fn bindings(language: Language) -> &'static str {
    match language {
        Language::Wgsl => {
            "\
  here      group 0: uniform 0, matrix_a 1, matrix_b 2, terms 3, sampler 4
            group 1, of the example: case 0, result 1
  If ltc_hardware_filter is true, the sampler must be linear and clamp to the edge, and the textures must be filterable.
  Otherwise the shader interpolates, and any sampler will do."
        }
        Language::Spirv => {
            "\
  here      set 0: uniform 0, matrix_a 1, matrix_b 2, terms 3
            set 1, of the example: case 0, result 1
  Sampled images, no sampler: the shader interpolates."
        }
        Language::Glsl | Language::Glsl330 | Language::GlslEs => {
            "\
  here      uniform block 0, textures: units 0, 1 and 2
            of the example: uniform block 1, storage block 2
  The shader fetches texels and interpolates. Filter and wrap mode do not matter, but set filters without mipmaps."
        }
        Language::Hlsl => {
            "\
  matrices  M[i] is column i of M, as in the other languages. HLSL calls it a row, so M v is mul(v, M)
  here      uniform b0, matrix_a t1, matrix_b t2, terms t3, all of space0
            of the example: b0 and u1 of space1
  No sampler: the shader interpolates."
        }
        Language::Msl => {
            "\
  here      buffer: uniform 0; textures: matrix_a 0, matrix_b 1, terms 2
            of the example: buffers 1 and 2
  No sampler: the shader interpolates."
        }
    }
}

/// The bindings of a shader text.
pub(super) fn included_bindings(language: Language, reading: Reading, namespace: &Namespace) -> String {
    let bound = match reading.bound {
        Bound::Volumes => bound_volumes(language),
        Bound::Array => bound_array(language),
    };
    let weighed = match (language, reading.filter) {
        (Language::Wgsl, _) => {
            "\
If ltc_hardware_filter is true, the sampler must be linear and clamp to the edge, and the textures must be filterable.
  Otherwise the shader interpolates, and any sampler will do."
        }
        (_, Filter::Exact) => {
            "The shader fetches texels and interpolates. Use nearest filters: WebGL cannot filter 32-bit floats."
        }
        (_, Filter::Hardware) => "The sampler interpolates: filter linearly, clamp to the edge, no mipmaps.",
    };
    let (opengl, space) = match namespace.group {
        0 => ("in OpenGL 4.3 textures are units", ""),
        _ => ("OpenGL has no sets", ", all of space{group}"),
    };
    let bound = bound.replace("{opengl}", opengl).replace("{space}", space);
    format!("{}\n  {weighed}", namespace.numbered(&bound))
}

/// The bindings of a table in three textures.
fn bound_volumes(language: Language) -> &'static str {
    match language {
        Language::Wgsl => {
            "\
  here      group {group}: uniform {0}, matrix_a {1}, matrix_b {2}, terms {3}, sampler {4}"
        }
        Language::Glsl => {
            "\
  here      uniform block {0}, textures ltc_matrix_a {1}, ltc_matrix_b {2}, ltc_terms {3}: in Vulkan bindings of set
            {group}, the textures with samplers; {opengl}"
        }
        Language::Glsl330 | Language::GlslEs => {
            "\
  here      uniforms ltc_table.nodes and .reading, uvec4 each; ltc_table.start, .spacing, .per_step, .texel, .roughness,
            .cosines and .azimuths, vec4 each; samplers ltc_matrix_a, ltc_matrix_b, ltc_terms"
        }
        Language::Hlsl => {
            "\
  matrices  M[i] is column i of M, as in the other languages. HLSL calls it a row, so M v is mul(v, M)
  here      uniform b{0}, matrix_a t{1}, matrix_b t{2}, terms t{3}, sampler s{4}{space}"
        }
        Language::Msl | Language::Spirv => {
            "\
  here      no bindings: functions take the resources as arguments with the names ltc_table,
            ltc_matrix_a, ltc_matrix_b, ltc_terms and ltc_sampler"
        }
    }
}

/// The bindings of a table in one array.
fn bound_array(language: Language) -> &'static str {
    match language {
        Language::Wgsl => {
            "\
  here      group {group}: uniform {0}, layers {1}, sampler {2}"
        }
        Language::Glsl => {
            "\
  here      uniform block {0}, texture ltc_layers {1}: in Vulkan bindings of set {group}, the texture with a sampler;
            {opengl}"
        }
        Language::Glsl330 | Language::GlslEs => {
            "\
  here      uniforms ltc_table.nodes and .reading, uvec4 each; ltc_table.start, .spacing, .per_step, .texel, .roughness,
            .cosines and .azimuths, vec4 each; sampler ltc_layers"
        }
        Language::Hlsl => {
            "\
  matrices  M[i] is column i of M, as in the other languages. HLSL calls it a row, so M v is mul(v, M)
  here      uniform b{0}, layers t{1}, sampler s{2}{space}"
        }
        Language::Msl | Language::Spirv => {
            "\
  here      no bindings: functions take the resources as arguments with the names ltc_table, ltc_layers and
            ltc_sampler"
        }
    }
}
