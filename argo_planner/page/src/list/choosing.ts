/** Choosing rows: one, several, or all from one to another. */

import type { Row } from "../model/outline";
import { select, selection } from "../state/plan";
import { shownRows } from "./rows";

/** Where Shift extends the selection from. */
let anchor: string | null = null;

/** Selects a row; with all between it and where one began, or beside what is selected. */
export function choose(row: Row, extend: boolean, toggle: boolean): void {
  const shown = shownRows.value;
  const chosen = selection.value;
  if (anchor === null || !chosen.includes(anchor)) anchor = chosen.at(-1) ?? null;
  if (extend && anchor !== null) {
    const to = shown.indexOf(row);
    const from = shown.findIndex((one) => one.key === anchor);
    if (from < 0) return select([row.key]); // it is folded away
    const between = shown.slice(Math.min(from, to), Math.max(from, to) + 1).map((one) => one.key);
    select([...between.filter((key) => key !== row.key), row.key]);
    return;
  }
  anchor = row.key;
  if (!toggle) select([row.key]);
  else if (chosen.includes(row.key)) select(chosen.filter((key) => key !== row.key));
  else select([...chosen, row.key]);
}
