/** Numbers of the tasks and groups, as the steps of the mission's script have them. */

import type { Mission, MissionReading } from "../api/types";
import { groupKey, taskKey } from "./outline";

/** Numbers by the keys of tasks and groups. A task without one is a part of another step. */
export type StepNumbers = ReadonlyMap<string, string>;

export interface ReadSteps {
  readonly numbers: StepNumbers;
  /** Keys of the groups that are one step with all their tasks, and of the tasks that no step states. */
  readonly unusual: ReadonlySet<string>;
}

/** Return the steps of a mission's script, as its reading by the service states them. */
export function readSteps(mission: Mission, entries: MissionReading["entries"]): ReadSteps {
  const stated = new Map<string, number>();
  for (const { part, name, step } of entries) {
    if (typeof step !== "number") continue;
    if (part === "task") stated.set(taskKey(name), step);
    if (part === "round") stated.set(groupKey(name), step);
  }
  const unusual = new Set<string>();
  const without = mission.tasks.filter((task) => !stated.has(taskKey(task.name))).map((task) => task.name);
  const patrolled = new Set<string>();
  const at = positions(mission);
  for (const group of mission.groups) {
    const key = groupKey(group.name);
    const inside = mission.tasks.slice(at.get(group.start), (at.get(group.end) ?? -1) + 1);
    if (!stated.has(key) || inside.length === 0 || inside.some((task) => stated.has(taskKey(task.name)))) continue;
    unusual.add(key);
    for (const task of inside) patrolled.add(task.name);
  }
  for (const name of without) if (!patrolled.has(name)) unusual.add(taskKey(name));
  const numbers = new Map(countSteps(mission, unusual));
  for (const [key, step] of stated) numbers.set(key, String(step));
  return { numbers, unusual };
}

/** Return the steps by counting: tasks in order, and a group after its last task, as a script repeats steps.
 *
 * A group in `unusual` is one step, and its tasks are parts of it, such as 2.1 and 2.2; a task in it has no number. */
export function countSteps(mission: Mission, unusual: ReadonlySet<string>): StepNumbers {
  const numbers = new Map<string, string>();
  const at = positions(mission);
  const patrols = new Map(
    mission.groups.filter(({ name }) => unusual.has(groupKey(name))).map((group) => [group.start, group]),
  );
  let step = 0;
  let part = 0;
  let last = -1; // index of the last task of the step that is a group
  let ended = 0;
  mission.tasks.forEach((task, index) => {
    const patrol = patrols.get(task.name);
    if (patrol !== undefined) {
      numbers.set(groupKey(patrol.name), String(++step));
      part = 0;
      last = at.get(patrol.end) ?? -1;
    }
    const key = taskKey(task.name);
    if (index <= last) numbers.set(key, `${step}.${++part}`);
    else if (!unusual.has(key)) numbers.set(key, String(++step));
    for (; ended < mission.groups.length; ended++) {
      const group = mission.groups[ended];
      if (group === undefined || (at.get(group.end) ?? -1) > index) break;
      if (!numbers.has(groupKey(group.name))) numbers.set(groupKey(group.name), String(++step));
    }
  });
  return numbers;
}

/** Return numbers in ascending order; `4.10` comes after `4.9`. */
export function sortedNumbers(numbers: readonly string[]): string[] {
  return [...numbers].sort((a, b) => a.localeCompare(b, "en", { numeric: true }));
}

/** Format ascending numbers as `1–3, 4.1, 4.2, 5`. */
export function numbersText(numbers: readonly string[]): string {
  const parts: [string, string][] = [];
  for (const number of numbers) {
    const last = parts.at(-1);
    if (last && number === following(last[1])) last[1] = number;
    else parts.push([number, number]);
  }
  return parts
    .map(([from, to]) => (from === to ? from : `${from}${to === following(from) ? ", " : "–"}${to}`))
    .join(", ");
}

/** Return the next number: 5 after 4, and 4.2 after 4.1. */
function following(number: string): string {
  const last = number.lastIndexOf(".") + 1;
  return `${number.slice(0, last)}${Number(number.slice(last)) + 1}`;
}

function positions(mission: Mission): ReadonlyMap<string, number> {
  return new Map(mission.tasks.map((task, index) => [task.name, index]));
}
