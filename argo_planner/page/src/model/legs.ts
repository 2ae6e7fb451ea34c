/** The way of a mission leg by leg, as the strip shows it, and what limits it. */

import type { AnalysisFound, Mission, PreviewedMission } from "../api/types";

export interface Leg {
  /** number of the way in `preview.ways` */
  readonly way: number;
  readonly task: string;
  /** s, with the action or the wait */
  readonly time: number;
  /** s from the mission's start until it begins */
  readonly start: number;
  /** m */
  readonly distance: number;
  readonly climb: number;
  /** Wh */
  readonly energy: number;
  /** why there is no way; null: there is one */
  readonly problem: string | null;
}

/** The legs of the way that is driven if nothing goes wrong and no condition holds. */
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
    legs.push({ way: number, task: target, time, start, distance, climb, energy, problem: way.problem ?? null });
    start += time;
  });
  return legs;
}

/** At most so many bars: those that follow each other are put together under the name of the first. */
export function gathered(legs: readonly Leg[], most: number): Leg[] {
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

export interface Limited {
  readonly value: number;
  readonly limit: number | null;
  readonly broken: boolean;
}

export function limited(value: number, limit: number | null | undefined): Limited {
  return { value, limit: limit ?? null, broken: typeof limit === "number" && value > limit };
}

/** Whether a leg is under way when the mission's time is up. */
export function isTooLate(leg: Leg, limit: number | null): boolean {
  return limit !== null && leg.start + leg.time > limit;
}

export interface BoundShown {
  readonly kind: "time" | "energy";
  readonly least: number | null;
  readonly most: number | null;
  /** a path on which it takes most */
  readonly path: readonly PathPart[];
  /** whether it may break the limit though the way that is drawn does not */
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

/** What the analysis says of all paths, not only of the one that is drawn. */
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
    // Without a bound, any limit may be broken.
    const broken = limit !== null && (most === null || most > limit);
    shown.push({ kind, least: bounds.least.value, most, path, broken });
  }
  return shown;
}
