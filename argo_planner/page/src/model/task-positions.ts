/** Positions of tasks in the list, and the edits that move tasks there. */

import type { Group, Mission, Task } from "../api/types";
import type { LooseEdit } from "../state/commands";
import { isTaskKey, nameOfKey, ownName, type Row } from "./outline";

/** A position in the list: after or before a task, in a group or in none. */
export interface TaskPosition {
  readonly after?: string;
  readonly before?: string;
  readonly into?: string;
}

export type Side = "before" | "after" | "into";

/** Return the position beside a row; `into` means the beginning of a group. */
export function positionBeside(row: Row, side: Side): TaskPosition {
  const container = row.inside === null ? {} : { into: row.inside };
  if (row.kind === "task")
    return side === "before"
      ? { before: row.task.name, ...container }
      : { after: row.task.name, ...container };
  if (side === "into") return { before: row.group.start, into: row.group.name };
  if (side === "before") return { before: row.group.start, ...container };
  return { after: row.group.end, ...container };
}

/** Return the position of a new task: after the last selected row, or at the end of the mission. */
export function positionForNew(rows: readonly Row[], selection: readonly string[]): TaskPosition {
  const last = selection.at(-1);
  const row = rows.find((one) => one.key === last);
  if (!row) return {};
  return positionBeside(row, "after");
}

/** Return the edits that move the selection beside a row; none if nothing changes. */
export function moveEdits(
  mission: Mission,
  rows: readonly Row[],
  selection: readonly string[],
  target: Row,
  side: Side,
): LooseEdit[] {
  const moved = tasksOf(mission, rows, selection);
  if (moved.length === 0 || inSelection(rows, target, selection)) return [];
  let place = anchoredPosition(mission, moved, positionBeside(target, side));
  if (place === null) return [];
  const taken = groupsOf(mission, selection);
  const edits: LooseEdit[] = [];
  // Inner groups are dissolved first and restored first: a group's full name depends on the group around it.
  for (const { name } of [...taken].reverse()) edits.push({ kind: "dissolve_group", name });
  for (const task of moved) {
    edits.push({ kind: "move_task", name: task.name, ...place });
    place = place.into === undefined ? { after: task.name } : { after: task.name, into: place.into };
  }
  for (const group of [...taken].reverse())
    edits.push({ kind: "wrap_tasks", group: { ...group, name: ownName(group.name) } });
  return edits;
}

/** Return all selected tasks, including those of selected groups, in the order of the mission. */
export function tasksOf(
  mission: Mission,
  rows: readonly Row[],
  selection: readonly string[],
): Task[] {
  const chosen = new Set(selection);
  const names = new Set<string>();
  let open = -1;
  for (const row of rows) {
    if (row.depth <= open) open = -1;
    if (open < 0 && row.kind === "group" && chosen.has(row.key)) open = row.depth;
    if (row.kind === "task" && (open >= 0 || chosen.has(row.key))) names.add(row.task.name);
  }
  return mission.tasks.filter((task) => names.has(task.name));
}

/** Return the selected groups and the groups in them, the outer ones first. */
export function groupsOf(mission: Mission, selection: readonly string[]): Group[] {
  return rootGroups(mission, selection).flatMap((group) => withInner(mission, group));
}

/** Return the target of one step up or down, among the visible rows; null: there is none. */
export function stepTarget(
  rows: readonly Row[],
  selection: readonly string[],
  direction: "up" | "down",
): { readonly target: Row; readonly side: Side } | null {
  const chosen = rows.map((row) => inSelection(rows, row, selection));
  const first = chosen.indexOf(true);
  const last = chosen.lastIndexOf(true);
  if (first < 0) return null;
  if (direction === "up") {
    const above = rows[first - 1];
    if (!above) return null;
    const deeper = above.kind === "task" && above.depth > depth(rows, first);
    return { target: above, side: deeper ? "after" : "before" };
  }
  const below = rows[last + 1];
  const end = rows[last];
  if (end && (below === undefined || below.depth < end.depth)) {
    // The last task of a group leaves it.
    const group = rows.find((row) => row.kind === "group" && row.group.name === end.inside);
    const root = chosen[rows.indexOf(group as Row)] === true;
    if (group && !root) return { target: group, side: "after" };
  }
  if (!below) return null;
  const open = depth(rows, last + 2) > below.depth;
  return { target: below, side: below.kind === "group" && open ? "into" : "after" };
}

function depth(rows: readonly Row[], index: number): number {
  return rows[index]?.depth ?? 0;
}

/** Return whether a row or a group around it is selected. */
function inSelection(rows: readonly Row[], row: Row, selection: readonly string[]): boolean {
  if (selection.includes(row.key)) return true;
  if (row.inside === null) return false;
  const around = rows.find((one) => one.kind === "group" && one.group.name === row.inside);
  return around !== undefined && inSelection(rows, around, selection);
}

/** Return the selected groups that are in no other selected group. */
function rootGroups(mission: Mission, selection: readonly string[]): Group[] {
  const names = new Set(selection.filter((key) => !isTaskKey(key)).map(nameOfKey));
  return mission.groups.filter(
    (group) =>
      names.has(group.name) &&
      ![...names].some((other) => other !== group.name && group.name.startsWith(`${other}/`)),
  );
}

/** Return a group and the groups in it, the outer ones first. */
function withInner(mission: Mission, group: Group): Group[] {
  const inner = mission.groups.filter((one) => one.name.startsWith(`${group.name}/`));
  inner.sort((a, b) => a.name.split("/").length - b.name.split("/").length);
  return [group, ...inner];
}

/** Return the position relative to a task that is not moved itself; null: there is none. */
function anchoredPosition(mission: Mission, moved: readonly Task[], place: TaskPosition): TaskPosition | null {
  const names = new Set(moved.map((task) => task.name));
  const anchor = place.after ?? place.before;
  if (anchor === undefined || !names.has(anchor)) return place;
  const at = mission.tasks.findIndex((task) => task.name === anchor);
  const into = place.into === undefined ? {} : { into: place.into };
  for (let index = at + 1; index < mission.tasks.length; index++) {
    const name = mission.tasks[index]?.name;
    if (name !== undefined && !names.has(name)) return { before: name, ...into };
  }
  for (let index = at - 1; index >= 0; index--) {
    const name = mission.tasks[index]?.name;
    if (name !== undefined && !names.has(name)) return { after: name, ...into };
  }
  return null;
}
