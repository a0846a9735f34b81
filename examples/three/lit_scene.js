// The scene of the examples in three.js.

import * as THREE from 'three';

import { glowOf, meshOf } from '../common/mesh.js';
import { axesOf, surfaces } from '../common/scene.js';
import { setAlphas } from './alphas.js';

function geometryOf( { positions, normals, tangents, indices } ) {

	const geometry = new THREE.BufferGeometry();
	geometry.setIndex( indices );
	geometry.setAttribute( 'position', new THREE.Float32BufferAttribute( positions, 3 ) );
	geometry.setAttribute( 'normal', new THREE.Float32BufferAttribute( normals, 3 ) );
	// three takes the direction of the anisotropy from the tangents.
	geometry.setAttribute( 'tangent', new THREE.Float32BufferAttribute( tangents, 4 ) );
	return geometry;

}

/** A light of three, which emits along -z. */
function lightOf( lamp ) {

	const light = new THREE.RectAreaLight( new THREE.Color( ...lamp.radiance ), 1, lamp.width, lamp.height );
	const [ x, y, z ] = axesOf( lamp ).map( ( axis ) => new THREE.Vector3( ...axis ) );
	light.setRotationFromMatrix( new THREE.Matrix4().makeBasis( x.negate(), y, z.negate() ) );
	light.position.set( ...lamp.centre );
	return light;

}

/**
 * @param {Object[]} lamps - Lights as in scene.js.
 * @param {function(THREE.Material): THREE.Material} patch - Patches the material of a surface.
 * @param {{ Material?: function, shown?: Object[], picture?: THREE.Texture }} [of] - The class of materials, the surfaces, and the picture on lights.
 */
export function litScene( lamps, patch, { Material = THREE.MeshPhysicalMaterial, shown = surfaces, picture = null } = {} ) {

	const scene = new THREE.Scene();
	for ( const surface of shown ) {

		// three takes the f0 of metal from the colour. Plastic without diffuse light is metal of a dark colour.
		const material = new Material( { metalness: 1, color: new THREE.Color( ...surface.f0 ) } );
		setAlphas( material, ...surface.alpha );
		scene.add( new THREE.Mesh( geometryOf( meshOf( surface ) ), patch( material ) ) );

	}

	for ( const lamp of lamps ) {

		scene.add( lightOf( lamp ) );
		const glow = geometryOf( glowOf( lamp ) );
		glow.setAttribute( 'uv', new THREE.Float32BufferAttribute( [ 0, 0, 1, 0, 1, 1, 0, 1 ], 2 ) );
		scene.add( new THREE.Mesh( glow, new THREE.MeshBasicMaterial( { color: new THREE.Color( ...lamp.radiance ), map: picture } ) ) );

	}

	return scene;

}
