/** Copying of tasks and groups, and the edits that paste them. */

import type { Group, Mission, Task } from "../api/types";
import type { LooseEdit } from "../state/commands";
import { freeName, taskNames } from "./naming";
import { ownName } from "./outline";
import type { TaskPosition } from "./task-positions";

const KIND = "argo-tasks";

/** Copied tasks in their order, and their groups, the outer ones first. */
export interface CopiedTasks {
  readonly tasks: readonly Task[];
  readonly groups: readonly Group[];
}

/** Return the copied tasks and groups as text for the clipboard. */
export function copiedText({ tasks, groups }: CopiedTasks): string {
  return JSON.stringify({ kind: KIND, tasks, groups });
}

/** Parse a text from the clipboard; null: it contains no tasks. */
export function parseCopied(text: string): CopiedTasks | null {
  try {
    const found = JSON.parse(text) as { kind?: unknown; tasks?: unknown; groups?: unknown };
    if (found.kind !== KIND || !Array.isArray(found.tasks) || !Array.isArray(found.groups)) return null;
    return { tasks: found.tasks as Task[], groups: found.groups as Group[] };
  } catch {
    return null;
  }
}

/** Return the edits that paste copies under free names at a position. Transitions between copied tasks are
 * kept; conditional ones also if they lead to a task that the mission has. */
export function pasteEdits(
  mission: Mission,
  { tasks, groups }: CopiedTasks,
  place: TaskPosition,
): { readonly edits: LooseEdit[]; readonly names: readonly string[] } {
  const taken = taskNames(mission);
  const had = new Set(taken);
  const renamed = new Map<string, string>();
  const pasted = tasks.filter(
    (task) => task.action !== "START" || !mission.tasks.some((one) => one.action === "START"),
  );
  for (const task of pasted) {
    const name = freeName(task.name, taken);
    taken.add(name);
    renamed.set(task.name, name);
  }
  const target = (name: string) => renamed.get(name) ?? (had.has(name) ? name : null);
  const edits: LooseEdit[] = [];
  const ways: LooseEdit[] = [];
  let where = place;
  const names: string[] = [];
  for (const [at, task] of pasted.entries()) {
    const name = renamed.get(task.name) ?? task.name;
    names.push(name);
    const { window, failure_target } = task;
    const failure = failure_target ? target(failure_target) : null;
    edits.push({ kind: "add_task", task: detachedTask(task, name), ...where });
    const missed = window?.missed_target ? target(window.missed_target) : null;
    const later = {
      ...(window ? { window: { ...window, missed_target: missed } } : {}),
      ...(task.on_failure === "branch" && failure !== null
        ? { on_failure: "branch" as const, failure_target: failure }
        : {}),
    };
    if (Object.keys(later).length > 0) ways.push({ kind: "change_task", name, ...later });
    const conditional = task.transitions.filter((way) => way.conditions.length > 0 && target(way.target) !== null);
    const further = task.transitions.find((way) => way.conditions.length === 0)?.target ?? "";
    const onward = renamed.get(further);
    if (onward !== undefined && further !== pasted[at + 1]?.name) {
      const transitions = [...conditional, { target: further, conditions: [] }].map((way) => ({
        target: target(way.target),
        conditions: way.conditions,
      }));
      ways.push({ kind: "set_transitions", task: name, transitions });
    } else
      conditional.forEach((way, number) => {
        const transition = { target: target(way.target), conditions: way.conditions };
        ways.push({ kind: "add_transition", task: name, transition, at: number });
      });
    where = where.into === undefined ? { after: name } : { after: name, into: where.into };
  }
  return { edits: [...edits, ...ways, ...groupEdits(mission, { tasks, groups }, renamed)], names };
}

/** Return the edits that group the copies, the inner groups first: a group's full name depends on the group
 * around it. */
function groupEdits(mission: Mission, { tasks, groups }: CopiedTasks, renamed: ReadonlyMap<string, string>): LooseEdit[] {
  const taken = new Set(mission.groups.map((group) => ownName(group.name)));
  const at = (name: string) => tasks.findIndex((task) => task.name === name);
  const edits: LooseEdit[] = [];
  for (const group of [...groups].reverse()) {
    const members = tasks.slice(at(group.start), at(group.end) + 1).flatMap((task) => renamed.get(task.name) ?? []);
    const [start, end] = [members[0], members.at(-1)];
    if (start === undefined || end === undefined) continue;
    const name = freeName(ownName(group.name), taken);
    taken.add(name);
    edits.push({ kind: "wrap_tasks", group: { ...group, name, start, end, source: null } });
  }
  return edits;
}

/** Return the task under another name, without references to other tasks. */
function detachedTask(task: Task, name: string): Task {
  const on_failure = task.on_failure === "branch" ? "continue" : task.on_failure;
  const others = { transitions: [], group: "", source: null, window: null, failure_target: null };
  return { ...task, ...others, name, on_failure };
}
