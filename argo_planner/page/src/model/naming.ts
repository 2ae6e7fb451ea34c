/** Names for what is new in a mission. */

import type { Mission } from "../api/types";

/** The wanted name, with a number where it is taken: `DOCK`, `DOCK (2)`, or as it is `numbered`. */
export function freeName(
  wanted: string,
  taken: ReadonlySet<string>,
  numbered = (number: number) => `${wanted} (${number})`,
): string {
  let name = wanted;
  for (let number = 2; taken.has(name); number++) name = numbered(number);
  return name;
}

/** The first of `WAYPOINT 1`, `WAYPOINT 2` and so on that is free. */
export function numberedName(word: string, taken: ReadonlySet<string>): string {
  const numbered = (number: number) => `${word} ${number}`;
  return freeName(numbered(1), taken, numbered);
}

/** Names of the tasks of a mission. */
export function taskNames(mission: Mission): Set<string> {
  return new Set(mission.tasks.map((task) => task.name));
}
