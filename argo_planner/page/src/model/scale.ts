/** A value on the scale of its instrument, for a drawing from 0 to 1. */

export interface Scale {
  readonly low: number;
  readonly high: number;
}

/** The scale that is drawn: the instrument's, or where that is unknown one with room for all. */
export function drawnScale(range: Scale | null, nominal: Scale, value: number): Scale {
  if (range !== null && range.high > range.low) return range;
  const [low, high] = [Math.min(nominal.low, value), Math.max(nominal.high, value)];
  const room = Math.max(high - low, 1e-9) / 4;
  return { low: low - room, high: high + room };
}

/** Where a value lies on a scale, from 0 to 1; beyond its ends at them. */
export function placeOn(scale: Scale, value: number): number {
  return Math.min(1, Math.max(0, (value - scale.low) / (scale.high - scale.low)));
}
