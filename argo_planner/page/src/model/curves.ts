/** Curves as lines of a drawing: the best order and the bound over time, and a rate run by run. */

export interface Step {
  /** s since the search began */
  readonly time: number;
  /** s that the best order takes; null: there is none yet */
  readonly best: number | null;
  /** s less than which no order takes */
  readonly bound: number;
}

export interface Convergence {
  /** points of a path in a drawing of the given size */
  readonly best: string;
  readonly bound: string;
  readonly end: number;
}

/** Both as steps: each holds until the next one. */
export function convergence(steps: readonly Step[], width: number, height: number): Convergence | null {
  const last = steps.at(-1);
  if (last === undefined) return null;
  const end = Math.max(last.time, 1e-3);
  const bests = steps.flatMap((step) => step.best ?? []);
  const all = [...bests, ...steps.map((step) => step.bound).filter((bound) => bound > 0)];
  let low = Math.min(...all, ...(all.length === 0 ? [0] : []));
  let high = Math.max(...all, ...(all.length === 0 ? [1] : []));
  const room = Math.max((high - low) / 10, high / 100, 1e-9);
  low -= room;
  high += room;
  const x = (time: number) => round((width * time) / end);
  const y = (value: number) => round(height - (height * (Math.min(high, Math.max(low, value)) - low)) / (high - low));
  const line = (of: (step: Step) => number | null): string => {
    let path = "";
    let height: number | null = null;
    for (const step of steps) {
      const value = of(step);
      if (value === null) continue;
      const next = y(value);
      path += height === null ? `M${x(step.time)} ${next}` : `H${x(step.time)}V${next}`;
      height = next;
    }
    return height === null ? "" : `${path}H${x(end)}`;
  };
  return { best: line((step) => step.best), bound: line((step) => step.bound), end };
}

export interface RatePoint {
  readonly runs: number;
  /** 0 to 1; null: no run counts */
  readonly value: number | null;
  readonly low: number;
  readonly high: number;
}

export interface RateCurve {
  /** points of a closed path: the interval */
  readonly band: string;
  /** points of a path: the rate */
  readonly rate: string;
}

/** Both in a drawing of the given size, from the first run to the last of `most`; the whole height is 0 to 1. */
export function rateCurve(points: readonly RatePoint[], most: number, width: number, height: number): RateCurve | null {
  const known = points.filter((one): one is RatePoint & { readonly value: number } => one.value !== null);
  const first = known[0];
  if (first === undefined || most <= 0) return null;
  const at = (runs: number, share: number) =>
    `${round((width * Math.min(runs, most)) / most)} ${round(height * (1 - share))}`;
  const line = (share: (one: (typeof known)[number]) => number, of = known) =>
    of.map((one) => at(one.runs, share(one))).join("L");
  const back = line((one) => one.low, known.slice().reverse());
  return {
    band: `M${line((one) => one.high)}L${back}Z`,
    rate: `M${line((one) => one.value)}`,
  };
}

function round(value: number): number {
  return Math.round(100 * value) / 100;
}
