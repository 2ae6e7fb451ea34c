/** Curves as SVG paths: best order and bound over time, success rate over the runs. */

export interface Step {
  /** s since the search began */
  readonly time: number;
  /** s that the best order takes; null: none has been found */
  readonly best: number | null;
  /** lower bound (s) on the duration of any order */
  readonly bound: number;
}

export interface Convergence {
  /** SVG path in a drawing of the given size */
  readonly best: string;
  readonly bound: string;
  readonly end: number;
}

/** Return best order and bound as step functions. */
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
  /** 0 to 1; null: no run counts yet */
  readonly value: number | null;
  readonly low: number;
  readonly high: number;
}

export interface RateCurve {
  /** closed SVG path: the interval */
  readonly band: string;
  /** SVG path: the rate */
  readonly rate: string;
}

/** Return rate and interval over the runs from 0 to `most`; the height of the drawing stands for 0 to 1. */
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
