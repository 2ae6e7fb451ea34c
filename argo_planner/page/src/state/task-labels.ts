/** Numbers, titles and details of tasks and groups, the same in all parts of the page. */

import { computed, effect } from "@preact/signals-core";

import type { Condition, Group, Pose, Task } from "../api/types";
import { hasOwnName } from "../model/naming";
import { groupKey, ownName, taskKey } from "../model/outline";
import { countSteps, readSteps, type ReadSteps, type StepNumbers } from "../model/step-numbers";
import { floorOf } from "../model/standing-map";
import { t } from "../texts";
import { bound, figure, percent, seconds, tenths, unitText } from "../ui/figures";
import { mission, planId, revision, tasksAfterStart, tasksByName } from "./plan";
import { missionSentences } from "./sentences";
import { checkpointsById, world } from "./world";

/** The steps of the last reading; they tell how to count until the next one. */
let lastSteps: ReadSteps | null = null;
effect(() => {
  if (planId.value === null) lastSteps = null;
});

/** Numbers of the tasks and groups by their keys, as in the mission's script. */
export const stepNumbers = computed<StepNumbers>(() => {
  const [open, read] = [mission.value, missionSentences.value];
  if (open === null) return new Map();
  if (read?.revision === revision.value) return (lastSteps = readSteps(open, read.reading.entries)).numbers;
  return countSteps(open, lastSteps?.unusual ?? new Set());
});

/** Return the number of a task in the mission's script; empty: it has none. */
export function numberOf(task: string): string {
  return stepNumbers.value.get(taskKey(task)) ?? "";
}

/** Return the number and the title of a task, such as `4 valve R18 (#14)`. */
export function taskLabel(name: string): string {
  const task = tasksByName.value.get(name);
  return task === undefined ? name : `${numberOf(name)} ${taskTitle(task)}`.trim();
}

/** Values and labels of the tasks after START, for choices. */
export const laterTaskOptions = computed(() =>
  tasksAfterStart.value.map((name) => ({ value: name, label: taskLabel(name) })),
);

/** Return the number and the name of a group. */
export function groupLabel(name: string): string {
  return `${stepNumbers.value.get(groupKey(name)) ?? ""} ${ownName(name)}`.trim();
}

/** Return the name of a task, or what it does if it has no name of its own. */
export function taskTitle(task: Task): string {
  return hasOwnName(task) ? task.name : action(task);
}

/** Return what a task does that its title does not state: its place, limits and branches. */
export function taskDetail(task: Task): string {
  const texts = t().tasks;
  const { retries, velocity, window, optional, on_failure, failure_target, transitions } = task;
  return [
    hasOwnName(task) ? action(task) : "",
    place(task),
    retries > 0 ? texts.retries(retries) : "",
    velocity ? texts.speed(figure(velocity)) : "",
    optional ? texts.optional : "",
    window && window.earliest > 0 ? texts.notBefore(seconds(window.earliest)) : "",
    window?.latest ? texts.doneBy(seconds(window.latest)) : "",
    ...transitions.filter((one) => one.conditions.length > 0).map((one) =>
      texts.branch(conditionsText(one.conditions, task.object_id), shortTarget(one.target)),
    ),
    onward(task),
    on_failure === "branch" && failure_target ? texts.ifFails(shortTarget(failure_target)) : "",
    on_failure === "return" ? texts.ifFails(texts.toDock) : "",
    on_failure === "abort" ? texts.ifFails(texts.end) : "",
    window?.missed_target ? texts.ifLate(shortTarget(window.missed_target)) : "",
  ]
    .filter((part) => part !== "")
    .join(" · ");
}

/** Return how often a group is repeated. */
export function groupDetail(group: Group): string {
  const texts = t().tasks;
  const parts = [
    group.max_repeat_count > 0 ? texts.times(group.max_repeat_count) : "",
    group.max_repeat_duration > 0 ? texts.during(seconds(group.max_repeat_duration)) : "",
    group.every > 0 ? texts.every(seconds(group.every)) : "",
    group.until.length > 0 ? texts.until(conditionsText(group.until, null)) : "",
  ].filter((part) => part !== "");
  return parts.length > 0 ? parts.join(", ") : texts.endless;
}

function action(task: Task): string {
  const texts = t().tasks;
  switch (task.action) {
    case "MEASURE": {
      const id = task.object_id ?? "?";
      const checkpoint = checkpointsById.value.get(id);
      return checkpoint ? texts.checkpoint(checkpoint.name, id) : texts.unknownCheckpoint(id);
    }
    case "WAIT":
      return waitText(task);
    case "START": {
      const area = task.pose ? dockAt(task.pose) : (mission.value?.start_area ?? null);
      if (area !== null) return texts.startAt(texts.dock(area));
      return task.pose ? texts.startAt(coordinates(task.pose)) : texts.start;
    }
    case "WAYPOINT": {
      const area = task.pose ? dockAt(task.pose) : null;
      if (area !== null) return texts.returns(area);
      const number = /^WAYPOINT (\d+)/.exec(task.name)?.[1];
      return number === undefined ? t().words.action.WAYPOINT : texts.waypoint(number);
    }
  }
}

function waitText({ wait }: Task): string {
  const texts = t().tasks;
  if (typeof wait?.duration === "number") return texts.wait(seconds(wait.duration));
  if (wait?.event) {
    const event = t().words.event[wait.event];
    return texts.waitFor(wait.charge_to ? `${event}, ${texts.charged(percent(wait.charge_to))}` : event);
  }
  return wait && wait.conditions.length > 0
    ? texts.waitUntil(conditionsText(wait.conditions, null))
    : texts.waitUnknown;
}

/** Return where a task takes place, as far as its title does not state it. */
function place(task: Task): string {
  const texts = t().tasks;
  if (task.action === "MEASURE") {
    const checkpoint = checkpointsById.value.get(task.object_id ?? "");
    return checkpoint ? texts.floor(checkpoint.floor) : "";
  }
  if (!task.pose) return "";
  const floor = floorOf(world.value?.floors ?? [], task.pose.z)?.number;
  const named = dockAt(task.pose) !== null || task.action === "START";
  return [named ? "" : coordinates(task.pose), floor === undefined ? "" : texts.floor(floor)]
    .filter((part) => part !== "")
    .join(", ");
}

/** Return where a task leads that ends without a condition elsewhere than at the next task. */
function onward(task: Task): string {
  const texts = t().tasks;
  const tasks = mission.value?.tasks ?? [];
  const next = tasks[tasks.indexOf(task) + 1]?.name;
  const target = task.transitions.find((one) => one.conditions.length === 0)?.target;
  if (target === next || !tasks.includes(task)) return "";
  return texts.onward(target === undefined ? texts.end : shortTarget(target));
}

/** Return the number of a task, or its title if it has none. */
function shortTarget(name: string): string {
  return numberOf(name) || taskLabel(name);
}

/** Return conditions in symbols; those on the reading of `own`, the task's own checkpoint, without its number. */
function conditionsText(conditions: readonly Condition[], own: string | null | undefined): string {
  return conditions.map((one) => conditionText(one, own)).reduce(t().tasks.and);
}

function conditionText(condition: Condition, own: string | null | undefined): string {
  const texts = t().tasks;
  const unit = unitText(checkpointsById.value.get(condition.object_id)?.unit ?? "");
  const subject = condition.object_id === own ? "" : `#${condition.object_id} `;
  const value = (number: number | null | undefined) => `${bound(number)} ${unit}`.trim();
  const { type, inclusive, param1, param2 } = condition;
  switch (type) {
    case "MEASURED_VALUE_LESS":
      return `${subject}${inclusive ? "≤" : "<"} ${value(param1)}`;
    case "MEASURED_VALUE_GREATER":
      return `${subject}${inclusive ? "≥" : ">"} ${value(param1)}`;
    case "MEASURED_VALUE_WITHIN":
      return `${subject}${texts.range(bound(param1), value(param2))}`;
    default:
      return `${subject}${texts.readings[type]}`;
  }
}

function coordinates({ x, y }: Pose): string {
  return `${tenths(x)} / ${tenths(y)}`;
}

/** Return the area whose dock is at a pose. */
function dockAt(pose: Pose): number | null {
  const near = (one: Pose) => Math.hypot(one.x - pose.x, one.y - pose.y, one.z - pose.z) < NEAR_M;
  return world.value?.docks.find((dock) => near(dock.pose))?.area ?? null;
}

const NEAR_M = 0.05;
