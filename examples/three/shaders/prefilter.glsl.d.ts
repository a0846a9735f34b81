/** The text of a shader, as `ltcforge shader` prints it. */
declare const text: string;
export default text;
