/** A value on the scale of its instrument, drawn from 0 to 1. */

export interface Scale {
  readonly low: number;
  readonly high: number;
}

/** Return the instrument's scale, or one with room for all values if it is unknown. */
export function drawnScale(range: Scale | null, nominal: Scale, value: number): Scale {
  if (range !== null && range.high > range.low) return range;
  const [low, high] = [Math.min(nominal.low, value), Math.max(nominal.high, value)];
  const room = Math.max(high - low, 1e-9) / 4;
  return { low: low - room, high: high + room };
}

/** Return the position of a value on a scale, limited to 0 to 1. */
export function shareOfScale(scale: Scale, value: number): number {
  return Math.min(1, Math.max(0, (value - scale.low) / (scale.high - scale.low)));
}
