// What lights the surface, in WGSL; as webgl/models.js, whose comments hold here.

import { LIGHTS, OUTLINES } from './lights.js';
import { COVERS, SEEN } from './surface.js';

const MAIN = `
fn outer(colour: vec3<f32>, parts: vec2<f32>) -> mat2x3<f32> {
	return mat2x3(colour * parts.x, colour * parts.y);
}

@fragment
fn main(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
	let at = see(vec2<i32>(position.xy));
	if (at.coverage <= 0.0) {
		return vec4(0.0, 0.0, 0.0, 1.0);
	}
	let parts = parts_of(at);
	return vec4(at.f0 * (parts[0] - parts[1]) + parts[1], 1.0);
}`;

const byNormals = ( hasPictures ) => `${ OUTLINES }
fn parts_of(at: Shaded) -> mat2x3<f32> {
	let view = normals_view(at.alpha.x, at.alpha.y, at.wo);
	var sum = mat2x3<f32>();
	for (var l = 0; l < scene.light_count; l++) {
		var outline = outline_of(l, at);
		let corners = array<vec3<f32>, 4>(outline.v[0], outline.v[1], outline.v[2], outline.v[3]);
${ hasPictures ? `		if (is_pictured(l)) {
			let textured = normals_textured_rectangle(view, corners, false, u32(scene.light_picture[l]), scene.picture_base);
			sum += outer(scene.light_radiance[l] * textured.colour, textured.parts);
			continue;
		}` : '' }
		var of_light: vec2<f32>;
		if (outline.count == 4u) {
			of_light = normals_rectangle(view, corners, is_solid(l));
		} else {
			var vertices = outline.v;
			of_light = normals_polygon(view, &vertices, outline.count, is_solid(l));
		}
		sum += outer(vec3(scene.light_radiance[l]), of_light);
	}
	return sum;
}
`;

const covered = ( hasPictures ) => `
fn covered(m: mat3x3<f32>, at: Shaded) -> vec3<f32> {
	let local = ltc_inverse(m);
	let inverse = LtcInverse(local.m * transpose(mat3x3(at.x, at.y, at.z)), local.side);
	var sum = vec3(0.0);
	for (var l = 0; l < scene.light_count; l++) {
		let centre = scene.light_centre[l].xyz - at.position;
		let end = scene.light_x[l].xyz - at.position;
		var part = 0.0;
		if (is_shape(l, 0u)) {
			var v: array<vec3<f32>, 8>;
			for (var i = 0; i < 8; i++) {
				v[i] = scene.light_vertices[8 * l + i].xyz - at.position;
			}
			let corners = array<vec3<f32>, 4>(v[0], v[1], v[2], v[3]);
${ hasPictures ? `			if (is_pictured(l)) {
				let textured = ltc_textured_rectangle(inverse, corners, false, u32(scene.light_picture[l]), scene.picture_base);
				sum += textured.covered * scene.light_radiance[l] * textured.colour;
				continue;
			}` : '' }
			if (scene.light_corners[l] == 4) {
				part = ltc_rectangle(inverse, corners, false);
			} else {
				part = ltc_polygon(inverse, v, u32(scene.light_corners[l]), false);
			}
		}
		if (is_shape(l, 1u)) {
			part = ltc_disk(inverse, centre, scene.light_x[l].xyz, scene.light_y[l].xyz, false);
		}
		if (is_shape(l, 2u)) {
			part = ltc_tube(inverse, centre, end, scene.light_centre[l].w);
		}
		if (is_shape(l, 3u)) {
			part = ltc_line(inverse, centre, end, scene.light_centre[l].w);
		}
		sum += part * vec3(scene.light_radiance[l]);
	}
	return sum;
}
`;

const LOOKUPS = {
	one: `
fn parts_of(at: Shaded) -> mat2x3<f32> {
	let lobe = ltc_lookup(at.alpha.x, at.alpha.y, at.wo);
	return outer(covered(lobe.m, at), vec2(lobe.amplitude, lobe.fresnel));
}`,
	two_lobes: `
fn parts_of(at: Shaded) -> mat2x3<f32> {
	let lobes = ltc_lookup_both(at.alpha.x, at.alpha.y, at.wo);
	return mat2x3(lobes.first.amplitude * covered(lobes.first.m, at), lobes.first.fresnel * covered(lobes.second, at));
}`,
	blended_lobes: `
fn parts_of(at: Shaded) -> mat2x3<f32> {
	let lobes = ltc_lookup_both(at.alpha.x, at.alpha.y, at.wo);
	let f0 = dot(at.f0, vec3(1.0 / 3.0));
	return outer(covered(ltc_blend(lobes, f0, 1.0), at), vec2(lobes.first.amplitude, lobes.first.fresnel));
}`,
};

const byEngines = ( hasPictures ) => `${ OUTLINES }
@group(0) @binding(0) var shipped_matrix: texture_2d<f32>;
@group(0) @binding(1) var shipped_terms: texture_2d<f32>;
@group(0) @binding(2) var shipped_sampler: sampler;
${ hasPictures ? '@group(0) @binding(3) var engines_pictures: texture_2d_array<f32>;' : '' }
fn edge(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
	let normal = cross(a, b);
	let sine = length(normal);
	return normal * select(1.0, atan2(sine, clamp(dot(a, b), -1.0, 1.0)) / sine, sine > 1e-6);
}

fn parts_of(at: Shaded) -> mat2x3<f32> {
	let place = vec2(sqrt(sqrt(at.alpha.x * at.alpha.y)), sqrt(1.0 - at.wo.z)) * (63.0 / 64.0) + 0.5 / 64.0;
	let stored = textureSampleLevel(shipped_matrix, shipped_sampler, place, 0.0);
	let terms = textureSampleLevel(shipped_terms, shipped_sampler, place, 0.0).xy;
	let flat2 = dot(at.wo.xy, at.wo.xy);
	let azimuth = select(vec2(1.0, 0.0), at.wo.xy / sqrt(max(flat2, 1e-36)), flat2 > 1e-12);
	let to_view = transpose(mat3x3(azimuth.x, azimuth.y, 0.0, -azimuth.y, azimuth.x, 0.0, 0.0, 0.0, 1.0));
	let inverse = mat3x3(stored.x, 0.0, stored.y, 0.0, 1.0, 0.0, stored.z, 0.0, stored.w) * to_view;
	var sum = vec3(0.0);
	for (var l = 0; l < scene.light_count; l++) {
		if (!is_solid(l) && dot(scene.light_normal[l].xyz, scene.light_vertices[8 * l].xyz - at.position) >= 0.0) {
			continue;
		}
		var outline = outline_of(l, at);
		let count = i32(outline.count);
		var flux = vec3(0.0);
		var before = normalize(inverse * outline.v[count - 1]);
		for (var i = 0; i < count; i++) {
			let corner = normalize(inverse * outline.v[i]);
			flux += edge(before, corner);
			before = corner;
		}
		flux *= 0.15915494;
		if (is_solid(l) && dot(flux, inverse * (outline.v[0] + outline.v[count / 2])) < 0.0) {
			flux = -flux;
		}
		let size = length(flux);
		var colour = vec3(scene.light_radiance[l]);
${ hasPictures ? `		if (is_pictured(l)) {
			colour *= textureSampleLevel(engines_pictures, shipped_sampler, vec2(0.5), scene.light_picture[l], 16.0).rgb;
		}` : '' }
		sum += colour * max(size * (size + flux.z / max(size, 1e-12)) / (size + 1.0), 0.0);
	}
	return outer(sum, terms);
}
`;

/** The program of a kind of model under lights of these shapes, a bit each; `text` is the service's. */
export function modelShader( kind, text, shapes ) {

	const hasPictures = ( shapes & 16 ) !== 0;
	const body = { normals: byNormals, engines: byEngines }[ kind ]?.( hasPictures ) || covered( hasPictures ) + LOOKUPS[ kind ];
	return `${ text }\nconst SHAPES_USED: u32 = ${ shapes }u;\n${ COVERS }${ SEEN }${ LIGHTS }${ body }${ MAIN }`;

}
