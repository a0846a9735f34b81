export default /* glsl */ `// SPDX-License-Identifier: MIT OR Apache-2.0
// ltcforge 0.1.0, revision 1, sha256 of the text below: 870d5f7ca4f4b871
// Linearly Transformed Cosines: area lights on anisotropic GGX, by a table that ltcforge fitted.
//
// Reads tables of layout reflected, and takes every table for one.
//
// FUNCTIONS
//   ltc_lookup(alpha_x, alpha_y, wo)  M, amplitude and fresnel. GGX roughness along x and y; wo is the view direction in
//       the tangent frame, normal +z, of unit length. M maps the clamped cosine to the lobe, in that frame.
//   ltc_inverse(M)                    the inverse up to a factor, for all lights at the point.
//   ltc_rectangle(inverse, corners, two_sided), ltc_polygon(inverse, vertices, count, two_sided)
//       the part of the lobe that a light covers, 0 to 1. All is relative to the shaded point, in the tangent frame.
//       Vertices are convex and run clockwise seen from the lit side. A rectangle may be a parallelogram; its last corner is not
//       read. A polygon of four vertices costs more. Disks, spheres, tubes and lines were left out by
//       --lights polygons.
//   Light of radiance L arrives as L (f0 (amplitude - fresnel) + f90 fresnel) covered.
//
// USE
//   ltc_lookup and ltc_inverse once for a point and view, then one call for each light. Isotropic surfaces have alpha_x =
//   alpha_y. Diffuse light is the albedo times one with the unit matrix for inverse.
//   A second table in the same shader needs names and bindings of its own: ltcforge shader --prefix --first-binding.
//
// BINDINGS OF A TABLE
//   uniform   36 words, nine vectors of four, which ltcforge export --for wgpu writes as ltc.json. Two of u32: how
//             many nodes alpha, ratio, theta and phi have; the layout's number, not read here
//             (reflected 1, kt2022 0, ltc2017 2, ltc2016 3, godot 4, hdrp 5, inverse 6, matrix33 7),
//             1 if ratio has the one node 1 and phi has one node, else 0; alpha_nodes if entries have two lobes, else 0;
//             and 0. Seven of f32: the first node of each axis in the variable in which the layout's nodes are evenly
//             spaced, the step between nodes in it (1 for one node), and one over that; 1 / alpha_nodes, half of it for
//             two lobes, 1 / (ratio_nodes theta_nodes), theta_nodes, 1 / phi_nodes; the first and last alpha, the first and
//             last ratio; the cosines of the last and first theta, 0, 0; cosine and sine of the first phi, and of the last
//   matrix_a  3D texture, RGBA, 32 or 16 bit float: m00 m01 m02 m10 of each entry; m01 is row 0, column 1
//   matrix_b  likewise: m11 m12 m20 m21
//   terms     likewise: m22 amplitude fresnel 0; a table without terms has amplitude 1, fresnel 0
//   The textures are phi wide, ratio * theta high and alpha deep: texel (p, r * theta_nodes + t, a) is entry [a, r, t, p]
//   of the file's tensors. Second lobes, of tensor matrix_2, follow all first ones.
//   Texels stand in the order of the file's entries, but their numbers have to be put together from its tensors
//   matrix, amplitude and fresnel. Alpha is the larger roughness, ratio the smaller over it, theta and phi the view
//   direction's angles in radians.
//   here      uniforms ltc_table.nodes and .reading, uvec4 each; ltc_table.start, .step, .per_step, .texel, .roughness,
//             .cosines and .azimuths, vec4 each; samplers ltc_matrix_a, ltc_matrix_b, ltc_terms
//   The entries are weighed here, texels are fetched: filter and wrap mode do not matter.
//
// CHECK
//   Of the table with the uniform nodes 3 2 3 3, start 0.23713738 0.17012542 0 0, step 0.3814313 0.8298746 0.39396363 0.75,
//   alpha and ratio 0.1 1 0.1 1, cosines 0.0707372 1, azimuths 1 0 0.0707372 0.997495,
//   whose entry number e = ((a * 2 + r) * 3 + t) * 3 + p has the numbers I[k] + e * (k + 1) / 1024,
//   k = 0 to 10: the nine of the matrix by rows, amplitude, fresnel; I = 1 0 0 0 1 0 0 0 1 1 0. All are exact in
//   16 bits. Covered is by the
//   one-sided rectangle (-1 -1 1) (1 -1 1) (1 1.5 -0.5) (-1 1.5 -0.5).
//   M is given by rows. A port in 32 bits comes within 0.00002 of each number.
//   alpha_x 0.3 alpha_y 0.15 wo (0.36 0.48 0.8)
//     M 0.460449 -0.021201 -0.351458 | -0.020871 0.466205 -0.490648 | 0.314199 0.420865 0.981290
//     amplitude 1.154364 fresnel 0.008354 covered 0.712543
//   alpha_x 0.2 alpha_y 0.6 wo (-0.64 0.48 0.6)
//     M 0.798057 0.021249 0.629628 | -0.092988 0.829957 -0.287235 | -1.017662 0.593832 1.070388
//     amplitude 1.231810 fresnel 0.131679 covered 0.649354
//   alpha_x 0.05 alpha_y 0.02 wo (0.576 -0.768 0.28)
//     M 0.024247 0.037322 -0.613512 | 0.044761 0.006612 0.824185 | 0.138496 -0.182740 0.329282
//     amplitude 1.062531 fresnel 0.367991 covered 0.960659

precision highp float;
precision highp int;

// Angles of directions in the first quadrant, for the place of a table's entry: they need no more digits than its weights.

// The angles of vectors in the first quadrant from +x. Error below 4e-7 [ltcforge-studies, polynomials].
vec2 ltc_quadrant(vec2 y, vec2 x) {
    vec2 t = (y - x) / (y + x);
    vec2 z = t * t;
    vec2 tail = ((0.0068118 * z - 0.0336042) * z + 0.0796237) * z - 0.1323334;
    return 0.78539816 + t * (((tail * z + 0.1980782) * z - 0.3331737) * z + 0.9999961);
}

// A table in three 3D textures, z = alpha. For ltc_table.wgsl.

uniform highp sampler3D ltc_matrix_a;
uniform highp sampler3D ltc_matrix_b;
uniform highp sampler3D ltc_terms;

// The three texels of an entry.
struct LtcTexels {
    vec4 a;
    vec4 b;
    vec4 terms;
};

// The entry at a texel.
LtcTexels ltc_fetch(uvec3 texel) {
    return LtcTexels(texelFetch(ltc_matrix_a, ivec3(texel), 0), texelFetch(ltc_matrix_b, ivec3(texel), 0), texelFetch(ltc_terms, ivec3(texel), 0));
}

// A table: what is bound of it, and what stands in its textures. Needs texels_volumes.wgsl or texels_array.wgsl. ltc_lookup.wgsl
// reads any table, ltc_lookup_round.wgsl those of isotropic surfaces alone.
//
// Each entry is three texels, x = phi, y = ratio * theta_nodes + theta, z = alpha, which is the order in which a file stores
// its entries:
//     a      m00 m01 m02 m10
//     b      m11 m12 m20 m21
//     terms  m22 amplitude fresnel 0
// 32 or 16 bits a number. A table without terms has amplitude 1 and fresnel 0 in their place. Of a table with two lobes an entry
// all second ones follow all first ones along z.

struct LtcTable {
    // How many nodes alpha, ratio, theta and phi have.
    uvec4 nodes;
    // x: the layout's number, which a shader for one layout does not read. y: 1 for a table of isotropic surfaces with one
    // phi, whose lobes turn with the view. z: how many layers after the first lobes the second ones are, 0 where there are none.
    uvec4 reading;
    // The first node of each axis in the variable in which the layout's nodes are evenly spaced, the step between nodes, and
    // one over it; an axis of one node has the step 1.
    vec4 start;
    vec4 spacing;
    vec4 per_step;
    // For the sampler: one over the layers of alpha, which are its nodes for each lobe; one over those of ratio and theta, those of theta, one over those of phi.
    vec4 texel;
    // The first and the last node: of alpha, of ratio; the last and the first cosine of theta; cosine and sine of phi.
    vec4 roughness;
    vec4 cosines;
    vec4 azimuths;
};

uniform LtcTable ltc_table;

// The least roughness along either axis. Both are raised to it before their ratio is taken, so that mirrors stay isotropic.
const float LTC_LEAST_ALPHA = 1e-5;

// The lobe of a surface seen from one direction.
struct LtcLobe {
    // Maps the clamped cosine to the lobe, in the surface's tangent frame.
    mat3 m;
    // Reflectance is f0 (amplitude - fresnel) + f90 fresnel.
    float amplitude;
    float fresnel;
};

// Reads a table: fold, fetch, restore what the layout stores, unfold. Needs ltc_math.wgsl, ltc_table.wgsl, and functions
// ltc_steps, ltc_weights and ltc_restore that call a layout's, which \`ltcforge shader\` writes.

// A configuration in the table's frame, which has the larger roughness along x and the view in its first quadrant.
struct LtcFold {
    float alpha;
    float ratio;
    vec3 wo;
    // The axes of that frame in the surface's.
    vec2 x;
    vec2 y;
};

// wo: view direction in the tangent frame, normal +z, of unit length. Outside the table's ranges all is at the nearest end.
LtcFold ltc_fold(float alpha_x, float alpha_y, vec3 wo) {
    vec2 a = max(vec2(alpha_x, alpha_y), vec2(LTC_LEAST_ALPHA));
    bool swap = a.y > a.x;
    vec2 mirror = mix(vec2(1.0), vec2(-1.0), lessThan(wo.xy, vec2(0.0)));
    float larger = max(a.x, a.y);
    LtcFold fold = LtcFold(0.0, 0.0, vec3(0.0), vec2(0.0), vec2(0.0));
    fold.alpha = clamp(larger, ltc_table.roughness.x, ltc_table.roughness.y);
    fold.ratio = clamp(min(a.x, a.y) / larger, ltc_table.roughness.z, ltc_table.roughness.w);
    fold.x = swap ? vec2(0.0, mirror.y) : vec2(mirror.x, 0.0);
    fold.y = swap ? vec2(mirror.x, 0.0) : vec2(0.0, mirror.y);
    // Seen from straight above, phi is 0.
    vec2 flat_ = (swap ? abs(wo.yx) : abs(wo.xy)) + vec2(1e-18, 0.0);
    float per_size = inversesqrt(dot(flat_, flat_));
    vec2 ahead = flat_ * per_size;
    vec2 first = ltc_table.azimuths.xy;
    vec2 last = ltc_table.azimuths.zw;
    vec2 towards = ahead;
    if (first.x * ahead.y < first.y * ahead.x) {
        towards = first;
    }
    if (last.x * ahead.y > last.y * ahead.x) {
        towards = last;
    }
    float height = clamp(wo.z, ltc_table.cosines.x, ltc_table.cosines.y);
    float size = height == wo.z ? dot(flat_, ahead) : sqrt(1.0 - height * height);
    fold.wo = vec3(towards * size, height);
    if (ltc_table.reading.y == 1u) {
        // The lobe turns with the view.
        vec2 turn = vec2(dot(first, ahead), first.x * ahead.y - first.y * ahead.x);
        vec2 x = fold.x;
        fold.x = turn.x * x + turn.y * fold.y;
        fold.y = turn.x * fold.y - turn.y * x;
    }
    return fold;
}

// A place between the nodes lower and lower + 1 of each axis; the latter's weight.
struct LtcPlace {
    vec4 lower;
    vec4 weight;
};

// The place of variables in which nodes are evenly spaced.
LtcPlace ltc_place(vec4 steps) {
    vec4 most = max(vec4(ltc_table.nodes) - vec4(2.0), vec4(0.0));
    vec4 at = (steps - ltc_table.start) * ltc_table.per_step;
    vec4 lower = clamp(floor(at), vec4(0.0), most);
    return LtcPlace(lower, clamp(at - lower, vec4(0.0), vec4(1.0)));
}

// The 16 entries around a place, interpolated here: exact weights, any texture format. The lobe's layers begin at \`layer\`.
LtcTexels ltc_fetch_weighed(vec4 lower, vec4 upper, uint layer) {
    LtcTexels sum = LtcTexels(vec4(0.0), vec4(0.0), vec4(0.0));
    uvec4 first = uvec4(lower);
    uvec4 last = ltc_table.nodes - uvec4(1u);
    for (uint corner = 0u; corner < 16u; corner++) {
        uvec4 step_ = (uvec4(corner) >> uvec4(3u, 2u, 1u, 0u)) & uvec4(1u);
        vec4 weights = mix(vec4(1.0) - upper, upper, equal(step_, uvec4(1u)));
        float weight = weights.x * weights.y * weights.z * weights.w;
        // Beyond the last node there is no entry; its weight is zero.
        uvec4 entry = min(first + step_, last);
        LtcTexels fetched = ltc_fetch(uvec3(entry.w, entry.y * ltc_table.nodes.z + entry.z, entry.x + layer));
        sum.a += weight * fetched.a;
        sum.b += weight * fetched.b;
        sum.terms += weight * fetched.terms;
    }
    return sum;
}

// A surface and a view as the table has them.
struct LtcSeen {
    LtcFold fold;
    LtcPlace place;
};

// Where layout reflected has its nodes. Needs ltc_quadrant.wgsl and ltc_lookup.wgsl.

// Where a configuration lies among nodes that are evenly spaced in u, with alpha = u^1.6, ratio = u^1.3, theta =
// (1 - (1 - u)^2) 0.9999 pi/2 and phi = u. Weights are linear in these values.
LtcPlace ltc_place_reflected(float alpha, float ratio, vec3 wo) {
    vec2 angles = ltc_quadrant(vec2(length(wo.xy), wo.y), vec2(wo.z, wo.x));
    float theta = 0.63668344 * angles.x;
    vec2 powers = vec2(1.6, 1.3);
    vec2 surface = vec2(alpha, ratio);
    LtcPlace place = ltc_place(vec4(pow(surface, 1.0 / powers), 1.0 - sqrt(max(1.0 - theta, 0.0)), angles.y));
    vec3 below = ltc_table.start.xyz + place.lower.xyz * ltc_table.spacing.xyz;
    vec3 above = below + ltc_table.spacing.xyz;
    vec3 low = vec3(pow(below.xy, powers), (2.0 - below.z) * below.z);
    vec3 high = vec3(pow(above.xy, powers), (2.0 - above.z) * above.z);
    vec3 weight = clamp((vec3(surface, theta) - low) / (high - low), vec3(0.0), vec3(1.0));
    place.weight = vec4(weight, place.weight.w);
    return place;
}

// Where a configuration lies among the nodes, within the table's ranges seen from wo in the first quadrant.
LtcPlace ltc_place_of(float alpha, float ratio, vec3 wo) {
    return ltc_place_reflected(alpha, ratio, wo);
}

// wo as in ltc_fold.
LtcSeen ltc_seen(float alpha_x, float alpha_y, vec3 wo) {
    LtcFold fold = ltc_fold(alpha_x, alpha_y, wo);
    return LtcSeen(fold, ltc_place_of(fold.alpha, fold.ratio, fold.wo));
}

// Layout reflected: a table stores what is left of each lobe beside a reflection that is known in closed form. Needs
// LtcLobe and LTC_LEAST_ALPHA, which ltc_table.wgsl has; place_reflected.wgsl has its nodes.

// What the interpolated numbers of layout reflected stand for, at a place within the table's ranges seen from wo in
// the first quadrant: they are what is left of the lobe beside the reflection at the normal in the middle of those seen.
LtcLobe ltc_restore_reflected(LtcLobe stored, float alpha_x, float ratio, vec3 wo) {
    vec3 alpha = vec3(alpha_x, max(alpha_x * ratio, LTC_LEAST_ALPHA), 1.0);
    vec3 seen = alpha * wo;
    float seen2 = dot(seen, seen);
    float per_seen = inversesqrt(seen2);
    vec3 wm = normalize(alpha * (seen * per_seen + vec3(0.0, 0.0, 1.0)));
    float d = dot(wo, wm);
    vec3 reflected = 2.0 * d * wm - wo;
    // The reflected direction moves by 2 (d t - (reflected . t) wm) as the normal wm tilts along t: the columns of a matrix K for
    // t along x and y, times alpha_x, and reflected itself. M is K times what is stored.
    mat3 s = stored.m;
    vec2 x = 2.0 * alpha_x * s[0].xy;
    vec2 y = 2.0 * alpha_x * s[1].xy;
    vec2 z = 2.0 * alpha_x * s[2].xy;
    mat3 m = mat3(
        vec3(d * x, 0.0) - dot(reflected.xy, x) * wm + s[0].z * reflected,
        vec3(d * y, 0.0) - dot(reflected.xy, y) * wm + s[1].z * reflected,
        vec3(d * z, 0.0) - dot(reflected.xy, z) * wm + s[2].z * reflected
    );
    // Smith's G2 over G1, of lengths where the surface is a hemisphere.
    vec3 out_ = alpha * reflected;
    float height = abs(reflected.z);
    float size = seen2 * per_seen;
    float g2_over_g1 = height * (size + wo.z) / max(height * size + wo.z * sqrt(dot(out_, out_)), 1e-30);
    float amplitude = stored.amplitude * g2_over_g1 * g2_over_g1;
    float grazing = max(stored.fresnel + 1.0 - d, 0.0);
    float grazing2 = grazing * grazing;
    return LtcLobe(m, amplitude, amplitude * (grazing2 * grazing2 * grazing));
}

// The lobe of interpolated numbers there.
LtcLobe ltc_restore(LtcLobe stored, float alpha, float ratio, vec3 wo) {
    return ltc_restore_reflected(stored, alpha, ratio, wo);
}

// The lobe whose layers begin at one.
LtcLobe ltc_lobe_at(LtcSeen seen, uint layer) {
    LtcFold fold = seen.fold;
    LtcPlace place = seen.place;
    LtcTexels texels = ltc_fetch_weighed(place.lower, place.weight, layer);
    mat3 stored = transpose(mat3(
        texels.a.xyz,
        vec3(texels.a.w, texels.b.xy),
        vec3(texels.b.zw, texels.terms.x)
    ));
    LtcLobe lobe = ltc_restore(LtcLobe(stored, texels.terms.y, texels.terms.z), fold.alpha, fold.ratio, fold.wo);
    // F M F^T, where F maps from the table's frame to the surface's.
    mat3 m = lobe.m;
    vec3 x = vec3(fold.x * m[0].x + fold.y * m[0].y, m[0].z);
    vec3 y = vec3(fold.x * m[1].x + fold.y * m[1].y, m[1].z);
    vec3 z = vec3(fold.x * m[2].x + fold.y * m[2].y, m[2].z);
    lobe.m = mat3(x * fold.x.x + y * fold.y.x, x * fold.x.y + y * fold.y.y, z);
    return lobe;
}

// The table at a surface and a view direction, wo as in ltc_fold.
LtcLobe ltc_lookup(float alpha_x, float alpha_y, vec3 wo) {
    return ltc_lobe_at(ltc_seen(alpha_x, alpha_y, wo), 0u);
}

// Integrates a Linearly Transformed Cosine over a polygon. Needs ltc_math.wgsl.
//
// Vertices are given relative to the shaded point in its tangent frame, normal +z. The lit side is the one from which
// they run clockwise. The outline has to be convex. ltc_shapes.wgsl has lights that are no polygons.

// Whether what the horizon leaves of polygons, disks and spheres is guessed by a fit [Hill and Heitz 2016] instead of
// integrated. It is cheaper and mostly too bright: of disks by 0.033 on average and 0.16 at most where the horizon cuts them, by
// 0.003 on average and 0.09 at most above it.
const bool LTC_CHEAP_HORIZON = false;

// The inverse of M up to a positive factor, which changes no direction.
struct LtcInverse {
    mat3 m;
    // -1 where M mirrors and so turns polygons over; 0 where it has no inverse: nothing is lit then.
    float side;
};

// The inverse's numbers grow as 1 / alpha for sharp lobes. The adjugate divided by its largest element needs no
// determinant, which may underflow, and keeps vertices of any size in range.
LtcInverse ltc_inverse(mat3 m) {
    vec3 x = cross(m[1], m[2]);
    vec3 y = cross(m[2], m[0]);
    vec3 z = cross(m[0], m[1]);
    vec3 most = max(max(abs(x), abs(y)), abs(z));
    float largest = max(max(most.x, most.y), most.z);
    float side = largest > 1e-30 && largest < 1e30 ? sign(dot(m[2], z)) : 0.0;
    float scale = side / max(largest, 1e-30);
    return LtcInverse(transpose(mat3(x * scale, y * scale, z * scale)), side);
}

// The vector at length one; zero for one without direction.
vec3 ltc_unit(vec3 v) {
    return v * inversesqrt(dot(v, v) + 1e-36);
}

// The angle between two directions over its sine, less one. Error below 2.5e-5 of what half the angle is over its sine, up to a
// straight angle, which a sum of directions is nearer to than their product [ltcforge-studies, polynomials].
float ltc_bend(vec3 a, vec3 b) {
    vec3 sum = a + b;
    float k = dot(sum, sum) + 1e-18;
    return (3.1415927 + (0.3824614 + 0.0361113 * k) * k) * inversesqrt(k) - (1.9987368 + (0.1384879 + 0.0044966 * k) * k);
}

// The part of acos(a . b) (a x b).z / |a x b| beyond (a x b).z.
float ltc_arc(vec3 a, vec3 b) {
    return (a.x * b.y - a.y * b.x) * ltc_bend(a, b);
}

// (a x b).z around an origin.
//
// For a closed outline the sum is the same for every origin. With an origin near a small light each term is as small as the
// sum, which rounding errors would otherwise swamp.
float ltc_chord(vec3 a, vec3 b, vec3 origin) {
    vec2 p = a.xy - origin.xy;
    vec2 q = b.xy - origin.xy;
    return p.x * q.y - p.y * q.x;
}

// The integral over a convex polygon, added up edge by edge; what lies below the lobe's horizon is left out.
struct LtcClip {
    float sum;
    // A place near the outline.
    vec3 origin;
    vec3 previous;
    vec3 previous_unit;
    // Where the outline dips below the horizon and where it comes back.
    vec3 leaves;
    vec3 enters;
    // For LTC_CHEAP_HORIZON: the vector form factor without a horizon, times 2 pi, and the sum of the vertices' directions.
    vec3 flux;
    vec3 ahead;
};

// Begins at a vertex in cosine space; ltc_clip_edge then takes each of the others in turn, and this one last.
LtcClip ltc_clip_begin(vec3 vertex) {
    vec3 start = ltc_unit(vertex);
    return LtcClip(0.0, start, vertex, start, vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
}

// The same whatever LTC_CHEAP_HORIZON says.
LtcClip ltc_clip_exact_edge(LtcClip clip, vec3 b) {
    LtcClip next = clip;
    vec3 a = clip.previous;
    next.previous = b;
    next.previous_unit = ltc_unit(b);
    vec3 from_point = clip.previous_unit;
    vec3 to_point = next.previous_unit;
    if (a.z > 0.0 && b.z <= 0.0) {
        next.leaves = ltc_unit(vec3(b.xy * a.z - a.xy * b.z, 0.0));
        to_point = next.leaves;
    }
    if (a.z <= 0.0 && b.z > 0.0) {
        next.enters = ltc_unit(vec3(a.xy * b.z - b.xy * a.z, 0.0));
        from_point = next.enters;
    }
    if (a.z > 0.0 || b.z > 0.0) {
        next.sum += ltc_chord(from_point, to_point, clip.origin) + ltc_arc(from_point, to_point);
    }
    return next;
}

LtcClip ltc_clip_edge(LtcClip clip, vec3 b) {
    if (LTC_CHEAP_HORIZON) {
        LtcClip next = clip;
        next.previous = b;
        next.previous_unit = ltc_unit(b);
        vec3 c = cross(clip.previous_unit, next.previous_unit);
        next.flux += c + c * ltc_bend(clip.previous_unit, next.previous_unit);
        next.ahead += next.previous_unit;
        return next;
    }
    return ltc_clip_exact_edge(clip, b);
}

// The same whatever LTC_CHEAP_HORIZON says.
float ltc_clip_exact_finish(LtcClip clip, float side, bool two_sided) {
    bool is_cut = any(notEqual(clip.leaves, clip.enters));
    float closing = is_cut ? ltc_chord(clip.leaves, clip.enters, clip.origin) + ltc_arc(clip.leaves, clip.enters) : 0.0;
    float sum = (clip.sum + closing) * 0.15915494 * side;
    return clamp(two_sided ? abs(sum) : sum, 0.0, 1.0);
}

// The part of the distribution that the polygon covers, in [0, 1]. An arc along the horizon closes a cut outline.
float ltc_clip_finish(LtcClip clip, float side, bool two_sided) {
    if (LTC_CHEAP_HORIZON) {
        // The light of a sphere of the same vector form factor.
        float length_ = sqrt(dot(clip.flux, clip.flux)) * 0.15915494;
        float ahead = dot(clip.flux, clip.ahead);
        bool is_lit = side * ahead > 0.0;
        float up = (ahead > 0.0 ? 1.0 : -1.0) * clip.flux.z * 0.15915494;
        float seen = clamp((length_ * length_ + up) / (length_ + 1.0), 0.0, 1.0);
        return is_lit || (two_sided && side != 0.0) ? seen : 0.0;
    }
    return ltc_clip_exact_finish(clip, side, two_sided);
}

// A rectangle with LTC_CHEAP_HORIZON.
float ltc_cheap_rectangle(LtcInverse inverse_, vec3 corners[4], bool two_sided) {
    LtcClip clip = ltc_clip_begin(inverse_.m * corners[3]);
    clip = ltc_clip_edge(clip, inverse_.m * corners[0]);
    clip = ltc_clip_edge(clip, inverse_.m * corners[1]);
    clip = ltc_clip_edge(clip, inverse_.m * corners[2]);
    clip = ltc_clip_edge(clip, inverse_.m * corners[3]);
    return ltc_clip_finish(clip, inverse_.side, two_sided);
}

// A rectangle or parallelogram by its corners in order; the last is not read.
//
// From its lowest corner two edges rise to the others and on to the highest one. What the horizon leaves has five corners or fewer:
// the highest one, what is left of the two beside it, and where both ways from the lowest one come over the horizon, which is
// the lowest one itself where nothing is cut off. There is no case in which these jump.
float ltc_rectangle(LtcInverse inverse_, vec3 corners[4], bool two_sided) {
    if (LTC_CHEAP_HORIZON) {
        return ltc_cheap_rectangle(inverse_, corners, two_sided);
    }
    vec3 x = inverse_.m * (corners[1] - corners[0]);
    vec3 y = inverse_.m * (corners[2] - corners[1]);
    bvec2 falls = lessThan(vec2(x.z, y.z), vec2(0.0));
    vec2 turn = mix(vec2(1.0), vec2(-1.0), falls);
    x *= turn.x;
    y *= turn.y;
    vec3 lowest = inverse_.m * corners[0] + x * (0.5 * turn.x - 0.5) + y * (0.5 * turn.y - 0.5);
    vec3 a = lowest + x;
    vec3 b = lowest + y;
    vec3 highest = a + y;
    // How much of each edge is below the horizon.
    vec2 per_height = vec2(1.0) / max(vec2(x.z, y.z), vec2(1e-36));
    vec2 low = clamp(-lowest.z * per_height, vec2(0.0), vec2(1.0));
    float last_x = clamp(-b.z * per_height.x, 0.0, 1.0);
    float last_y = clamp(-a.z * per_height.y, 0.0, 1.0);
    vec3 d = ltc_unit(lowest + low.y * y + last_x * x);
    vec3 e = ltc_unit(lowest + low.x * x + last_y * y);
    vec3 f = ltc_unit(a + last_y * y);
    vec3 g = ltc_unit(highest);
    vec3 h = ltc_unit(b + last_x * x);
    float sum = ltc_chord(h, d, g) + ltc_chord(d, e, g) + ltc_chord(e, f, g)
        + ltc_arc(d, e) + ltc_arc(e, f) + ltc_arc(f, g) + ltc_arc(g, h) + ltc_arc(h, d);
    float covered = sum * 0.15915494 * (inverse_.side * turn.x * turn.y);
    return highest.z > 0.0 ? clamp(two_sided ? abs(covered) : covered, 0.0, 1.0) : 0.0;
}

// A convex polygon of 3 to 8 vertices in order; another count is taken as the nearest of these.
float ltc_polygon(LtcInverse inverse_, vec3 vertices[8], uint count, bool two_sided) {
    vec3 outline[8] = vertices;
    uint number = clamp(count, 3u, 8u);
    LtcClip clip = ltc_clip_begin(inverse_.m * outline[number - 1u]);
    for (uint i = 0u; i < 8u; i++) {
        if (i >= number) {
            break;
        }
        clip = ltc_clip_edge(clip, inverse_.m * outline[i]);
    }
    return ltc_clip_finish(clip, inverse_.side, two_sided);
}
`;
