/** What is added to the mission, behind what is selected. */

import type { Action, Mission, Pose, Reaction, Task } from "../api/types";
import { freeName, numberedName, taskNames } from "../model/naming";
import { outline, reactionKey, taskKey } from "../model/outline";
import { placeForNew } from "../model/places";
import { edit, inTurn, type LooseEdit } from "../state/commands";
import { mission, select, selection } from "../state/plan";
import { t } from "../texts";

interface NewTask {
  readonly action: Action;
  /** What it is to be called; another name is taken where there is such a task. */
  readonly wanted: string;
  readonly fields: Partial<Task>;
}

/** Adds a task behind what is selected, and selects it. Whether it was added. */
export function addTask(action: Action, wanted: string, fields: Partial<Task>): Promise<boolean> {
  return added(() => ({ action, wanted, fields }));
}

/** Adds a waypoint, or the start where `starts` says so of the mission. */
export function addPlace(pose: Pose, starts: (open: Mission) => boolean, name?: string): Promise<boolean> {
  return added((open) => {
    const action = starts(open) ? "START" : "WAYPOINT";
    const wanted = action === "WAYPOINT" && name !== undefined ? name : action;
    return { action, wanted, fields: { pose } };
  });
}

/** Whether nothing is planned yet, so that the first place is where the robot starts. */
export function isEmpty(open: Mission): boolean {
  return open.tasks.length === 0;
}

/** Adds a start, first of all; at a dock of a starting area the mission begins in that. */
export function addStart(pose: Pose, area?: number): Promise<boolean> {
  const header = area === undefined ? [] : [{ kind: "set_header", start_area: area, dock: pose } as const];
  return added(() => ({ action: "START", wanted: "START", fields: { pose } }), header);
}

/** Adds what is to be added to the mission as it is when its turn comes, and edits it further. */
function added(find: (open: Mission) => NewTask, further: readonly LooseEdit[] = []): Promise<boolean> {
  return inTurn(async (make) => {
    const open = mission.value;
    if (open === null) return false;
    const { action, wanted, fields } = find(open);
    const names = taskNames(open);
    const start = action === "START";
    const numbered = wanted === action && !start;
    const name = numbered ? numberedName(wanted, names) : freeName(wanted, names);
    const where = start ? { first: true } : placeForNew(outline(open), selection.value);
    const done = await make({ kind: "add_task", task: { name, action, ...fields }, ...where }, ...further);
    if (done) select([taskKey(name)]);
    return done;
  });
}

/** Adds the measuring of a checkpoint. */
export function addMeasure(id: string): Promise<boolean> {
  return addTask("MEASURE", `MEASURE ${id}`, { object_id: id });
}

export function addWait(): Promise<boolean> {
  return addTask("WAIT", "WAIT", { wait: { duration: 60, conditions: [] } });
}

/** Adds a reaction to the first event that has none yet; its form is for choosing another one. */
export async function addReaction(): Promise<boolean> {
  const had = new Set(mission.value?.reactions.map((one) => one.event));
  const events = Object.keys(t().words.event) as Reaction["event"][];
  const event = events.find((one) => !had.has(one));
  if (event === undefined) return false;
  const done = await edit({ kind: "add_reaction", reaction: { event, response: "pause" } });
  if (done) select([reactionKey(event)]);
  return done;
}

/** Whether the mission has no START yet. */
export function lacksStart(open: Mission): boolean {
  return !open.tasks.some((task) => task.action === "START");
}
