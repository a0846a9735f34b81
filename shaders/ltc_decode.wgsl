// Decodes a table's textures from its compact form, once at load time. Needs ltc_math.wgsl, layout_reflected.wgsl,
// ltc_smooth.wgsl and the table's constants, which `ltcforge export --container compact-wgsl` writes.

/// The numbers of a table for one configuration.
struct LtcLobe {
    m: mat3x3<f32>,
    amplitude: f32,
    fresnel: f32,
}

const LTC_LEAST_ALPHA: f32 = 1e-5;
const LTC_CHANNELS: u32 = 9u;
/// The largest number of bits of an integer, and the largest number of polynomials along an axis.
const LTC_MOST_BITS: u32 = 24u;
const LTC_MOST_POLYNOMIALS: u32 = 28u;
/// The number of integers that a workgroup of the first pass reads. Drivers limit the steps of a loop.
const LTC_AT_ONCE: u32 = 1024u;
/// Offsets among the probabilities of an array. The probabilities of the number of bits, by neighbourhood, come first.
/// Then come those of the second highest bit, the lower bits and the sign.
const LTC_SECONDS: u32 = 312u;
const LTC_LOW: u32 = 337u;
const LTC_SIGN: u32 = 338u;
const LTC_CHANCES: u32 = 339u;

/// The compact file, padded with zeros to whole words.
@group(0) @binding(0) var<storage, read> ltc_bytes: array<u32>;
/// LTC_SLOT numbers for each channel: its coefficients, then its corrections. After all channels comes the state that a
/// workgroup of the first pass leaves for the next workgroup. It holds each probability minus one half (for
/// coefficients, then for corrections) and the range coder.
@group(0) @binding(1) var<storage, read_write> ltc_integers: array<i32>;
/// All textures, one after another, in RGBA.
@group(0) @binding(2) var<storage, read_write> ltc_texels: array<vec4<f32>>;

/// The range coder: the position of the next byte, and the interval.
var<private> ltc_at: u32;
var<private> ltc_code: u32;
var<private> ltc_range: u32;

/// The next byte; zero after the end.
fn ltc_byte() -> u32 {
    let at = ltc_at;
    ltc_at = at + 1u;
    if (at >= LTC_BYTES) {
        return 0u;
    }
    return (ltc_bytes[at / 4u] >> (8u * (at % 4u))) & 255u;
}

fn ltc_bit(place: u32) -> u32 {
    let chance = u32(1024i + ltc_integers[LTC_STATE + place]);
    let bound = (ltc_range >> 11u) * chance;
    var bit = 0u;
    if (ltc_code >= bound) {
        ltc_code -= bound;
        ltc_range -= bound;
        ltc_integers[LTC_STATE + place] -= i32(chance >> 4u);
        bit = 1u;
    } else {
        ltc_range = bound;
        ltc_integers[LTC_STATE + place] += i32((2048u - chance) >> 4u);
    }
    // Probabilities stay far enough from 0 and 1 that one more byte is enough.
    if (ltc_range < 16777216u) {
        ltc_code = (ltc_code << 8u) | ltc_byte();
        ltc_range = ltc_range << 8u;
    }
    return bit;
}

/// Twice the magnitude of the integer one step back on an axis, plus the magnitude of the integer two steps back.
fn ltc_before(at: u32, place: u32, stride: u32) -> u32 {
    var sum = 0u;
    if (place > 0u) {
        sum = 2u * u32(abs(ltc_integers[at - stride]));
    }
    if (place > 1u) {
        sum += u32(abs(ltc_integers[at - 2u * stride]));
    }
    return sum;
}

/// Reads the next integer, number i of an array with these lengths. The caller stores it at index `at`.
fn ltc_integer(at: u32, i: u32, lengths: vec4<u32>, model: u32) -> i32 {
    let strides = vec4(lengths.y * lengths.z * lengths.w, lengths.z * lengths.w, lengths.w, 1u);
    let place = (vec4(i) / strides) % lengths;
    let sum = ltc_before(at, place.x, strides.x) + ltc_before(at, place.y, strides.y)
        + ltc_before(at, place.z, strides.z) + ltc_before(at, place.w, strides.w);
    let neighbourhood = min(32u - countLeadingZeros(sum), 12u);
    var bits = 0u;
    for (var bit = 0u; bit < LTC_MOST_BITS; bit++) {
        if (ltc_bit(model + neighbourhood * LTC_MOST_BITS + bit) == 0u) {
            break;
        }
        bits = bit + 1u;
    }
    if (bits == 0u) {
        return 0i;
    }
    var number = 1i;
    for (var above = 1u; above < LTC_MOST_BITS; above++) {
        if (above >= bits) {
            break;
        }
        let is_second = above == 1u;
        number = 2i * number + i32(ltc_bit(model + select(LTC_LOW, LTC_SECONDS + bits, is_second)));
    }
    if (ltc_bit(model + LTC_SIGN) == 1u) {
        number = -number;
    }
    return number;
}

/// The first pass: one invocation reads LTC_AT_ONCE integers. Dispatch it again until it has read all integers.
@compute @workgroup_size(1)
fn ltc_read() {
    let coder = LTC_STATE + 2u * LTC_CHANCES;
    ltc_at = u32(ltc_integers[coder]);
    ltc_code = bitcast<u32>(ltc_integers[coder + 1u]);
    ltc_range = bitcast<u32>(ltc_integers[coder + 2u]);
    var next = u32(ltc_integers[coder + 3u]);
    if (ltc_at == 0u) {
        ltc_at = LTC_CODED_AT;
        ltc_range = 0xffffffffu;
        for (var i = 0u; i < 4u; i++) {
            ltc_code = (ltc_code << 8u) | ltc_byte();
        }
    }
    let coefficients = LTC_COUNTS.x * LTC_COUNTS.y * LTC_COUNTS.z * LTC_COUNTS.w;
    for (var k = 0u; k < LTC_AT_ONCE; k++) {
        if (next >= LTC_STATE) {
            break;
        }
        let channel = next / LTC_SLOT;
        let within = next % LTC_SLOT;
        let is_correction = within >= coefficients;
        if (((select(LTC_STORED, LTC_CORRECTED, is_correction) >> channel) & 1u) == 0u) {
            next = (channel + 1u) * LTC_SLOT;
        } else {
            if (is_correction) {
                ltc_integers[next] = ltc_integer(next, within - coefficients, LTC_NODES, LTC_CHANCES);
            } else {
                ltc_integers[next] = ltc_integer(next, within, LTC_COUNTS, 0u);
            }
            next++;
        }
    }
    ltc_integers[coder] = i32(ltc_at);
    ltc_integers[coder + 1u] = bitcast<i32>(ltc_code);
    ltc_integers[coder + 2u] = bitcast<i32>(ltc_range);
    ltc_integers[coder + 3u] = i32(next);
}

/// The values of Gram's polynomials on n evenly spaced nodes, at node i.
fn ltc_gram(n: u32, count: u32, i: u32) -> array<f32, 28> {
    var values: array<f32, 28>;
    let nodes = f32(n);
    let t = f32(i) - 0.5 * (nodes - 1.0);
    values[0] = 1.0 / sqrt(nodes);
    var before = 0.0;
    for (var k = 1u; k < LTC_MOST_POLYNOMIALS; k++) {
        if (k >= count) {
            break;
        }
        let square = f32(k * k);
        let weight = sqrt(square * (nodes * nodes - square) / (4.0 * (4.0 * square - 1.0)));
        var value = t * values[k - 1u];
        if (k > 1u) {
            value -= before * values[k - 2u];
        }
        values[k] = value / weight;
        before = weight;
    }
    return values;
}

/// The second pass: each invocation writes the texels of one entry.
@compute @workgroup_size(64)
fn ltc_expand(@builtin(global_invocation_id) id: vec3<u32>) {
    let strides = vec4(LTC_NODES.y * LTC_NODES.z * LTC_NODES.w, LTC_NODES.z * LTC_NODES.w, LTC_NODES.w, 1u);
    let entries = LTC_NODES.x * strides.x;
    let entry = id.x;
    if (entry >= entries) {
        return;
    }
    let place = (vec4(entry) / strides) % LTC_NODES;
    var alphas = ltc_gram(LTC_NODES.x, LTC_COUNTS.x, place.x);
    var ratios = ltc_gram(LTC_NODES.y, LTC_COUNTS.y, place.y);
    var thetas = ltc_gram(LTC_NODES.z, LTC_COUNTS.z, place.z);
    var phis = ltc_gram(LTC_NODES.w, LTC_COUNTS.w, place.w);
    let coefficients = LTC_COUNTS.x * LTC_COUNTS.y * LTC_COUNTS.z * LTC_COUNTS.w;
    var steps = LTC_STEPS;
    var numbers: array<f32, 9>;
    for (var channel = 0u; channel < LTC_CHANNELS; channel++) {
        if (((LTC_STORED >> channel) & 1u) == 0u) {
            continue;
        }
        var at = channel * LTC_SLOT;
        var sum = 0.0;
        for (var a = 0u; a < LTC_COUNTS.x; a++) {
            for (var r = 0u; r < LTC_COUNTS.y; r++) {
                for (var t = 0u; t < LTC_COUNTS.z; t++) {
                    let factor = alphas[a] * ratios[r] * thetas[t];
                    for (var p = 0u; p < LTC_COUNTS.w; p++) {
                        sum += factor * phis[p] * f32(ltc_integers[at]);
                        at++;
                    }
                }
            }
        }
        if (((LTC_CORRECTED >> channel) & 1u) == 1u) {
            sum += LTC_CORRECTION_STEPS * f32(ltc_integers[channel * LTC_SLOT + coefficients + entry]);
        }
        numbers[channel] = sum * steps[channel];
    }

    // In lobes with a plane of symmetry, some numbers are exactly zero. Set them to zero, in case decoding did not.
    var axes = LTC_AXES;
    let alpha = max(axes[place.x], 1e-4);
    let ratio = axes[LTC_NODES.x + place.y];
    let theta = min(axes[LTC_NODES.x + LTC_NODES.y + place.z], 1.5706392);
    let phi = axes[LTC_NODES.x + LTC_NODES.y + LTC_NODES.z + place.w];
    let in_x = theta == 0.0 || phi == 0.0;
    let in_y = theta == 0.0 || phi > 1.570796;
    var root = vec3(numbers[0], numbers[1], numbers[2]);
    var slant = vec2(numbers[3], numbers[4]);
    var row = vec2(numbers[5], numbers[6]);
    if (!LTC_IS_REFLECTED) {
        row *= alpha / (alpha + 0.002);
    }
    if (in_x || in_y) {
        root.y = 0.0;
    }
    let is_kept = vec2(!in_y, !in_x);
    let stored = ltc_of_smooth(root, select(vec2(0.0), slant, is_kept), select(vec2(0.0), row, is_kept));
    var lobe = LtcLobe(stored, 1.0, 0.0);
    if (LTC_HAS_TERMS) {
        lobe.amplitude = max(numbers[7], 0.0);
        lobe.fresnel = numbers[8];
    }
    if (LTC_IS_REFLECTED) {
        let m = lobe.m;
        ltc_texels[entry] = vec4(m[0].x, m[1].x, m[2].x, m[0].y);
        ltc_texels[entries + entry] = vec4(m[1].y, m[2].y, m[0].z, m[1].z);
        ltc_texels[2u * entries + entry] = vec4(m[2].z, lobe.amplitude, lobe.fresnel, 0.0);
        return;
    }
    // Isotropic tables for engines: x is the roughness, y is the view. They store the lobe itself, not a lobe relative
    // to its reflection.
    let polar = ltc_sin_cos(theta * 0.15915494);
    let terms = vec2(lobe.amplitude, lobe.fresnel);
    lobe = ltc_restore_reflected(lobe, alpha, ratio, vec3(polar.x, 0.0, polar.y));
    if (!LTC_HAS_TERMS) {
        lobe.amplitude = terms.x;
        lobe.fresnel = terms.y;
    }
    let m = lobe.m;
    let texel = place.z * LTC_NODES.x + place.x;
    let middle = (m[0].x * m[2].z - m[0].z * m[2].x) / m[1].y;
    let inverse = vec4(m[2].z, -m[0].z, -m[2].x, m[0].x) / middle;
    let bounded = clamp(inverse, vec4(-60000.0), vec4(60000.0));
    let diagonal = max(bounded.xw, vec2(1e-30));
    ltc_texels[texel] = vec4(diagonal.x, bounded.yz, diagonal.y);
    let last = max(LTC_NODES.xz, vec2(2u)) - vec2(1u);
    let at = vec2<f32>(place.xz) / vec2<f32>(last);
    ltc_texels[entries + texel] = vec4(lobe.amplitude, lobe.fresnel, 0.0, ltc_clipped_form_factor(2.0 * at.x - 1.0, at.y));
}

// The form factor of a spherical cap above the horizon, divided by the form factor of the whole cap around the normal.
// c is the cosine of the angle between the normal and the middle of the cap. length is the length of the cap's vector
// form factor.
fn ltc_clipped_form_factor(c: f32, length: f32) -> f32 {
    if (abs(c) >= sqrt(length)) {
        return max(c, 0.0);
    }
    let cos_sigma = sqrt(max(1.0 - length, 0.0));
    let root = sqrt(max(length - c * c, 0.0));
    let clipped = ltc_atan2(root, -cos_sigma * c) * length * c - cos_sigma * root + ltc_atan2(root, cos_sigma);
    return max(clipped / (3.14159265 * length), 0.0);
}
