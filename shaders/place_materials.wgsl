// Finds the place of entries in layout materials: z is the number of the material. Needs ltc_quadrant.wgsl and
// ltc_lookup.wgsl.

/// The largest number of materials in a table.
const LTC_MOST_MATERIALS: u32 = 256u;

/// Alpha (the larger roughness) and ratio of a material. The table stores them after the terms, at the first and the
/// second theta.
fn ltc_material(material: u32) -> vec2<f32> {
    return vec2(ltc_fetch(vec3(0u, 0u, material)).terms.w, ltc_fetch(vec3(0u, 1u, material)).terms.w);
}

/// The place of a material for a view in the first quadrant. The nodes of theta are those of layout reflected.
fn ltc_place_material(material: u32, wo: vec3<f32>) -> LtcPlace {
    let angles = ltc_quadrant(vec2(length(wo.xy), wo.y), vec2(wo.z, wo.x));
    let theta = 0.63668344 * angles.x;
    var place = ltc_place(vec4(f32(material), 0.0, 1.0 - sqrt(max(1.0 - theta, 0.0)), angles.y));
    let below = ltc_table.start.z + place.lower.z * ltc_table.spacing.z;
    let above = below + ltc_table.spacing.z;
    let low = (2.0 - below) * below;
    let high = (2.0 - above) * above;
    place.weight.z = clamp((theta - low) / (high - low), 0.0, 1.0);
    return place;
}

/// The place of the material that is nearest in (sqrt(alpha), ratio).
fn ltc_place_materials(alpha: f32, ratio: f32, wo: vec3<f32>) -> LtcPlace {
    var nearest = 0u;
    var least = 1e30;
    for (var material = 0u; material < LTC_MOST_MATERIALS; material++) {
        if (material >= ltc_table.nodes.x) {
            break;
        }
        let pair = ltc_material(material);
        let away = vec2(sqrt(pair.x) - sqrt(alpha), pair.y - ratio);
        let distance = dot(away, away);
        if (distance < least) {
            least = distance;
            nearest = material;
        }
    }
    return ltc_place_material(nearest, wo);
}

/// Finds the frame and the place of a material and a view. The larger roughness is along x.
fn ltc_view_material(material: u32, wo: vec3<f32>) -> LtcView {
    let pair = ltc_material(material);
    let fold = ltc_fold(pair.x, pair.x * pair.y, wo);
    return LtcView(fold, ltc_place_material(material, fold.wo));
}

/// The lobe of the table for a material and a view direction. The larger roughness is along x. wo is as in ltc_fold.
fn ltc_lookup_material(material: u32, wo: vec3<f32>) -> LtcLobe {
    return ltc_lobe_at(ltc_view_material(material, wo), 0u);
}
