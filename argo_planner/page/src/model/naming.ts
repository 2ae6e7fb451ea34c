/** Names of tasks and groups. */

import type { Mission, Task } from "../api/types";

/** Return the wanted name, or a numbered one if it is taken: `DOCK`, `DOCK (2)`, or the form that `numbered`
 * returns. */
export function freeName(
  wanted: string,
  taken: ReadonlySet<string>,
  numbered = (number: number) => `${wanted} (${number})`,
): string {
  let name = wanted;
  for (let number = 2; taken.has(name); number++) name = numbered(number);
  return name;
}

/** Return the first free name of `WAYPOINT 1`, `WAYPOINT 2` and so on. */
export function numberedName(word: string, taken: ReadonlySet<string>): string {
  const numbered = (number: number) => `${word} ${number}`;
  return freeName(numbered(1), taken, numbered);
}

/** Return the names of the mission's tasks. */
export function taskNames(mission: Mission): Set<string> {
  return new Set(mission.tasks.map((task) => task.name));
}

const NUMBERED = /^(WAYPOINT|WAIT) \d+$/;

/** Return whether a task has a name of its own, and not one that its action and its number make, as `MEASURE 14`. */
export function hasOwnName({ name, action, object_id }: Task): boolean {
  const plain = name.replace(/ \(\d+\)$/, "");
  if (action === "MEASURE") return plain !== `MEASURE ${object_id ?? ""}`;
  if (action === "START") return plain !== "START";
  return plain !== "DOCK" && plain !== action && !NUMBERED.test(plain);
}
