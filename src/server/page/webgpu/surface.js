// What each pixel shows of the scene, in WGSL; as webgl/surface.js, whose comments hold here. Rows begin at the top.

import { SCENE } from './scene.js';

/** One triangle that covers the picture. */
export const COVERS = `
@vertex
fn covers(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
	return vec4(select(-1.0, 3.0, i == 1u), select(-1.0, 3.0, i == 2u), 0.0, 1.0);
}
`;

const TARGETS = `${ SCENE }
struct Written {
	@location(0) place: vec4<f32>,
	@location(1) tangent: vec4<f32>,
	@location(2) normal: vec4<f32>,
	@location(3) f0: vec4<f32>,
}
`;

export const SURFACE_SHADER = `${ COVERS }${ TARGETS }
@fragment
fn main(@builtin(position) at: vec4<f32>) -> Written {
	let middle = at.xy / f32(scene.size) * 2.0 - 1.0;
	let ray = normalize(scene.forward + scene.right * middle.x - scene.up * middle.y);
	let eye = scene.eye;
	var position: vec3<f32>;
	var normal = vec3(0.0, 1.0, 0.0);
	var along = vec3(1.0, 0.0, 0.0);
	var coverage: f32;
	if (scene.surface == 1) {
		let t = -eye.y / min(ray.y, -1e-6);
		position = eye + t * ray;
		position.y = 0.0;
		coverage = select(0.0, clamp(2.0 * (1.0 - t / 12.0), 0.0, 1.0), ray.y < -1e-6 && eye.y > 1e-3);
	} else {
		let closest = -dot(eye, ray);
		let nearest = eye + closest * ray;
		let distance2 = dot(nearest, nearest);
		let rim = (1.0 - sqrt(distance2)) / (scene.pixel_width * closest);
		coverage = select(0.0, clamp(rim + 0.5, 0.0, 1.0), closest > 0.0);
		position = normalize(nearest - sqrt(max(1.0 - distance2, 0.0)) * ray);
		normal = position;
		let circle = vec3(normal.z, 0.0, -normal.x);
		let length2 = dot(circle, circle);
		along = select(vec3(1.0, 0.0, 0.0), circle / sqrt(max(length2, 1e-12)), length2 > 1e-8);
	}
	let tangent = scene.material.z * along + scene.material.w * cross(normal, along);
	return Written(vec4(position, coverage), vec4(tangent, scene.material.x), vec4(normal, scene.material.y), vec4(scene.f0, 1.0));
}`;

const TEXTURED = `
@group(1) @binding(1) var base_texture: texture_2d<f32>;
@group(1) @binding(2) var base_sampler: sampler;
@group(1) @binding(3) var rough_texture: texture_2d<f32>;
@group(1) @binding(4) var rough_sampler: sampler;
@group(1) @binding(5) var normal_texture: texture_2d<f32>;
@group(1) @binding(6) var normal_sampler: sampler;

fn bent(at: Corner, normal: vec3<f32>) -> vec3<f32> {
	let px = dpdx(at.place);
	let py = dpdy(at.place);
	let ux = dpdx(at.uv);
	let uy = dpdy(at.uv);
	let stored = textureSample(normal_texture, normal_sampler, at.uv).xyz * 2.0 - 1.0;
	let side = select(1.0, -1.0, ux.x * uy.y < uy.x * ux.y);
	let is_given = dot(at.tangent.xyz, at.tangent.xyz) > 1e-12;
	var x = select(side * (px * uy.y - py * ux.y), at.tangent.xyz, is_given);
	x -= normal * dot(normal, x);
	if (dot(x, x) < 1e-24) {
		return normal;
	}
	x = normalize(x);
	var y = cross(normal, x);
	y *= select(select(1.0, -1.0, dot(y, side * (px * uy.x - py * ux.x)) < 0.0), at.tangent.w, is_given);
	return normalize(x * stored.x * scene.normal_scale + y * stored.y * scene.normal_scale + normal * max(stored.z, 1e-3));
}

fn reflected(uv: vec2<f32>, rough: vec4<f32>) -> vec3<f32> {
	let base = scene.base * textureSample(base_texture, base_sampler, uv).rgb;
	return mix(mix(vec3(scene.factors.z), base, scene.factors.x * rough.b), vec3(1.0), scene.is_white);
}

fn alphas(rough: vec4<f32>) -> vec2<f32> {
	let across = scene.factors.y * rough.g * scene.factors.y * rough.g;
	return vec2(mix(across, 1.0, scene.factors.w), across);
}
`;

/** The triangles of a mesh. */
export const meshShader = ( isTextured ) => `${ TARGETS }
struct Corner {
	@builtin(position) position: vec4<f32>,
	@location(0) place: vec3<f32>,
	@location(1) normal: vec3<f32>,
	@location(2) tangent: vec4<f32>,
${ isTextured ? '	@location(3) uv: vec2<f32>,' : '' }
}
const NEAR = 0.05;
const FAR = 100.0;

@vertex
fn corner(@location(0) place: vec3<f32>, @location(1) normal: vec3<f32>, @location(2) tangent: vec4<f32>${ isTextured ? ', @location(3) uv: vec2<f32>' : '' }) -> Corner {
	let way = place - scene.eye;
	let depth = dot(way, scene.forward);
	let across = dot(way, scene.right) / dot(scene.right, scene.right);
	let upwards = dot(way, scene.up) / dot(scene.up, scene.up);
	return Corner(vec4(across, upwards, (depth - NEAR) * FAR / (FAR - NEAR), depth), place, normal, tangent${ isTextured ? ', uv' : '' });
}
${ isTextured ? TEXTURED : '' }
@fragment
fn main(at: Corner, @builtin(front_facing) is_front: bool) -> Written {
	var normal = normalize(select(-at.normal, at.normal, is_front));
	var f0 = scene.f0;
	var alpha = scene.material.xy;
${ isTextured ? `	normal = bent(at, normal);
	let rough = textureSample(rough_texture, rough_sampler, at.uv);
	f0 = reflected(at.uv, rough);
	alpha = alphas(rough);` : '' }
	var along = select(vec3(normal.z, 0.0, -normal.x), at.tangent.xyz, dot(at.tangent.xyz, at.tangent.xyz) > 1e-12);
	along -= normal * dot(normal, along);
	let other = cross(normal, select(vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), abs(normal.x) > 0.7));
	along = normalize(select(other, along, dot(along, along) > 1e-8));
	let tangent = scene.material.z * along + scene.material.w * at.tangent.w * cross(normal, along);
	return Written(vec4(at.place, 1.0), vec4(tangent, alpha.x), vec4(normal, alpha.y), vec4(f0, 1.0));
}`;

export const SEEN = `${ SCENE }
@group(1) @binding(1) var seen_place: texture_2d<f32>;
@group(1) @binding(2) var seen_tangent: texture_2d<f32>;
@group(1) @binding(3) var seen_normal: texture_2d<f32>;
@group(1) @binding(4) var seen_f0: texture_2d<f32>;
struct Shaded {
	position: vec3<f32>,
	x: vec3<f32>,
	y: vec3<f32>,
	z: vec3<f32>,
	wo: vec3<f32>,
	f0: vec3<f32>,
	alpha: vec2<f32>,
	coverage: f32,
}

fn see(texel: vec2<i32>) -> Shaded {
	let place = textureLoad(seen_place, texel, 0);
	let tangent = textureLoad(seen_tangent, texel, 0);
	let normal = textureLoad(seen_normal, texel, 0);
	var at: Shaded;
	at.position = place.xyz;
	at.coverage = place.w;
	at.x = tangent.xyz;
	at.z = normal.xyz;
	at.y = cross(at.z, at.x);
	let view = normalize(scene.eye - at.position);
	at.wo = normalize(vec3(dot(view, at.x), dot(view, at.y), max(dot(view, at.z), 1e-3)));
	at.alpha = max(vec2(tangent.w, normal.w), vec2(1e-5));
	at.f0 = textureLoad(seen_f0, texel, 0).xyz;
	return at;
}
`;

export const DISPLAY_SHADER = `${ COVERS }${ SCENE }
@group(1) @binding(1) var seen_place: texture_2d<f32>;
@group(1) @binding(2) var left_radiance: texture_2d<f32>;
@group(1) @binding(3) var right_radiance: texture_2d<f32>;

fn false_colour(t: f32) -> vec3<f32> {
	let c = clamp(vec3(2.5 * t - 0.9, 1.0 - abs(2.6 * t - 1.2), 1.0 - 2.6 * abs(t - 0.22)), vec3(0.0), vec3(1.0));
	return mix(vec3(0.02, 0.03, 0.12), c, smoothstep(0.0, 0.15, t));
}

@fragment
fn main(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
	let texel = vec2<i32>(at.xy);
	let coverage = textureLoad(seen_place, texel, 0).w;
	let left = mix(vec3(0.02), textureLoad(left_radiance, texel, 0).xyz * scene.left_weight, coverage);
	let right = mix(vec3(0.02), textureLoad(right_radiance, texel, 0).xyz * scene.right_weight, coverage);
	if (scene.show == 3) {
		let apart = dot(abs(left - right), vec3(1.0 / 3.0));
		return vec4(false_colour(clamp(apart / scene.difference_scale, 0.0, 1.0)), 1.0);
	}
	let is_right = scene.show == 2 || (scene.show == 0 && f32(texel.x) >= scene.split * f32(scene.size));
	let y = vec3(1.0) - exp(-scene.exposure * max(select(left, right, is_right), vec3(0.0)));
	let curved = select(1.055 * pow(max(y, vec3(0.003)), vec3(1.0 / 2.4)) - 0.055, 12.92 * y, y <= vec3(0.0031308));
	return vec4(clamp(curved, vec3(0.0), vec3(1.0)), 1.0);
}`;
