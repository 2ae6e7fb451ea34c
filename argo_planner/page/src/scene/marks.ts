/** Clickable marks of the site and the mission in the scene. */

import { computed, signal } from "@preact/signals-core";
import { Vector3 } from "three";

import type { Obstacle, Pose, Task, World, WorldCheckpoint } from "../api/types";
import { floorNumber, poseOfTask } from "../model/floor-drawing";
import { taskKey } from "../model/outline";
import { markPoint } from "../model/faults";
import { mission, planId, select, selection } from "../state/plan";
import { faultsOf, shownFaultList, type FaultList } from "../state/faults";
import { preview } from "../state/preview";
import { type ShownRun, shownRun } from "../state/run";
import { numberOf, taskTitle } from "../state/task-labels";
import { world } from "../state/world";
import { t } from "../texts";
import { faultText } from "../texts/fault-names";
import { figure, unitText } from "../ui/figures";

export type Subject =
  | { readonly kind: "checkpoint"; readonly checkpoint: WorldCheckpoint }
  | { readonly kind: "task"; readonly task: Task; readonly pose: Pose }
  | { readonly kind: "place"; readonly name: string; readonly pose: Pose; readonly dock: number | null }
  | { readonly kind: "obstacle"; readonly obstacle: Obstacle }
  | { readonly kind: "fault"; readonly list: FaultList; readonly index: number };

export interface Mark {
  readonly key: string;
  readonly subject: Subject;
  readonly at: Vector3;
  readonly floor: number;
  readonly text: string;
  /** Numbers of the tasks, as in the list and in the script. */
  readonly numbers: string;
  /** The last reading there. */
  readonly value: string;
  readonly tone: "plain" | "planned" | "chosen" | "good" | "bad" | "active" | "dim";
  readonly weight: number;
  /** Keys of the tasks that the mark stands for. */
  readonly tasks: readonly string[];
}

/** Key of the mark whose card is open. */
export const openMark = signal<string | null>(null);

const RAISED = 0.12;

/** The tasks that measure a checkpoint and their numbers, by its id. */
export const measuring = computed(() => {
  const found = new Map<string, { readonly numbers: string[]; readonly tasks: Task[] }>();
  mission.value?.tasks.forEach((task) => {
    if (task.action !== "MEASURE" || task.object_id === null || task.object_id === undefined) return;
    const there = found.get(task.object_id) ?? { numbers: [], tasks: [] };
    there.numbers.push(numberOf(task.name));
    there.tasks.push(task);
    found.set(task.object_id, there);
  });
  return found;
});

/** The shown run, if it belongs to this mission. */
const runOfMission = computed(() => {
  const now = shownRun.value;
  return now !== null && now.plan === planId.value ? now : null;
});
/** Readings as text, so that marks are made again when a reading changes, and not with each pose. */
const runReadings = computed(() => runOfMission.value?.readings);
const readingsText = computed(() => JSON.stringify(runReadings.value ?? []));
const readings = computed(() => {
  const all = JSON.parse(readingsText.value) as ShownRun["readings"];
  return new Map(all.map((one) => [one.checkpoint, one]));
});
const active = computed(() => runOfMission.value?.task ?? null);

export const marks = computed<readonly Mark[]>(() => {
  const site = world.value;
  if (site === null) return [];
  return [
    ...site.checkpoints.map((one) => checkpointMark(one)),
    ...taskMarks(site),
    ...placeMarks(site),
    ...site.obstacles.map((one) => obstacleMark(site, one)),
    ...faultMarks(site),
  ];
});

function checkpointMark(checkpoint: WorldCheckpoint): Mark {
  const there = measuring.value.get(String(checkpoint.id));
  const keys = there?.tasks.map((task) => taskKey(task.name)) ?? [];
  const key = `checkpoint:${checkpoint.id}`;
  const reading = readings.value.get(checkpoint.id);
  const chosen = openMark.value === key || keys.some((one) => selection.value.includes(one));
  const isActive = there?.tasks.some((task) => task.name === active.value) ?? false;
  const planned = keys.length > 0;
  return {
    key,
    subject: { kind: "checkpoint", checkpoint },
    at: new Vector3(...checkpoint.position),
    floor: checkpoint.floor,
    text: t().tasks.checkpoint(checkpoint.name, String(checkpoint.id)),
    numbers: shortList(there?.numbers ?? []),
    value: reading ? `${figure(reading.value)} ${unitText(reading.unit)}` : "",
    tone: isActive
      ? "active"
      : chosen
        ? "chosen"
        : reading
          ? reading.normal
            ? "good"
            : "bad"
          : planned
            ? "planned"
            : "plain",
    weight: isActive ? 9 : chosen ? 8 : reading ? 6 : planned ? 5 : 1,
    tasks: keys,
  };
}

/** Return the default fields of a mark at a pose, raised by `raised` m. */
function fieldsAtPose(site: World, { x, y, z }: Pose, raised = RAISED) {
  const floor = floorNumber(site.floors, z);
  return { at: new Vector3(x, y, z + raised), floor, numbers: "", value: "", tasks: [] };
}

function taskMarks(site: World): Mark[] {
  const found: Mark[] = [];
  mission.value?.tasks.forEach((task) => {
    const pose = poseOf(task, site);
    if (pose === null || task.action === "MEASURE") return;
    const key = taskKey(task.name);
    const chosen = selection.value.includes(key);
    const isActive = active.value === task.name;
    found.push({
      ...fieldsAtPose(site, pose),
      key,
      subject: { kind: "task", task, pose },
      text: task.action === "START" ? t().tasks.start : taskTitle(task),
      numbers: numberOf(task.name),
      tone: isActive ? "active" : chosen ? "chosen" : "planned",
      weight: isActive ? 9 : chosen ? 8 : 5,
      tasks: [key],
    });
  });
  return found;
}

/** Return the pose of a task of the open mission. */
export function poseOf(task: Task, site: World): Pose | null {
  return mission.value && poseOfTask(task, mission.value, site);
}

function placeMarks(site: World): Mark[] {
  const mark = (name: string, pose: Pose, dock: number | null): Mark => ({
    ...fieldsAtPose(site, pose),
    key: dock === null ? `place:${name}` : `dock:${dock}`,
    subject: { kind: "place", name, pose, dock },
    text: name,
    tone: openMark.value === (dock === null ? `place:${name}` : `dock:${dock}`) ? "chosen" : "dim",
    weight: 2,
  });
  return [
    ...site.docks.map((dock) => mark(t().scene.dock(dock.area), dock.pose, dock.area)),
    ...site.places.map((place) => mark(place.name, place.pose, null)),
  ];
}

function obstacleMark(site: World, obstacle: Obstacle): Mark {
  const { pose, size } = obstacle;
  const key = `obstacle:${obstacle.id}`;
  return {
    ...fieldsAtPose(site, pose, size[2]),
    key,
    subject: { kind: "obstacle", obstacle },
    text: obstacle.name === "" ? t().scene.obstacle : obstacle.name,
    tone: openMark.value === key ? "chosen" : "bad",
    weight: 3,
  };
}

/** Return a mark for each fault of the open panel whose place is known. */
function faultMarks(site: World): Mark[] {
  const list = shownFaultList.value;
  if (list === null) return [];
  return faultsOf(list).flatMap((fault, index) => {
    const point = markPoint(fault, site);
    if (point === null) return [];
    const [x, y, z] = point;
    const key = `fault:${index}`;
    const mark: Mark = {
      ...fieldsAtPose(site, { x, y, z, yaw: 0 }),
      key,
      subject: { kind: "fault", list, index },
      text: `⚠ ${faultText(fault.kind)}`,
      tone: openMark.value === key ? "chosen" : "bad",
      weight: 7,
    };
    return [mark];
  });
}

/** Select the task that a path leads to. */
export function selectTaskOfPath(way: number, add: boolean): void {
  const target = preview.value?.ways[way]?.target;
  if (target === undefined) return;
  const key = taskKey(target);
  const others = selection.value.filter((one) => one !== key);
  openMark.value = null;
  select(add ? (others.length < selection.value.length ? others : [...others, key]) : [key]);
}

function shortList(numbers: readonly string[]): string {
  return numbers.length > 3 ? `${numbers.slice(0, 2).join(", ")} …` : numbers.join(", ");
}

