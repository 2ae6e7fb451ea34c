/** The state of a run at a time, computed from its entries. */

import type { Entry } from "../api/types";

export type Outcome = "done" | "failed" | "stopped" | "by hand" | "skipped";
export type Control = "autonomous" | "paused" | "supervised" | "ended";
export type Reading = NonNullable<Entry["reading"]>;
type Vector5 = readonly [number, number, number, number, number];

export interface Moment {
  /** s */
  readonly t: number;
  /** x, y, z (m), yaw, pitch (rad) */
  readonly pose: Vector5;
  /** share of the battery, 0 to 1 */
  readonly charge: number | null;
  /** the task whose action was in progress */
  readonly task: string | null;
  /** outcome of the last visit of each task */
  readonly outcomes: ReadonlyMap<string, Outcome>;
  /** the last reading of each checkpoint, in the order of their first readings */
  readonly readings: readonly Reading[];
  /** who had the robot */
  readonly control: Control;
  /** number of entries so far */
  readonly entries: number;
}

/** Return the number of entries up to a time. */
export function countUntil(entries: readonly Entry[], t: number): number {
  let low = 0;
  let high = entries.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((entries[middle] as Entry).t <= t) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Return the state of the run at a time (s); null before its first entry. */
export function momentAt(entries: readonly Entry[], t: number): Moment | null {
  const count = countUntil(entries, t);
  const last = entries[count - 1];
  if (last === undefined) return null;
  const next = entries[count];
  return {
    t: Math.min(t, next?.t ?? last.t),
    pose: next === undefined ? last.pose : between(last.pose, next.pose, (t - last.t) / (next.t - last.t)),
    charge: last.charge ?? null,
    task: next?.running ?? null,
    outcomes: outcomesOf(entries, count),
    readings: readingsOf(entries, count),
    control: controlAfter(entries, count),
    entries: count,
  };
}

/** Return who has the robot after the first `count` entries. */
export function controlAfter(entries: readonly Entry[], count = entries.length): Control {
  if (count === entries.length && entries.at(-1)?.ended) return "ended";
  let control: Control = "autonomous";
  for (let at = 0; at < count; at++)
    for (const { kind } of (entries[at] as Entry).events) {
      if (kind === "take_over") control = "supervised";
      else if (kind === "pause") control = "paused";
      else if (kind === "give_back" || kind === "resume") control = "autonomous";
    }
  return control;
}

/** Return the outcome of each task's last visit in the first `count` entries. */
export function outcomesOf(entries: readonly Entry[], count = entries.length): Map<string, Outcome> {
  const found = new Map<string, Outcome>();
  for (let at = 0; at < count; at++) {
    const entry = entries[at] as Entry;
    if (entry.task) {
      const { task, outcome, by_hand } = entry.task;
      found.set(task, outcome === "done" ? (by_hand ? "by hand" : "done") : outcome === "failed" ? "failed" : "stopped");
    }
    for (const event of entry.events)
      for (const one of event.by_hand ?? []) if (one.skipped) found.set(one.task, "skipped");
  }
  return found;
}

/** Return the last reading of each checkpoint in the first `count` entries. */
export function readingsOf(entries: readonly Entry[], count = entries.length): Reading[] {
  const found = new Map<number, Reading>();
  for (let at = 0; at < count; at++) {
    const reading = (entries[at] as Entry).reading;
    if (reading) found.set(reading.checkpoint, reading);
  }
  return [...found.values()];
}

function between(from: Vector5, to: Vector5, part: number): Vector5 {
  const share = Number.isFinite(part) ? Math.min(1, Math.max(0, part)) : 1;
  const along = (a: number, b: number) => a + (b - a) * share;
  const turn = Math.atan2(Math.sin(to[3] - from[3]), Math.cos(to[3] - from[3]));
  return [
    along(from[0], to[0]),
    along(from[1], to[1]),
    along(from[2], to[2]),
    from[3] + turn * share,
    along(from[4], to[4]),
  ];
}
