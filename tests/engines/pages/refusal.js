/** The message of the error that `work` throws, or `null` if it throws no error. */
export function refusal( work ) {

	try {

		work();

	} catch ( error ) {

		return `${ error.name }: ${ error.message }`;

	}

	return null;

}
