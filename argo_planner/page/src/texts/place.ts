/** Where a message points to. */

import type { Diagnostic } from "../api/types";
import { t } from ".";

/** Return the place of a message before its text: a cell or page of a document, or a line; empty without one. */
export function placeBefore(message: Diagnostic): string {
  if (message.place) return `${message.place}: `;
  return message.span ? `${t().frame.line(message.span.line)}: ` : "";
}
