/** Sentences of the canonical script as people read them. */

const QUOTED = /"((?:[^"\\]|\\.)*)"(?:\s*\n\s*"(?:[^"\\]|\\.)*")*/g;
const PIECE = /"(?:[^"\\]|\\.)*"/g;

/** Return a sentence with its quoted texts as they were typed: without escapes, and in one piece each. */
export function shownText(sentence: string): string {
  return sentence.replace(QUOTED, (quoted) => {
    const pieces = quoted.match(PIECE) ?? [];
    try {
      // Halves of a character may lie in two escapes, but not in two pieces.
      return `"${pieces.map((piece) => JSON.parse(piece) as string).join("")}"`;
    } catch {
      return quoted;
    }
  });
}
