/** Where a message points to. */

import type { Diagnostic } from "../api/types";
import { language, t } from ".";

const PLACE = /^(?:(?:page|paragraph|table|row|line|lines|column|text box|footnote|headings|to) ?\d*(?:, | |$))+$/;
const GERMAN: Readonly<Record<string, string>> = {
  page: "Seite",
  paragraph: "Absatz",
  table: "Tabelle",
  row: "Zeile",
  line: "Zeile",
  lines: "Zeilen",
  column: "Spalte",
  "text box": "Textfeld",
  footnote: "Fußnote",
  headings: "Überschriften",
  to: "bis",
};

/** Return a place in a document in the language of the page: `table 1, row 3`, but not cells such as `Round!B7`. */
export function spokenPlace(place: string): string {
  if (language.value !== "de" || !PLACE.test(place)) return place;
  return place.replace(/text box|[a-z]+/g, (word) => GERMAN[word] ?? word);
}

/** Return the place of a message before its text: a cell or page of a document, or a line; empty without one. */
export function placeBefore(message: Diagnostic): string {
  if (message.place) return `${spokenPlace(message.place)}: `;
  return message.span ? `${t().frame.line(message.span.line)}: ` : "";
}
