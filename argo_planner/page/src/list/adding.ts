/** Adding tasks and reactions to the mission, after the selection. */

import type { Action, Mission, Pose, Reaction, Task } from "../api/types";
import { freeName, numberedName, taskNames } from "../model/naming";
import { outline, reactionKey, taskKey } from "../model/outline";
import { positionForNew } from "../model/task-positions";
import { edit, editInTurn, type LooseEdit } from "../state/commands";
import { mission, select, selection } from "../state/plan";
import { t } from "../texts";

interface NewTask {
  readonly action: Action;
  /** The wanted name; if it is taken, a number is added. */
  readonly wanted: string;
  readonly fields: Partial<Task>;
}

/** Add a task after the selection and select it. Returns whether it was added. */
export function addTask(action: Action, wanted: string, fields: Partial<Task>): Promise<boolean> {
  return addNewTask(() => ({ action, wanted, fields }));
}

/** Add a waypoint, or the start if `starts` returns true for the mission. */
export function addPlace(pose: Pose, starts: (open: Mission) => boolean, name?: string): Promise<boolean> {
  return addNewTask((open) => {
    const action = starts(open) ? "START" : "WAYPOINT";
    const wanted = action === "WAYPOINT" && name !== undefined ? name : action;
    return { action, wanted, fields: { pose } };
  });
}

/** Return whether the mission is empty, so that the first pose is the start. */
export function isEmpty(open: Mission): boolean {
  return open.tasks.length === 0;
}

/** Add a start as the first task. If it is the dock of an area, that becomes the start area. */
export function addStart(pose: Pose, area?: number): Promise<boolean> {
  const header = area === undefined ? [] : [{ kind: "set_header", start_area: area, dock: pose } as const];
  return addNewTask(() => ({ action: "START", wanted: "START", fields: { pose } }), header);
}

/** Add a task to the mission in its state when the edit's turn comes, together with further edits. */
function addNewTask(find: (open: Mission) => NewTask, further: readonly LooseEdit[] = []): Promise<boolean> {
  return editInTurn(async (make) => {
    const open = mission.value;
    if (open === null) return false;
    const { action, wanted, fields } = find(open);
    const names = taskNames(open);
    const start = action === "START";
    const numbered = wanted === action && !start;
    const name = numbered ? numberedName(wanted, names) : freeName(wanted, names);
    const where = start ? { first: true } : positionForNew(outline(open), selection.value);
    const done = await make({ kind: "add_task", task: { name, action, ...fields }, ...where }, ...further);
    if (done) select([taskKey(name)]);
    return done;
  });
}

/** Add tasks that measure checkpoints, one after the other, and select them. Returns whether they were added. */
export function addMeasures(ids: readonly string[]): Promise<boolean> {
  return editInTurn(async (make) => {
    const open = mission.value;
    if (open === null || ids.length === 0) return false;
    const { edits, names } = measureEdits(open, selection.value, ids);
    const done = await make(...edits);
    if (done) select(names.map(taskKey));
    return done;
  });
}

/** Return the edits that add tasks which measure checkpoints after the selection, and the names of the tasks. */
export function measureEdits(open: Mission, selected: readonly string[], ids: readonly string[]) {
  const taken = taskNames(open);
  const names: string[] = [];
  const edits: LooseEdit[] = [];
  let where = positionForNew(outline(open), selected);
  for (const id of ids) {
    const name = freeName(`MEASURE ${id}`, taken);
    taken.add(name);
    names.push(name);
    edits.push({ kind: "add_task", task: { name, action: "MEASURE", object_id: id }, ...where });
    where = where.into === undefined ? { after: name } : { after: name, into: where.into };
  }
  return { edits, names };
}

export function addWait(): Promise<boolean> {
  return addTask("WAIT", "WAIT", { wait: { duration: 60, conditions: [] } });
}

/** Add a reaction to the first event without one; another event can be chosen in its form. */
export async function addReaction(): Promise<boolean> {
  const had = new Set(mission.value?.reactions.map((one) => one.event));
  const events = Object.keys(t().words.event) as Reaction["event"][];
  const event = events.find((one) => !had.has(one));
  if (event === undefined) return false;
  const done = await edit({ kind: "add_reaction", reaction: { event, response: "pause" } });
  if (done) select([reactionKey(event)]);
  return done;
}

/** Return whether the mission has no START yet. */
export function lacksStart(open: Mission): boolean {
  return !open.tasks.some((task) => task.action === "START");
}
