// Keeps the last dropped scene in the browser, so that a reload shows it again. Links do not contain files.

let last = null;

/** The result of a request to the browser's database. */
const done = ( request ) => new Promise( ( resolve, reject ) => Object.assign( request, { onsuccess: () => resolve( request.result ), onerror: () => reject( request.error ) } ) );

async function files( mode ) {
	const request = indexedDB.open( 'ltcforge', 1 );
	request.onupgradeneeded = () => request.result.createObjectStore( 'files' );
	return ( await done( request ) ).transaction( 'files', mode ).objectStore( 'files' );
}

/** Holds a file until a reload. */
export const hold = ( file ) => last = file;

/** Keeps a file. Without a database, for example in a private window, the file is kept until a reload. */
export async function keep( file ) {
	last = file;
	await files( 'readwrite' ).then( ( store ) => done( store.put( file, 'scene' ) ) ).catch( () => {} );
}

/** The file that was kept last, or null. */
export async function kept() {
	return last ??= await files( 'readonly' ).then( ( store ) => done( store.get( 'scene' ) ) ).catch( () => null ) ?? null;
}
