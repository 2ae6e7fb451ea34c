/** Which tasks, groups and reactions of a mission got other names by a change. */

import type { Group, Mission, Reaction, Task } from "../api/types";
import { groupKey, reactionKey, taskKey } from "./outline";

/** Return the new key of each thing that was renamed, by its old key.
 *
 * A change states no renames. A task was renamed if a task with a new name stands in its place and does the same;
 * a group, if one with a new name has its first and last task; a reaction, if one to another event stands in its
 * place. */
export function renamesBetween(before: Mission, after: Mission): ReadonlyMap<string, string> {
  const tasks = renamedTasks(before.tasks, after.tasks);
  const found = new Map<string, string>();
  for (const [old, name] of tasks) found.set(taskKey(old), taskKey(name));
  for (const [old, name] of renamedGroups(before.groups, after.groups, tasks)) found.set(groupKey(old), groupKey(name));
  for (const [old, event] of renamedReactions(before.reactions, after.reactions))
    found.set(reactionKey(old), reactionKey(event));
  return found;
}

function renamedTasks(before: readonly Task[], after: readonly Task[]): Map<string, string> {
  const had = new Set(before.map((task) => task.name));
  const has = new Set(after.map((task) => task.name));
  const found = new Map<string, string>();
  if (before.length !== after.length) return found;
  before.forEach((old, at) => {
    const now = after[at] as Task;
    if (!has.has(old.name) && !had.has(now.name) && workOf(old) === workOf(now)) found.set(old.name, now.name);
  });
  return found;
}

/** Return what a task does, without the names in it. */
function workOf({ action, object_id, pose, wait, velocity, retries }: Task): string {
  return JSON.stringify([action, object_id, pose, wait?.duration, wait?.event, velocity, retries]);
}

function renamedGroups(
  before: readonly Group[],
  after: readonly Group[],
  tasks: ReadonlyMap<string, string>,
): Map<string, string> {
  const had = new Set(before.map((group) => group.name));
  const has = new Set(after.map((group) => group.name));
  const depth = ({ name }: Group) => name.split("/").length;
  const added = new Map(
    after
      .filter((group) => !had.has(group.name))
      .map((group) => [JSON.stringify([depth(group), group.start, group.end]), group.name]),
  );
  const found = new Map<string, string>();
  for (const group of before) {
    if (has.has(group.name)) continue;
    const [start, end] = [group.start, group.end].map((name) => tasks.get(name) ?? name);
    const name = added.get(JSON.stringify([depth(group), start, end]));
    if (name !== undefined) found.set(group.name, name);
  }
  return found;
}

function renamedReactions(
  before: readonly Reaction[],
  after: readonly Reaction[],
): Map<Reaction["event"], Reaction["event"]> {
  const had = new Set(before.map((reaction) => reaction.event));
  const has = new Set(after.map((reaction) => reaction.event));
  const found = new Map<Reaction["event"], Reaction["event"]>();
  if (before.length !== after.length) return found;
  before.forEach(({ event }, at) => {
    const now = (after[at] as Reaction).event;
    if (!has.has(event) && !had.has(now)) found.set(event, now);
  });
  return found;
}
