/** A rate and its interval as they close in, run by run, as lines of a drawing. */

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
