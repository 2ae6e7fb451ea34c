/** The rows of the list: all of them, the visible ones, and their selection. */

import { computed, effect, signal, untracked } from "@preact/signals-core";

import { matchingRows, outline, visibleRows, type Row } from "../model/outline";
import { dependOn } from "../state/depend-on";
import { renamedKeys, renames } from "../state/identity";
import { mission, planId, select, selection } from "../state/plan";
import { groupDetail, stepNumbers, taskDetail, taskTitle } from "../state/task-labels";

/** Keys of the folded groups. */
export const folded = signal<ReadonlySet<string>>(new Set());

/** Words that the shown rows contain; empty: all are shown. */
export const filter = signal("");

/** Key of the row from which Shift extends the selection. */
let anchor: string | null = null;

effect(() => {
  const renamed = renames.value;
  untracked(() => (folded.value = new Set(renamedKeys(folded.value, renamed))));
});

effect(() => {
  dependOn(planId);
  folded.value = new Set();
  filter.value = "";
  anchor = null;
});

export const allRows = computed<readonly Row[]>(() =>
  mission.value === null ? [] : outline(mission.value),
);
/** The visible rows. While the list is filtered, folded groups show what matches in them. */
export const shownRows = computed<readonly Row[]>(() => {
  const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
  if (words.length === 0) return visibleRows(allRows.value, folded.value);
  return matchingRows(allRows.value, (row) => {
    const text = textOf(row).toLowerCase();
    return words.every((word) => text.includes(word));
  });
});

/** Return what a row shows, and its name. */
function textOf(row: Row): string {
  const number = stepNumbers.value.get(row.key) ?? "";
  if (row.kind === "group") return `${number} ${row.group.name} ${groupDetail(row.group)}`;
  return `${number} ${taskTitle(row.task)} ${row.task.name} ${taskDetail(row.task)}`;
}

/** Fold a group, or unfold it. */
export function setFolded(row: Row, closed: boolean): void {
  const keys = new Set(folded.value);
  if (closed) keys.add(row.key);
  else keys.delete(row.key);
  folded.value = keys;
}

/** Unfold all groups around a row. */
export function unfoldAround(key: string): void {
  const row = allRows.value.find((one) => one.key === key);
  if (!row) return;
  const around = new Set<string>();
  for (const one of allRows.value)
    if (one.kind === "group" && `${row.inside ?? ""}/`.startsWith(`${one.group.name}/`))
      around.add(one.key);
  folded.value = new Set([...folded.value].filter((one) => !around.has(one)));
}

/** Return the visible row with a key. */
export function rowOf(key: string | undefined): Row | undefined {
  return shownRows.value.find((row) => row.key === key);
}

/** Select a row; with `extend` all rows from the anchor to it, with `toggle` in addition to the selection. */
export function chooseRow(row: Row, extend: boolean, toggle: boolean): void {
  const shown = shownRows.value;
  const chosen = selection.value;
  if (anchor === null || !chosen.includes(anchor)) anchor = chosen.at(-1) ?? null;
  if (extend && anchor !== null) {
    const to = shown.indexOf(row);
    const from = shown.findIndex((one) => one.key === anchor);
    if (from < 0) return select([row.key]); // the anchor is folded away
    const between = shown.slice(Math.min(from, to), Math.max(from, to) + 1).map((one) => one.key);
    select([...between.filter((key) => key !== row.key), row.key]);
    return;
  }
  anchor = row.key;
  if (!toggle) select([row.key]);
  else if (chosen.includes(row.key)) select(chosen.filter((key) => key !== row.key));
  else select([...chosen, row.key]);
}
