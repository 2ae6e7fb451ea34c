/** Comparison of two runs of a mission, also of different revisions of it. */

import type { Entry, Fault, Mission, Noticed, RunState, WorldCheckpoint } from "../api/types";
import { outcomesOf, type Outcome } from "./replay";

/** What the report of a run states in addition to its entries. */
export interface RunReport {
  readonly mission: Mission;
  readonly faults: readonly Fault[];
  readonly waits: readonly { readonly task: string; readonly start: number; readonly end: number }[];
}

export interface FinishedRun {
  readonly state: RunState;
  readonly entries: readonly Entry[];
  /** null: the run has no report, so tasks that it has not reached are unknown */
  readonly report: RunReport | null;
}

/** What came of measuring at a checkpoint, or why there is nothing. */
export type Measured =
  | {
      readonly kind: "read";
      readonly value: number;
      readonly normal: boolean;
      /** s */
      readonly t: number;
      readonly task: string;
      readonly byHand: boolean;
    }
  | { readonly kind: "unreadable" | "unreachable" | "failed"; readonly t: number; readonly task: string }
  | { readonly kind: NoReading };
/** `no more`: the run has fewer measurements there; `absent`: its revision of the mission has no such task. */
export type NoReading = "stopped" | "skipped" | "not reached" | "no more" | "absent" | "unknown";

type Pair<Value> = readonly [first: Value, second: Value];

export interface ReadingRow {
  readonly checkpoint: string;
  readonly name: string;
  readonly unit: string;
  readonly nominal: { readonly low: number | null; readonly high: number | null } | null;
  /** number of the measurement at this checkpoint, from 1, and how many there are */
  readonly number: number;
  readonly count: number;
  readonly runs: Pair<Measured>;
  /** second value minus first one; null: one of them is missing */
  readonly difference: number | null;
  readonly differs: boolean;
}

/** Sum of a task's visits. */
export interface TaskSum {
  readonly visits: number;
  /** s */
  readonly duration: number;
  /** m */
  readonly distance: number;
  /** m */
  readonly climbed: number;
  readonly outcome: Outcome | null;
}

export interface TaskRow {
  readonly name: string;
  readonly runs: Pair<TaskSum | "skipped" | "not reached" | "absent" | "unknown">;
  /** Whether the two revisions have different actions or checkpoints under this name. */
  readonly redefined: boolean;
  readonly differs: boolean;
}

export interface NoticedRow {
  readonly runs: Pair<Noticed | null>;
  readonly differs: boolean;
}

/** Figures of a whole run. */
export interface RunSum {
  /** s */
  readonly duration: number;
  /** m */
  readonly distance: number;
  /** m */
  readonly climbed: number;
  /** share of the battery, 0 to 1; null: unknown */
  readonly charge: number | null;
  readonly done: number;
  /** number of tasks of the mission; null: unknown */
  readonly tasks: number | null;
  readonly readings: number;
  readonly abnormal: number;
}

type Known = ReadonlyMap<string, Pick<WorldCheckpoint, "name" | "unit" | "nominal">>;

/** Return the figures of a run. */
export function runSum({ state, entries, report }: FinishedRun): RunSum {
  const last = entries.at(-1);
  const readings = entries.flatMap((entry) => entry.reading ?? []);
  const tasks = report?.mission.tasks.filter((task) => task.action !== "START") ?? null;
  const outcomes = outcomesOf(entries);
  const isDone = (name: string) => ["done", "by hand"].includes(outcomes.get(name) ?? "") || waited(report, name);
  return {
    duration: state.t,
    distance: last?.distance ?? 0,
    climbed: last?.climbed ?? 0,
    charge: last?.charge ?? null,
    done: tasks?.filter((task) => isDone(task.name)).length ?? [...outcomes.keys()].filter(isDone).length,
    tasks: tasks?.length ?? null,
    readings: readings.length,
    abnormal: readings.filter((reading) => !reading.normal).length,
  };
}

function waited(report: RunReport | null, name: string): boolean {
  return report?.waits.some((wait) => wait.task === name) ?? false;
}

/** Return a row for each measurement: the first one of a run stands beside the first one of the other run, and so on. */
export function compareReadings(first: FinishedRun, second: FinishedRun, known: Known): ReadingRow[] {
  const both = [first, second].map(measurements) as [Measurements, Measurements];
  const ids = [...new Set(both.flatMap((one) => [...one.made.keys(), ...one.planned]))];
  return ids
    .sort((a, b) => Number(a) - Number(b) || a.localeCompare(b))
    .flatMap((id) => {
      const lists = both.map((one) => one.made.get(id) ?? []) as [Measured[], Measured[]];
      const count = Math.max(1, lists[0].length, lists[1].length);
      const { name = "", unit = "", nominal = null } = known.get(id) ?? nameIn(id, first, second) ?? {};
      return Array.from({ length: count }, (_, at): ReadingRow => {
        const runs = lists.map((list, run) => list[at] ?? nothingRead(both[run] as Measurements, id, list.length)) as [
          Measured,
          Measured,
        ];
        const [a, b] = runs;
        const difference = a.kind === "read" && b.kind === "read" ? b.value - a.value : null;
        const differs = a.kind !== b.kind || (a.kind === "read" && b.kind === "read" && (difference !== 0 || a.normal !== b.normal));
        return { checkpoint: id, name, unit, nominal, number: at + 1, count, runs, difference, differs };
      });
    });
}

interface Measurements {
  /** by the id of the checkpoint, in the order of time */
  readonly made: ReadonlyMap<string, Measured[]>;
  /** checkpoints that the mission measures */
  readonly planned: readonly string[];
  readonly hasMission: boolean;
  readonly skipped: ReadonlySet<string>;
  readonly stopped: ReadonlySet<string>;
}

/** Return what a run has measured. */
export function measurements({ entries, report }: FinishedRun): Measurements {
  const made = new Map<string, Measured[]>();
  const add = (id: string, one: Measured) => made.set(id, [...(made.get(id) ?? []), one]);
  const stopped = new Set<string>();
  const skippedTasks = new Set<string>();
  for (const { t, reading, task, events } of entries) {
    for (const event of events) for (const one of event.by_hand ?? []) if (one.skipped) skippedTasks.add(one.task);
    if (reading) {
      const { value, normal } = reading;
      const byHand = task?.by_hand ?? false;
      add(String(reading.checkpoint), { kind: "read", value, normal, t: reading.t, task: reading.task, byHand });
    } else if (task?.action === "MEASURE" && task.object_id) {
      const failure = events.find((event) => event.kind === "failed");
      const kind = failure?.unreadable ? "unreadable" : failure?.unreachable ? "unreachable" : "failed";
      if (task.outcome === "failed") add(task.object_id, { kind, t, task: task.task });
      else if (task.outcome !== "done") stopped.add(task.object_id);
    }
  }
  const measuring = (report?.mission.tasks ?? []).filter((task) => task.action === "MEASURE" && task.object_id);
  const idsOf = (tasks: typeof measuring) => tasks.map((task) => task.object_id as string);
  return {
    made,
    planned: [...new Set(idsOf(measuring))],
    hasMission: report !== null,
    skipped: new Set(idsOf(measuring.filter((task) => skippedTasks.has(task.name)))),
    stopped,
  };
}

function nothingRead(run: Measurements, id: string, made: number): Measured {
  if (made > 0) return { kind: "no more" };
  if (run.skipped.has(id)) return { kind: "skipped" };
  if (run.stopped.has(id)) return { kind: "stopped" };
  if (!run.hasMission) return { kind: "unknown" };
  return { kind: run.planned.includes(id) ? "not reached" : "absent" };
}

function nameIn(id: string, ...runs: readonly FinishedRun[]) {
  for (const { entries } of runs)
    for (const { reading } of entries) if (reading && String(reading.checkpoint) === id) return reading;
  return undefined;
}

/** Return a row for each task: those of the first run's mission in their order, then those that only the second has. */
export function compareTasks(first: FinishedRun, second: FinishedRun): TaskRow[] {
  const runs = [first, second] as const;
  const sums = runs.map(taskSums) as [Map<string, TaskSum>, Map<string, TaskSum>];
  const planned = runs.map(({ report }) => new Map(report?.mission.tasks.map((task) => [task.name, task])));
  const names = new Set([...planned.flatMap((one) => [...one.keys()]), ...sums.flatMap((one) => [...one.keys()])]);
  const isStart = (name: string) =>
    planned.some((one) => one.get(name)?.action === "START") && sums.every((one) => !one.has(name));
  return [...names]
    .filter((name) => !isStart(name))
    .map((name) => {
      const [a, b] = planned.map((one) => one.get(name));
      const redefined = a !== undefined && b !== undefined && (a.action !== b.action || a.object_id !== b.object_id);
      const both = runs.map((run, at) => sums[at]?.get(name) ?? notVisited(run, name)) as unknown as TaskRow["runs"];
      return { name, runs: both, redefined, differs: redefined || tasksDiffer(both) };
    });
}

function taskSums({ entries, report }: FinishedRun): Map<string, TaskSum> {
  const outcomes = outcomesOf(entries);
  const found = new Map<string, TaskSum>();
  const add = (name: string, duration: number, distance: number, climbed: number) => {
    const was = found.get(name) ?? { visits: 0, duration: 0, distance: 0, climbed: 0 };
    found.set(name, {
      visits: was.visits + 1,
      duration: was.duration + duration,
      distance: was.distance + distance,
      climbed: was.climbed + climbed,
      outcome: outcomes.get(name) ?? null,
    });
  };
  for (const { task } of entries) if (task) add(task.task, task.end - task.start, task.distance, task.climbed);
  for (const { task, start, end } of report?.waits ?? []) add(task, end - start, 0, 0);
  return found;
}

function notVisited({ entries, report }: FinishedRun, name: string): "skipped" | "not reached" | "absent" | "unknown" {
  if (outcomesOf(entries).get(name) === "skipped") return "skipped";
  if (report === null) return "unknown";
  return report.mission.tasks.some((task) => task.name === name) ? "not reached" : "absent";
}

function tasksDiffer([a, b]: TaskRow["runs"]): boolean {
  if (typeof a === "string" || typeof b === "string") return a !== b;
  return (
    a.visits !== b.visits ||
    a.outcome !== b.outcome ||
    isApart(a.duration, b.duration) ||
    isApart(a.distance, b.distance) ||
    isApart(a.climbed, b.climbed)
  );
}

/** Return whether two times (s) or lengths (m) differ as they are shown, with one decimal. */
export function isApart(a: number, b: number): boolean {
  return Math.round(10 * a) !== Math.round(10 * b);
}

/** Return what was noticed in two runs: equal things side by side, then in the order of time. */
export function compareNoticed(first: readonly Noticed[], second: readonly Noticed[]): NoticedRow[] {
  const left = [...second];
  const rows = first.map((one): NoticedRow => {
    const at = left.findIndex((other) => keyOf(other) === keyOf(one));
    const other = at < 0 ? null : (left.splice(at, 1)[0] ?? null);
    return { runs: [one, other], differs: other === null || one.answered !== other.answered || one.response !== other.response };
  });
  const rest = left.map((other): NoticedRow => ({ runs: [null, other], differs: true }));
  const time = ({ runs: [a, b] }: NoticedRow) => a?.t ?? b?.t ?? Infinity;
  return [...rows, ...rest].sort((a, b) => time(a) - time(b));
}

function keyOf({ kind, event, checkpoint, task, link, element, trouble }: Noticed): string {
  return JSON.stringify([kind, event, checkpoint, task, link, element, trouble]);
}
