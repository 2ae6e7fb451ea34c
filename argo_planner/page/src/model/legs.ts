/** The legs of the mission's path and their limits, as the strip shows them. */

import type { AnalysisFound, Mission, PreviewedMission, Wording } from "../api/types";

export interface Leg {
  /** index in `preview.ways` */
  readonly way: number;
  readonly task: string;
  /** s, including the action or the wait */
  readonly time: number;
  /** s from the mission's start to the start of the leg */
  readonly start: number;
  /** m */
  readonly distance: number;
  readonly climb: number;
  /** Wh */
  readonly energy: number;
  /** why there is no path; null: there is one */
  readonly problem: Told | null;
}

/** A text of the service with its wording. */
export interface Told {
  readonly text: string;
  readonly wording: Wording | null;
}

/** Return the legs that are driven if nothing goes wrong and no condition holds. */
export function legsOf(preview: PreviewedMission, mission: Mission): Leg[] {
  const waits = new Map(
    mission.tasks.map((task) => [task.name, task.action === "WAIT" ? (task.wait?.duration ?? 0) : 0]),
  );
  const legs: Leg[] = [];
  let start = 0;
  preview.ways.forEach(({ kind, target, way }, number) => {
    if (kind !== "default") return;
    const time = (way.time ?? 0) + (waits.get(target) ?? 0);
    const { distance, climb, energy } = way;
    legs.push({ way: number, task: target, time, start, distance, climb, energy, problem: toldOf(way.problem, way.problem_wording) });
    start += time;
  });
  return legs;
}

function toldOf(text: string | null | undefined, wording: Wording | null | undefined): Told | null {
  return text ? { text, wording: wording ?? null } : null;
}

/** Merge neighbouring legs until at most `most` remain; each has the name of its first leg. */
export function mergedLegs(legs: readonly Leg[], most: number): Leg[] {
  const each = Math.ceil(legs.length / most);
  if (each <= 1) return [...legs];
  const found: Leg[] = [];
  for (let at = 0; at < legs.length; at += each) {
    const part = legs.slice(at, at + each);
    const sum = (of: (leg: Leg) => number) => part.reduce((total, leg) => total + of(leg), 0);
    found.push({
      ...(part[0] as Leg),
      time: sum((leg) => leg.time),
      distance: sum((leg) => leg.distance),
      climb: sum((leg) => leg.climb),
      energy: sum((leg) => leg.energy),
      problem: part.find((leg) => leg.problem !== null)?.problem ?? null,
    });
  }
  return found;
}

export interface LimitedValue {
  readonly value: number;
  readonly limit: number | null;
  readonly broken: boolean;
}

export function withLimit(value: number, limit: number | null | undefined): LimitedValue {
  return { value, limit: limit ?? null, broken: typeof limit === "number" && value > limit };
}

/** Return whether a leg ends after the mission's time limit. */
export function isTooLate(leg: Leg, limit: number | null): boolean {
  return limit !== null && leg.start + leg.time > limit;
}

export interface BoundShown {
  readonly kind: "time" | "energy";
  readonly least: number | null;
  readonly most: number | null;
  /** an execution with the highest value */
  readonly path: readonly PathPart[];
  /** whether an execution may exceed the limit, even if the drawn one does not */
  readonly broken: boolean;
}
export interface PathPart {
  readonly task: string | null;
  readonly group: string | null;
  readonly rounds: number;
  readonly missed: boolean;
  /** s or Wh from the mission's start */
  readonly until: number;
}

/** Return the bounds of the analysis over all executions, not only the drawn one. */
export function boundsOf(found: AnalysisFound | null, limits: { time: number | null; energy: number | null }): BoundShown[] {
  const analysis = found?.analysis;
  if (!analysis) return [];
  const shown: BoundShown[] = [];
  for (const [kind, bounds] of [
    ["time", analysis.duration],
    ["energy", analysis.energy],
  ] as const) {
    if (!bounds) continue;
    const most = bounds.most.value;
    const limit = limits[kind];
    const path = bounds.most.path.map((part) => ({ ...part, task: part.task ?? null, group: part.group ?? null }));
    // Without a bound, any limit may be exceeded.
    const broken = limit !== null && (most === null || most > limit);
    shown.push({ kind, least: bounds.least.value, most, path, broken });
  }
  return shown;
}
