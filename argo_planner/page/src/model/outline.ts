/** The tasks of a mission in their nested groups, as rows of the list. */

import type { EventKind, Group, Mission, Task } from "../api/types";

export interface TaskRow {
  readonly kind: "task";
  readonly key: string;
  readonly task: Task;
  /** Number of groups around it. */
  readonly depth: number;
  /** Name of the innermost group around it. */
  readonly inside: string | null;
}

export interface GroupRow {
  readonly kind: "group";
  readonly key: string;
  readonly group: Group;
  readonly depth: number;
  /** Number of tasks in it, at any depth. */
  readonly count: number;
  /** Name of the group around it. */
  readonly inside: string | null;
}

export type Row = TaskRow | GroupRow;

/** Return the key of a task in a selection. */
export function taskKey(name: string): string {
  return `task:${name}`;
}
export function groupKey(name: string): string {
  return `group:${name}`;
}
export function reactionKey(event: EventKind): string {
  return `reaction:${event}`;
}

/** Return the name in a key. */
export function nameOfKey(key: string): string {
  return key.slice(key.indexOf(":") + 1);
}
export function isTaskKey(key: string): boolean {
  return key.startsWith("task:");
}

/** Return all rows in order, each group before its content. */
export function outline(mission: Mission): Row[] {
  const at = new Map(mission.tasks.map((task, index) => [task.name, index]));
  const starting = new Map<number, { group: Group; last: number }[]>();
  for (const group of mission.groups) {
    const first = at.get(group.start);
    const last = at.get(group.end);
    if (first === undefined || last === undefined || last < first) continue;
    const there = starting.get(first) ?? [];
    there.push({ group, last });
    starting.set(first, there);
  }
  const rows: Row[] = [];
  const open: { name: string; last: number }[] = [];
  const inside = () => open.at(-1)?.name ?? null;
  mission.tasks.forEach((task, index) => {
    const begun = starting.get(index) ?? [];
    begun.sort((a, b) => b.last - a.last || depthOf(a.group) - depthOf(b.group));
    for (const { group, last } of begun) {
      const key = groupKey(group.name);
      const count = last - index + 1;
      rows.push({ kind: "group", key, group, depth: open.length, count, inside: inside() });
      open.push({ name: group.name, last });
    }
    const key = taskKey(task.name);
    rows.push({ kind: "task", key, task, depth: open.length, inside: inside() });
    while (open.at(-1)?.last === index) open.pop();
  });
  return rows;
}

/** Return the rows that are visible if these groups are folded. */
export function visibleRows(rows: readonly Row[], folded: ReadonlySet<string>): Row[] {
  const shown: Row[] = [];
  let below = Infinity;
  for (const row of rows) {
    if (row.depth > below) continue;
    below = Infinity;
    shown.push(row);
    if (row.kind === "group" && folded.has(row.key)) below = row.depth;
  }
  return shown;
}

/** Return the rows that match, each with the groups around it. */
export function matchingRows(rows: readonly Row[], matches: (row: Row) => boolean): Row[] {
  const found = new Set<Row>();
  const open: Row[] = [];
  for (const row of rows) {
    open.length = Math.min(open.length, row.depth);
    if (matches(row)) for (const one of [...open, row]) found.add(one);
    if (row.kind === "group") open.push(row);
  }
  return rows.filter((row) => found.has(row));
}

/** Return the name of a group without the groups around it. */
export function ownName(group: string): string {
  return group.slice(group.lastIndexOf("/") + 1);
}

function depthOf(group: Group): number {
  return group.name.split("/").length;
}
