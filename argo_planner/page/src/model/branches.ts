/** Transitions that lead elsewhere than to the next row, as lines beside the list. */

import type { Mission } from "../api/types";
import type { Row } from "./outline";

export type BranchKind = "condition" | "failure" | "onward";

/** A line from one row to another, by their indices. */
export interface Branch {
  readonly from: number;
  readonly to: number;
  readonly kind: BranchKind;
  /** Distance from the rows, in lines: lines that overlap have different lanes. */
  readonly lane: number;
}

/** More lines beside each other would leave too little space for the rows. */
export const MOST_LANES = 4;

/** Return the lines of the visible rows; a task in a folded group begins and ends at the group's row.
 *
 * There is none between rows that the same folded group hides, and none to the next task of the mission. */
export function branchesOf(mission: Mission, shown: readonly Row[]): Branch[] {
  const rows = rowsOfTasks(mission, shown);
  const found: Omit<Branch, "lane">[] = [];
  const known = new Set<string>();
  mission.tasks.forEach((task, index) => {
    const from = rows.get(task.name);
    if (from === undefined) return;
    const next = mission.tasks[index + 1]?.name;
    const add = (target: string, kind: BranchKind) => {
      const to = rows.get(target);
      const key = `${from} ${to ?? ""} ${kind}`;
      if (to === undefined || to === from || known.has(key)) return;
      known.add(key);
      found.push({ from, to, kind });
    };
    for (const { target, conditions } of task.transitions) {
      if (conditions.length > 0) add(target, "condition");
      else if (target !== next) add(target, "onward");
    }
    if (task.on_failure === "branch" && task.failure_target) add(task.failure_target, "failure");
    if (task.window?.missed_target) add(task.window.missed_target, "failure");
  });
  return inLanes(found);
}

/** Return the index of the visible row of each task. */
function rowsOfTasks(mission: Mission, shown: readonly Row[]): ReadonlyMap<string, number> {
  const found = new Map<string, number>();
  let row = -1;
  const visible = new Set(shown.flatMap((one) => (one.kind === "task" ? [one.task.name] : [])));
  const groups = new Map<string, number>();
  shown.forEach((one, index) => {
    if (one.kind === "group") groups.set(one.group.start, index);
    else found.set(one.task.name, index);
  });
  for (const { name } of mission.tasks) {
    row = groups.get(name) ?? row; // the innermost visible group that begins here
    if (!visible.has(name) && row >= 0) found.set(name, row);
  }
  return found;
}

/** Give each line the nearest lane that is free between its ends. */
function inLanes(lines: readonly Omit<Branch, "lane">[]): Branch[] {
  const length = ({ from, to }: Omit<Branch, "lane">) => Math.abs(to - from);
  const lanes: (readonly [number, number])[][] = Array.from({ length: MOST_LANES }, () => []);
  return [...lines]
    .sort((a, b) => length(a) - length(b))
    .map((line) => {
      const [top, bottom] = [Math.min(line.from, line.to), Math.max(line.from, line.to)];
      const isFree = (lane: readonly (readonly [number, number])[]) =>
        lane.every(([first, last]) => bottom < first || top > last);
      const free = lanes.findIndex(isFree);
      const lane = free < 0 ? MOST_LANES - 1 : free;
      lanes[lane]?.push([top, bottom]);
      return { ...line, lane };
    });
}
