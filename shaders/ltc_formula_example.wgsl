// Lights one surface with one light, by an LTC without a table. It shows how to call the other files. Use its results
// to check a port. Needs ltc_math.wgsl, ltc_rectangle.wgsl, ltc_light.wgsl, ltc_shapes.wgsl and ltc_formula.wgsl.
// Replace it with your own code, and delete LtcExample*.

struct LtcExampleCase {
    /// View direction in the tangent frame, of unit length. w: alpha_x.
    wo: vec4<f32>,
    /// x: alpha_y. y: shape of the light: number of vertices of a polygon (3 to 8), 0 for a disk, 1 for a sphere, 2 for
    /// a tube, 9 for a line. z: 1 if both sides of the light emit, else 0. w: radius of a sphere or tube, width of a
    /// line.
    light: vec4<f32>,
    /// xyz: the vertices relative to the shaded point, in the tangent frame. For a disk: centre and both half axes. For
    /// a sphere: its centre. For a tube or line: both ends. w of the first: f0, the reflectance at normal incidence. At
    /// grazing incidence it is 1.
    vertices: array<vec4<f32>, 8>,
}

@group(0) @binding(0) var<uniform> ltc_case: LtcExampleCase;
/// x: reflected light for a Fresnel factor of one. y: the same light weighted by Schlick's fifth power. z, w: 0.
@group(0) @binding(1) var<storage, read_write> ltc_result: vec4<f32>;

@compute @workgroup_size(1)
fn ltc_formula_example() {
    let lobe = ltc_formula(ltc_case.wo.w, ltc_case.light.x, ltc_case.wo.xyz, ltc_case.vertices[0].w, 1.0);
    let inverse = lobe.inverse;
    let count = u32(ltc_case.light.y);
    let two_sided = ltc_case.light.z == 1.0;
    var vertices: array<vec3<f32>, 8>;
    for (var i = 0u; i < 8u; i++) {
        vertices[i] = ltc_case.vertices[i].xyz;
    }
    var covered: f32;
    if (count == 0u) {
        covered = ltc_disk(inverse, vertices[0], vertices[1], vertices[2], two_sided);
    } else if (count == 1u) {
        covered = ltc_sphere(inverse, vertices[0], ltc_case.light.w);
    } else if (count == 2u) {
        covered = ltc_tube(inverse, vertices[0], vertices[1], ltc_case.light.w);
    } else if (count == 9u) {
        covered = ltc_line(inverse, vertices[0], vertices[1], ltc_case.light.w);
    } else if (count == 4u) {
        let corners = array<vec3<f32>, 4>(vertices[0], vertices[1], vertices[2], vertices[3]);
        covered = ltc_rectangle(inverse, corners, two_sided);
    } else {
        covered = ltc_polygon(inverse, vertices, count, two_sided);
    }
    // The reflected light of radiance L is L (f0 (amplitude - fresnel) + f90 fresnel) covered.
    ltc_result = vec4(vec2(lobe.amplitude, lobe.fresnel) * covered, 0.0, 0.0);
}
