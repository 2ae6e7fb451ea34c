/** Tasks that are copied, and what pasting them does. */

import type { Mission, Task } from "../api/types";
import type { LooseEdit } from "../state/commands";
import { freeName, taskNames } from "./naming";
import type { Place } from "./places";

const KIND = "argo-tasks";

/** Tasks as text for the clipboard. */
export function copied(tasks: readonly Task[]): string {
  return JSON.stringify({ kind: KIND, tasks });
}

/** The tasks of a text from the clipboard; null if it is something else. */
export function readCopied(text: string): readonly Task[] | null {
  try {
    const found = JSON.parse(text) as { kind?: unknown; tasks?: unknown };
    return found.kind === KIND && Array.isArray(found.tasks) ? (found.tasks as Task[]) : null;
  } catch {
    return null;
  }
}

/** Edits that put copies of tasks at a place, under free names. Ways on conditions are kept where
 * they lead to a task that was copied too, or that the mission has. */
export function pasting(
  mission: Mission,
  tasks: readonly Task[],
  place: Place,
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
  for (const task of pasted) {
    const name = renamed.get(task.name) ?? task.name;
    names.push(name);
    const { window, failure_target } = task;
    const failure = failure_target ? target(failure_target) : null;
    edits.push({ kind: "add_task", task: alone(task, name), ...where });
    const missed = window?.missed_target ? target(window.missed_target) : null;
    const later = {
      ...(window ? { window: { ...window, missed_target: missed } } : {}),
      ...(task.on_failure === "branch" && failure !== null
        ? { on_failure: "branch" as const, failure_target: failure }
        : {}),
    };
    if (Object.keys(later).length > 0) ways.push({ kind: "change_task", name, ...later });
    task.transitions
      .filter((way) => way.conditions.length > 0 && target(way.target) !== null)
      .forEach((way, at) => {
        const transition = { target: target(way.target), conditions: way.conditions };
        ways.push({ kind: "add_transition", task: name, transition, at });
      });
    where = where.into === undefined ? { after: name } : { after: name, into: where.into };
  }
  return { edits: [...edits, ...ways], names };
}

/** The task under a name, without what names others. */
function alone(task: Task, name: string): Task {
  const on_failure = task.on_failure === "branch" ? "continue" : task.on_failure;
  const others = { transitions: [], group: "", source: null, window: null, failure_target: null };
  return { ...task, ...others, name, on_failure };
}
