// A table of isotropic surfaces as polynomials, without textures and buffers. Needs layout_reflected.wgsl,
// ltc_smooth.wgsl and a function ltc_smooth_at with the table's coefficients, which
// `ltcforge shader --without-textures` writes.

/// The lobe of a surface seen from one direction.
struct LtcLobe {
    /// The matrix that maps the clamped cosine to the lobe, in the tangent frame.
    m: mat3x3<f32>,
    /// The albedo is f0 (amplitude - fresnel) + f90 fresnel.
    amplitude: f32,
    fresnel: f32,
}

/// The smallest value of the smaller roughness.
const LTC_LEAST_ALPHA: f32 = 1e-5;
/// The smallest value of the larger roughness. Smoother lobes are not fitted: at this roughness and below, a light is
/// reflected as by a mirror. Tables with textures have the same limit.
const LTC_ALPHA_FLOOR: f32 = 1e-4;
/// The cosine of the most grazing fitted view.
const LTC_LEAST_COSINE: f32 = 1.570796e-4;

/// Values of Chebyshev's polynomials: degrees 0 to 3, 4 to 7, 8 and 9.
struct LtcChebyshev {
    low: vec4<f32>,
    middle: vec4<f32>,
    high: vec2<f32>,
}

/// Chebyshev's polynomials at x. Domain: [-1, 1].
fn ltc_chebyshev(x: f32) -> LtcChebyshev {
    let t2 = 2.0 * x * x - 1.0;
    let t3 = 2.0 * x * t2 - x;
    let t4 = 2.0 * x * t3 - t2;
    let t5 = 2.0 * x * t4 - t3;
    let t6 = 2.0 * x * t5 - t4;
    let t7 = 2.0 * x * t6 - t5;
    let t8 = 2.0 * x * t7 - t6;
    let t9 = 2.0 * x * t8 - t7;
    return LtcChebyshev(vec4(1.0, x, t2, t3), vec4(t4, t5, t6, t7), vec2(t8, t9));
}

/// The lobe of an isotropic surface, alpha_x = alpha_y. An anisotropic surface gets the lobe of its larger roughness.
/// wo is the view direction in the tangent frame, normal +z, of unit length.
fn ltc_lookup(alpha_x: f32, alpha_y: f32, wo: vec3<f32>) -> LtcLobe {
    let alpha = clamp(max(alpha_x, alpha_y), LTC_ALPHA_FLOOR, 1.0);
    let height = clamp(wo.z, LTC_LEAST_COSINE, 1.0);
    let place = 2.0 * (vec2(sqrt(alpha), 1.0 - sqrt(height)) - LTC_FUNCTION_START) * LTC_FUNCTION_SCALE - vec2(1.0);
    let bounded = clamp(place, vec2(-1.0), vec2(1.0));
    let numbers = ltc_smooth_at(ltc_chebyshev(bounded.x), ltc_chebyshev(bounded.y));
    // numbers.shape holds p, q and the slant. numbers.terms holds the last row, the amplitude and the Fresnel term. The
    // other arguments of ltc_of_smooth are zero, because the lobe is symmetric about the plane of incidence. Seen from
    // straight above, the lobe is round.
    var slant = numbers.shape.z;
    var row = numbers.terms.x;
    let flat = sqrt(max(dot(wo.xy, wo.xy), 0.0));
    if (flat == 0.0) {
        slant = 0.0;
        row = 0.0;
    }
    let stored = ltc_of_smooth(vec3(numbers.shape.x, 0.0, numbers.shape.y), vec2(slant, 0.0), vec2(row, 0.0));
    let view = vec3(sqrt(1.0 - height * height), 0.0, height);
    var lobe = ltc_restore_reflected(LtcLobe(stored, max(numbers.terms.y, 0.0), numbers.terms.z), alpha, 1.0, view);
    // The lobe rotates about the normal with the view.
    if (flat > 0.0) {
        let turn = wo.xy / flat;
        let r = mat3x3(vec3(turn, 0.0), vec3(-turn.y, turn.x, 0.0), vec3(0.0, 0.0, 1.0));
        lobe.m = r * lobe.m * transpose(r);
    }
    return lobe;
}
