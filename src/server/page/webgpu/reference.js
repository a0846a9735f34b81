// The truth in WGSL, by Monte Carlo integration; as webgl/reference.js, whose comments hold here.

import { LIGHTS, sampledLights } from './lights.js';
import { COVERS, SEEN } from './surface.js';

const DRAWN = `
fn hash(key: u32) -> u32 {
	var x = key;
	x = (x ^ (x >> 16u)) * 0x7feb352du;
	x = (x ^ (x >> 15u)) * 0x846ca68bu;
	return x ^ (x >> 16u);
}
fn point(i: u32, seed: vec2<u32>) -> vec2<f32> {
	return vec2<f32>((vec2(i * 0xc13fa9a9u, i * 0x91e10da5u) + seed) >> vec2(8u)) / 16777216.0;
}
fn fresnel(f0: vec3<f32>, cosine: f32) -> vec3<f32> {
	let m = clamp(1.0 - cosine, 0.0, 1.0);
	return mix(f0, vec3(1.0), m * m * m * m * m);
}
`;

const GGX = `
fn lambda(alpha: vec2<f32>, w: vec3<f32>) -> f32 {
	let t = alpha * w.xy / w.z;
	return 0.5 * (sqrt(1.0 + dot(t, t)) - 1.0);
}
fn distribution(alpha: vec2<f32>, wm: vec3<f32>) -> f32 {
	let t = wm.xy / alpha;
	let q = dot(t, t) + wm.z * wm.z;
	return 1.0 / (3.14159265 * alpha.x * alpha.y * q * q);
}
fn drawn(at: Shaded, u: vec2<f32>) -> vec3<f32> {
	let standard = normalize(vec3(at.alpha * at.wo.xy, at.wo.z));
	let z = (1.0 - u.y) * (1.0 + standard.z) - standard.z;
	let radius = sqrt(max(1.0 - z * z, 0.0));
	var wm = vec3(radius * cos(6.2831853 * u.x), radius * sin(6.2831853 * u.x), z) + standard;
	wm = normalize(vec3(at.alpha * wm.xy, max(wm.z, 0.0)));
	return 2.0 * dot(at.wo, wm) * wm - at.wo;
}
fn scattered(at: Shaded, wm: vec3<f32>, wi: vec3<f32>) -> vec2<f32> {
	let lambda_o = lambda(at.alpha, at.wo);
	let of_brdf = distribution(at.alpha, wm) / (4.0 * at.wo.z * (1.0 + lambda_o));
	return vec2(of_brdf * (1.0 + lambda_o) / (1.0 + lambda_o + lambda(at.alpha, wi)), of_brdf);
}
`;

const sheen = ( visibility ) => `
fn drawn(at: Shaded, u: vec2<f32>) -> vec3<f32> {
	let radius = sqrt(u.x);
	return vec3(radius * cos(6.2831853 * u.y), radius * sin(6.2831853 * u.y), sqrt(1.0 - u.x));
}
${ visibility }
fn scattered(at: Shaded, wm: vec3<f32>, wi: vec3<f32>) -> vec2<f32> {
	let alpha = max(max(at.alpha.x, at.alpha.y), 0.0049);
	let distribution = (2.0 + 1.0 / alpha) * pow(max(dot(wm.xy, wm.xy), 1e-36), 0.5 / alpha) / 6.2831853;
	return vec2(distribution * visibility(alpha, at.wo.z, wi.z) * wi.z, wi.z / 3.14159265);
}
`;

const ESTEVEZ = `
fn log_lambda(rough: f32, x: f32) -> f32 {
	let s = mix(vec4(25.3245, 3.32435, 0.16801, -1.27393), vec4(21.5473, 3.82987, 0.19823, -1.97760), rough);
	return s.x / (1.0 + s.y * pow(max(x, 1e-9), s.z)) + s.w * x + mix(-4.85967, -4.32054, rough);
}
fn smith(alpha: f32, cosine: f32) -> f32 {
	let rough = 1.0 - (1.0 - alpha) * (1.0 - alpha);
	let beyond = 2.0 * log_lambda(rough, 0.5) - log_lambda(rough, max(1.0 - cosine, 0.0));
	return exp(select(beyond, log_lambda(rough, cosine), cosine < 0.5));
}
fn visibility(alpha: f32, o: f32, i: f32) -> f32 {
	return 1.0 / (4.0 * o * i * (1.0 + smith(alpha, o) + smith(alpha, i)));
}
`;

const NEUBELT = 'fn visibility(alpha: f32, o: f32, i: f32) -> f32 {\n	return 0.25 / (o + i - o * i);\n}';

const BRDFS = { ggx: GGX, charlie: sheen( ESTEVEZ ), charlie_neubelt: sheen( NEUBELT ) };

const SUM = `
@group(1) @binding(5) var reference_sum: texture_2d<f32>;

@fragment
fn main(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
	let pixel = vec2<i32>(position.xy);
	let at = see(pixel);
	var sum = vec3(0.0);
	if (scene.first > 0) {
		sum = textureLoad(reference_sum, pixel, 0).xyz;
	}
	if (at.coverage <= 0.0) {
		return vec4(sum, 1.0);
	}
	let a = hash(u32(pixel.y * scene.size + pixel.x));
	let b = hash(a ^ 0x9e3779b9u);
	let c = hash(b ^ 0x9e3779b9u);
	let d = hash(c ^ 0x9e3779b9u);
	for (var i = scene.first; i < scene.first + scene.samples; i++) {
		var wi = drawn(at, point(u32(i), vec2(a, b)));
		if (wi.z > HORIZON) {
			let wm = normalize(at.wo + wi);
			let found = scattered(at, wm, wi);
			let towards = at.x * wi.x + at.y * wi.y + at.z * wi.z;
			for (var l = 0; l < scene.light_count; l++) {
				let of_light = light_pdf(l, at.position, towards);
				if (of_light >= 0.0 && found.y > 0.0) {
					sum += fresnel(at.f0, dot(at.wo, wm)) * emitted(l, at.position, towards) * (found.x / (found.y + of_light));
				}
			}
		}
		for (var l = 0; l < scene.light_count; l++) {
			let of_light = light_sample(l, at.position, point(u32(i), vec2(c, d)));
			wi = vec3(dot(of_light.xyz, at.x), dot(of_light.xyz, at.y), dot(of_light.xyz, at.z));
			if (wi.z > HORIZON && of_light.w > 0.0) {
				let wm = normalize(at.wo + wi);
				let found = scattered(at, wm, wi);
				let of_both = of_light.w + select(found.y, 0.0, is_shape(l, 3u));
				sum += fresnel(at.f0, dot(at.wo, wm)) * emitted(l, at.position, of_light.xyz) * (found.x / of_both);
			}
		}
	}
	return vec4(sum, 1.0);
}`;

/** The program that adds samples of a scattering model under lights of these shapes. */
export function referenceShader( brdf, shapes ) {

	return `const SHAPES_USED: u32 = ${ shapes }u;\n${ COVERS }${ SEEN }${ LIGHTS }${ sampledLights( ( shapes & 16 ) !== 0 ) }${ DRAWN }${ BRDFS[ brdf ] }${ SUM }`;

}
