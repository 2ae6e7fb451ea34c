/** Names for what is new in a mission. */

import type { Mission } from "../api/types";

/** The wanted name, with a number where it is taken: `DOCK`, `DOCK (2)`. */
export function freeName(wanted: string, taken: ReadonlySet<string>): string {
  let name = wanted;
  for (let number = 2; taken.has(name); number++) name = `${wanted} (${number})`;
  return name;
}

/** The first of `WAYPOINT 1`, `WAYPOINT 2` and so on that is free. */
export function numberedName(word: string, taken: ReadonlySet<string>): string {
  let number = 1;
  while (taken.has(`${word} ${number}`)) number++;
  return `${word} ${number}`;
}

/** Names of the tasks of a mission. */
export function taskNames(mission: Mission): Set<string> {
  return new Set(mission.tasks.map((task) => task.name));
}
