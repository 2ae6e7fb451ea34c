/**
 * The colours of paths: by the time at which they are driven, and where one stands out. Dashed ways
 * and the route that is compared have colours of the theme, chosen in `scene/paths-view.ts`.
 */

type Colour = readonly [number, number, number];

/** From early to late: told apart without red and green. */
const RAMP: readonly Colour[] = [
  [40, 120, 215],
  [128, 84, 205],
  [208, 66, 140],
  [240, 120, 40],
];

/** sRGB, 0 to 255 each; `share` of the mission's time from 0 to 1. */
export function timeColour(share: number): Colour {
  const at = Math.min(1, Math.max(0, share)) * (RAMP.length - 1);
  const first = Math.min(RAMP.length - 2, Math.floor(at));
  const [from, to] = [RAMP[first] as Colour, RAMP[first + 1] as Colour];
  const mixed = (i: 0 | 1 | 2) => Math.round(from[i] + (to[i] - from[i]) * (at - first));
  return [mixed(0), mixed(1), mixed(2)];
}

/** The colour of a path that stands out, on the page in its dark or light theme. */
export function markedColour(dark: boolean): string {
  return dark ? "#ffffff" : "#0b1016";
}
