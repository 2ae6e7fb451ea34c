/** The rows of the list: all of them, those that show as groups are folded, and choosing of them. */

import { computed, signal } from "@preact/signals-core";

import { outline, unfolded, type Row } from "../model/outline";
import { mission, select, selection } from "../state/plan";

/** Keys of the groups that are folded. */
export const folded = signal<ReadonlySet<string>>(new Set());

export const allRows = computed<readonly Row[]>(() =>
  mission.value === null ? [] : outline(mission.value),
);
export const shownRows = computed<readonly Row[]>(() => unfolded(allRows.value, folded.value));

/** Folds a group, or unfolds it. */
export function fold(row: Row, closed: boolean): void {
  const keys = new Set(folded.value);
  if (closed) keys.add(row.key);
  else keys.delete(row.key);
  folded.value = keys;
}

/** Unfolds all groups that a row lies in. */
export function unfoldAround(key: string): void {
  const row = allRows.value.find((one) => one.key === key);
  if (!row) return;
  const around = new Set<string>();
  for (const one of allRows.value)
    if (one.kind === "group" && `${row.inside ?? ""}/`.startsWith(`${one.group.name}/`))
      around.add(one.key);
  folded.value = new Set([...folded.value].filter((one) => !around.has(one)));
}

/** The row that was selected last, among those that show. */
export function rowOf(key: string | undefined): Row | undefined {
  return shownRows.value.find((row) => row.key === key);
}

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
