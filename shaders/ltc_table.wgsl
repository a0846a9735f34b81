// Reads a table: fold, fetch, restore what the layout stores, unfold. Needs ltc_math.wgsl, nodes_storage.wgsl or
// nodes_uniform.wgsl, texels_volumes.wgsl or texels_array.wgsl, and functions ltc_restore and ltc_even that call a layout's: `ltcforge shader` writes them, for layout reflected they are
//     fn ltc_restore(stored: LtcLobe, alpha_x: f32, ratio: f32, wo: vec3<f32>) -> LtcLobe {
//         return ltc_restore_reflected(stored, alpha_x, ratio, wo);
//     }
//     fn ltc_even(axis: u32, x: f32) -> f32 {
//         return x;
//     }
//
// Each entry is three texels, x = phi, y = ratio * theta_nodes + theta, z = alpha, which is the order in which a file stores
// its entries:
//     a      m00 m01 m02 m10
//     b      m11 m12 m20 m21
//     terms  m22 amplitude fresnel 0
// 32 or 16 bits a number. Nodes need not be uniform: they come as one list, alpha's first, then ratio's, theta's and
// phi's. A table without terms has amplitude 1 and fresnel 0 in their place.

struct LtcTable {
    /// How many nodes alpha, ratio, theta and phi have.
    nodes: vec4<u32>,
    /// x: the layout's number, which a shader for one layout does not read. y: 1 for a table of isotropic surfaces with one
    /// phi, whose lobes turn with the view.
    reading: vec4<u32>,
}

@group(0) @binding(0) var<uniform> ltc_table: LtcTable;

/// Lets the sampler interpolate phi and theta, and alpha in volumes, with 2 or 4 fetches in place of 16. Textures then have to
/// be filterable and the sampler linear. Many GPUs interpolate with weights of 8 bits only, which shows on sharp lobes.
override ltc_hardware_filter: bool = false;

/// The least roughness along either axis. Both are raised to it before their ratio is taken, so that mirrors stay isotropic.
const LTC_LEAST_ALPHA: f32 = 1e-5;

/// The lobe of a surface seen from one direction.
struct LtcLobe {
    /// Maps the clamped cosine to the lobe, in the surface's tangent frame.
    m: mat3x3<f32>,
    /// Reflectance is f0 (amplitude - fresnel) + f90 fresnel.
    amplitude: f32,
    fresnel: f32,
}

/// A configuration with the larger roughness along x and phi in the first quadrant.
struct LtcFold {
    alpha: f32,
    ratio: f32,
    theta: f32,
    phi: f32,
    /// -1 where x or y was mirrored.
    mirror: vec2<f32>,
    swap: bool,
}

/// wo: view direction in the tangent frame, normal +z, of unit length.
fn ltc_fold(alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> LtcFold {
    let a = max(vec2(alpha_x, alpha_y), vec2(LTC_LEAST_ALPHA));
    let swap = a.y > a.x;
    let flat = abs(wo.xy);
    var fold: LtcFold;
    fold.alpha = max(a.x, a.y);
    fold.ratio = min(a.x, a.y) / fold.alpha;
    fold.theta = min(ltc_atan2(sqrt(dot(flat, flat)), wo.z), 1.57079633);
    fold.phi = ltc_atan2(select(flat.y, flat.x, swap), select(flat.x, flat.y, swap));
    fold.mirror = select(vec2(1.0), vec2(-1.0), wo.xy < vec2(0.0));
    fold.swap = swap;
    return fold;
}

/// A place between the nodes lower and lower + 1 of an axis; the latter's weight.
struct LtcPlace {
    lower: u32,
    weight: f32,
    /// Where that is: outside the nodes the nearest of them.
    nearest: f32,
}

/// How often the most nodes of an axis, 16384, can be halved. A loop without a constant bound may keep a compiler busy for long.
const LTC_MOST_HALVINGS: u32 = 14u;

/// Where x lies among the `count` ascending nodes of an axis, from `first` on; outside them, at the nearest. The weight is
/// linear in the variable that the layout says.
fn ltc_between(axis: u32, first: u32, count: u32, x: f32) -> LtcPlace {
    // The last node that is not beyond x, in as many steps for every x.
    var lower = 0u;
    var below = ltc_node(first);
    var span = count;
    for (var halving = 0u; halving < LTC_MOST_HALVINGS; halving++) {
        if (span <= 1u) {
            break;
        }
        let part = span / 2u;
        let node = ltc_node(first + lower + part);
        lower = select(lower, lower + part, node <= x);
        below = select(below, node, node <= x);
        span -= part;
    }
    let above = ltc_node(first + min(lower + 1u, count - 1u));
    let nearest = clamp(x, below, above);
    let low = ltc_even(axis, below);
    let step = ltc_even(axis, above) - low;
    return LtcPlace(lower, select(0.0, (ltc_even(axis, nearest) - low) / step, above > below), nearest);
}

/// The three texels of an entry.
struct LtcTexels {
    a: vec4<f32>,
    b: vec4<f32>,
    terms: vec4<f32>,
}

/// The 16 entries around a place, interpolated here: exact weights, any texture format.
fn ltc_fetch_weighed(alpha: LtcPlace, ratio: LtcPlace, theta: LtcPlace, phi: LtcPlace) -> LtcTexels {
    var sum = LtcTexels(vec4(0.0), vec4(0.0), vec4(0.0));
    let last = ltc_table.nodes - vec4(1u);
    let lower = vec4(alpha.lower, ratio.lower, theta.lower, phi.lower);
    let upper = vec4(alpha.weight, ratio.weight, theta.weight, phi.weight);
    for (var corner = 0u; corner < 16u; corner++) {
        let step = (vec4(corner) >> vec4(3u, 2u, 1u, 0u)) & vec4(1u);
        let weights = select(vec4(1.0) - upper, upper, step == vec4(1u));
        let weight = weights.x * weights.y * weights.z * weights.w;
        // Beyond the last node there is no entry; its weight is zero.
        let entry = min(lower + step, last);
        let texel = vec3(entry.w, entry.y * ltc_table.nodes.z + entry.z, entry.x);
        let fetched = ltc_fetch(texel);
        sum.a += weight * fetched.a;
        sum.b += weight * fetched.b;
        sum.terms += weight * fetched.terms;
    }
    return sum;
}

/// The same, interpolated by the sampler along all axes but ratio.
fn ltc_fetch_filtered(alpha: LtcPlace, ratio: LtcPlace, theta: LtcPlace, phi: LtcPlace) -> LtcTexels {
    let n = vec4<f32>(ltc_table.nodes);
    let rows = vec2(ratio.lower, min(ratio.lower + 1u, ltc_table.nodes.y - 1u)) * ltc_table.nodes.z;
    let y = (vec2<f32>(rows) + vec2(f32(theta.lower) + theta.weight + 0.5)) / (n.y * n.z);
    let x = (f32(phi.lower) + phi.weight + 0.5) / n.w;
    return ltc_mix(ltc_sample(vec2(x, y.x), alpha), ltc_sample(vec2(x, y.y), alpha), ratio.weight);
}

fn ltc_mix(low: LtcTexels, high: LtcTexels, weight: f32) -> LtcTexels {
    return LtcTexels(mix(low.a, high.a, weight), mix(low.b, high.b, weight), mix(low.terms, high.terms, weight));
}

/// R_z(angle) M R_z(-angle): surface and view turn about z together.
fn ltc_turned(m: mat3x3<f32>, angle: f32) -> mat3x3<f32> {
    let turn = ltc_sin_cos(angle * 0.15915494);
    let r = mat3x3(vec3(turn.y, turn.x, 0.0), vec3(-turn.x, turn.y, 0.0), vec3(0.0, 0.0, 1.0));
    return r * m * transpose(r);
}

/// M of the configuration from that of the folded one: each mirror or swap F on both sides, F M F, which leaves the
/// determinant's sign and so a light's winding as they are.
fn ltc_unfold(fold: LtcFold, folded: mat3x3<f32>) -> mat3x3<f32> {
    var m = folded;
    if (fold.swap) {
        m = mat3x3(folded[1].yxz, folded[0].yxz, folded[2].yxz);
    }
    let mirror = vec3(fold.mirror, 1.0);
    return mat3x3(m[0] * mirror * mirror.x, m[1] * mirror * mirror.y, m[2] * mirror);
}

/// The table at a surface and a view direction, wo as in ltc_fold.
fn ltc_lookup(alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> LtcLobe {
    let fold = ltc_fold(alpha_x, alpha_y, wo);
    let n = ltc_table.nodes;
    let alpha = ltc_between(0u, 0u, n.x, fold.alpha);
    let ratio = ltc_between(1u, n.x, n.y, fold.ratio);
    let theta = ltc_between(2u, n.x + n.y, n.z, fold.theta);
    let phi = ltc_between(3u, n.x + n.y + n.z, n.w, fold.phi);
    var texels: LtcTexels;
    if (ltc_hardware_filter) {
        texels = ltc_fetch_filtered(alpha, ratio, theta, phi);
    } else {
        texels = ltc_fetch_weighed(alpha, ratio, theta, phi);
    }
    let stored = transpose(mat3x3(
        texels.a.xyz,
        vec3(texels.a.w, texels.b.xy),
        vec3(texels.b.zw, texels.terms.x),
    ));
    // Outside the table's ranges everything is evaluated at the nearest end.
    var view = vec3(select(abs(wo.xy), abs(wo.yx), fold.swap), wo.z);
    if (theta.nearest != fold.theta || phi.nearest != fold.phi) {
        let polar = ltc_sin_cos(theta.nearest * 0.15915494);
        let azimuth = ltc_sin_cos(phi.nearest * 0.15915494);
        view = vec3(polar.x * azimuth.y, polar.x * azimuth.x, polar.y);
    }
    var lobe = ltc_restore(LtcLobe(stored, texels.terms.y, texels.terms.z), alpha.nearest, ratio.nearest, view);
    if (ltc_table.reading.y == 1u) {
        lobe.m = ltc_turned(lobe.m, fold.phi - ltc_node(n.x + n.y + n.z));
    }
    lobe.m = ltc_unfold(fold, lobe.m);
    return lobe;
}
