/** Changes of a mission that the service reports, applied to the page's copy. */

import type { Group, Mission, MissionChange, Reaction, Task } from "../api/types";

type Item = Task | Group | Reaction;

interface ListChange<T extends Item> {
  readonly put: readonly T[];
  readonly gone: readonly string[];
  readonly placed: readonly (readonly [string, string | null])[];
}

/** Return the mission after a change. */
export function applyChange(mission: Mission, change: MissionChange): Mission {
  const header = { ...change.header };
  delete (header as { kind?: string }).kind;
  return {
    ...mission,
    ...(header as Partial<Mission>),
    tasks: listAfter(mission.tasks, change.tasks as ListChange<Task> | null, nameOfItem),
    groups: listAfter(mission.groups, change.groups as ListChange<Group> | null, nameOfItem),
    reactions: listAfter(
      mission.reactions,
      change.reactions as ListChange<Reaction> | null,
      (reaction) => reaction.event,
    ),
  };
}

/** Return the names of tasks and groups, and the events of reactions, that a change affects. */
export function changedNames(change: MissionChange): ReadonlySet<string> {
  const found = new Set<string>();
  for (const list of [change.tasks, change.groups, change.reactions]) {
    if (!list) continue;
    for (const item of list.put) found.add("event" in item ? item.event : item.name);
    for (const name of list.gone) found.add(name);
    for (const [name] of list.placed) found.add(name);
  }
  return found;
}

/** Return the header fields that a change sets. */
export function changedHeaderFields(change: MissionChange): ReadonlySet<string> {
  return new Set(Object.keys(change.header ?? {}).filter((field) => field !== "kind"));
}

function nameOfItem(item: Task | Group): string {
  return item.name;
}

function listAfter<T extends Item>(
  before: readonly T[],
  change: ListChange<T> | null | undefined,
  name: (item: T) => string,
): readonly T[] {
  if (!change) return before;
  const items = new Map(before.map((item) => [name(item), item]));
  for (const item of change.put) items.set(name(item), item);
  if (change.placed.length === 0 && change.gone.length === 0)
    return before.map((item) => items.get(name(item)) as T);
  const away = new Set([...change.gone, ...change.placed.map(([one]) => one)]);
  const behind = successors(before.map(name).filter((one) => !away.has(one)));
  for (const [one, other] of change.placed) {
    behind.set(one, behind.get(other));
    behind.set(other, one);
  }
  const after: T[] = [];
  for (let one = behind.get(null); one !== undefined; one = behind.get(one))
    after.push(items.get(one) as T);
  return after;
}

/** Return the successor of each name; null stands for the beginning of the list. */
function successors(names: readonly string[]): Map<string | null, string | undefined> {
  const behind = new Map<string | null, string | undefined>();
  let last: string | null = null;
  for (const one of names) {
    behind.set(last, one);
    last = one;
  }
  behind.set(last, undefined);
  return behind;
}
