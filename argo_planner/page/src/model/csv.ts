/** Tables as text that spreadsheets and programs read (CSV, RFC 4180). */

export type Cell = string | number | null;

/** First characters of a text that a spreadsheet takes for a formula. */
const FORMULA = /^[=+\-@\t\r]/;

/** Return rows as CSV, the first row with the names of the columns. Numbers have a decimal point in every language.
 * A text that looks like a formula gets an apostrophe in front: names come from people, and must not be executed. */
export function csv(rows: readonly (readonly Cell[])[]): string {
  return rows.map((row) => `${row.map(cellText).join(",")}\r\n`).join("");
}

function cellText(cell: Cell): string {
  if (cell === null) return "";
  if (typeof cell === "number") return String(cell);
  const text = FORMULA.test(cell) ? `'${cell}` : cell;
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
