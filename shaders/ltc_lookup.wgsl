// Reads a table: fold, fetch, restore the matrix from the layout's numbers, unfold. Needs ltc_math.wgsl,
// ltc_table.wgsl, and the functions ltc_place_of and ltc_restore, which call the functions of a layout.
// `ltcforge shader` writes both functions.

/// A configuration in the frame of the table: the larger roughness is along x, and the view is in the first quadrant.
struct LtcFold {
    alpha: f32,
    ratio: f32,
    wo: vec3<f32>,
    /// The axes of the table's frame in the tangent frame of the surface.
    x: vec2<f32>,
    y: vec2<f32>,
}

/// Folds a configuration into the frame of the table. wo is the view direction in the tangent frame, normal +z, of unit
/// length. Values outside the table's ranges are clamped.
fn ltc_fold(alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> LtcFold {
    let a = max(vec2(alpha_x, alpha_y), vec2(LTC_LEAST_ALPHA));
    let swap = a.y > a.x;
    let mirror = select(vec2(1.0), vec2(-1.0), wo.xy < vec2(0.0));
    let larger = max(a.x, a.y);
    var fold: LtcFold;
    fold.alpha = clamp(larger, ltc_table.roughness.x, ltc_table.roughness.y);
    fold.ratio = clamp(min(a.x, a.y) / larger, ltc_table.roughness.z, ltc_table.roughness.w);
    fold.x = select(vec2(mirror.x, 0.0), vec2(0.0, mirror.y), swap);
    fold.y = select(vec2(0.0, mirror.y), vec2(mirror.x, 0.0), swap);
    // phi is 0 for a view from straight above.
    let flat = select(abs(wo.xy), abs(wo.yx), swap) + vec2(1e-18, 0.0);
    let per_size = inverseSqrt(dot(flat, flat));
    let ahead = flat * per_size;
    let first = ltc_table.azimuths.xy;
    let last = ltc_table.azimuths.zw;
    var towards = ahead;
    if (first.x * ahead.y < first.y * ahead.x) {
        towards = first;
    }
    if (last.x * ahead.y > last.y * ahead.x) {
        towards = last;
    }
    let height = clamp(wo.z, ltc_table.cosines.x, ltc_table.cosines.y);
    let size = select(sqrt(1.0 - height * height), dot(flat, ahead), height == wo.z);
    fold.wo = vec3(towards * size, height);
    if (ltc_table.reading.y == 1u) {
        // The lobe rotates with the view.
        let turn = vec2(dot(first, ahead), first.x * ahead.y - first.y * ahead.x);
        let x = fold.x;
        fold.x = turn.x * x + turn.y * fold.y;
        fold.y = turn.x * fold.y - turn.y * x;
    }
    return fold;
}

/// A place along each axis: between the nodes lower and lower + 1, with the weight of node lower + 1.
struct LtcPlace {
    lower: vec4<f32>,
    weight: vec4<f32>,
}

/// Finds the place from coordinates in which the nodes are evenly spaced.
fn ltc_place(steps: vec4<f32>) -> LtcPlace {
    let most = max(vec4<f32>(ltc_table.nodes) - vec4(2.0), vec4(0.0));
    let at = (steps - ltc_table.start) * ltc_table.per_step;
    let lower = clamp(floor(at), vec4(0.0), most);
    return LtcPlace(lower, clamp(at - lower, vec4(0.0), vec4(1.0)));
}

/// Interpolates the 16 entries around a place in the shader. Weights are exact, and any texture format works. `layer`
/// is the first layer of the lobe.
fn ltc_fetch_weighed(lower: vec4<f32>, upper: vec4<f32>, layer: u32) -> LtcTexels {
    var sum = LtcTexels(vec4(0.0), vec4(0.0), vec4(0.0));
    let first = vec4<u32>(lower);
    let last = ltc_table.nodes - vec4(1u);
    for (var corner = 0u; corner < 16u; corner++) {
        let step = (vec4(corner) >> vec4(3u, 2u, 1u, 0u)) & vec4(1u);
        let weights = select(vec4(1.0) - upper, upper, step == vec4(1u));
        let weight = weights.x * weights.y * weights.z * weights.w;
        // There is no entry after the last node. Its weight would be zero.
        let entry = min(first + step, last);
        let fetched = ltc_fetch(vec3(entry.w, entry.y * ltc_table.nodes.z + entry.z, entry.x + layer));
        sum.a += weight * fetched.a;
        sum.b += weight * fetched.b;
        sum.terms += weight * fetched.terms;
    }
    return sum;
}

/// Interpolates the entries around a place. The sampler interpolates along all axes except ratio.
fn ltc_fetch_filtered(lower: vec4<f32>, upper: vec4<f32>, layer: u32) -> LtcTexels {
    // The sampler clamps the row after the last ratio. The weight of this row is zero.
    let texel = ltc_table.texel;
    let place = lower + upper + vec4(0.5);
    let row = (lower.y * texel.z + place.z) * texel.y;
    let above = row + texel.z * texel.y;
    let x = place.w * texel.w;
    return ltc_mix(ltc_sample(vec2(x, row), place.x, layer), ltc_sample(vec2(x, above), place.x, layer), upper.y);
}

/// A surface and a view in the frame of the table, and their place among the nodes.
struct LtcView {
    fold: LtcFold,
    place: LtcPlace,
}

/// Finds the frame and the place of a configuration. wo is as in ltc_fold.
fn ltc_view(alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> LtcView {
    let fold = ltc_fold(alpha_x, alpha_y, wo);
    return LtcView(fold, ltc_place_of(fold.alpha, fold.ratio, fold.wo));
}

/// The lobe whose first layer is `layer`.
fn ltc_lobe_at(view: LtcView, layer: u32) -> LtcLobe {
    let fold = view.fold;
    let place = view.place;
    var texels: LtcTexels;
    if (ltc_hardware_filter) {
        texels = ltc_fetch_filtered(place.lower, place.weight, layer);
    } else {
        texels = ltc_fetch_weighed(place.lower, place.weight, layer);
    }
    let stored = transpose(mat3x3(
        texels.a.xyz,
        vec3(texels.a.w, texels.b.xy),
        vec3(texels.b.zw, texels.terms.x),
    ));
    var lobe = ltc_restore(LtcLobe(stored, texels.terms.y, texels.terms.z), fold.alpha, fold.ratio, fold.wo);
    // The matrix is F M F^T, where F maps from the table's frame to the tangent frame.
    let m = lobe.m;
    let x = vec3(fold.x * m[0].x + fold.y * m[0].y, m[0].z);
    let y = vec3(fold.x * m[1].x + fold.y * m[1].y, m[1].z);
    let z = vec3(fold.x * m[2].x + fold.y * m[2].y, m[2].z);
    lobe.m = mat3x3(x * fold.x.x + y * fold.y.x, x * fold.x.y + y * fold.y.y, z);
    return lobe;
}

/// The lobe of the table for a surface and a view direction. wo is as in ltc_fold.
fn ltc_lookup(alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> LtcLobe {
    return ltc_lobe_at(ltc_view(alpha_x, alpha_y, wo), 0u);
}
