/** The shader of a way to light; `null` for the engine's own way. */
export async function textOf( engine, way ) {

	if ( way === 'stock' ) return null;
	return ( await import( `/examples/${ engine }/shaders/${ way === 'table' ? way : `normals_${ way }` }.glsl.js` ) ).default;

}
