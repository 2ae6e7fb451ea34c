/** The colours of paths: by time, and for highlighted ones. Dashed paths and the compared route have colours
 * of the theme, chosen in `scene/paths-view.ts`. */

type Colour = readonly [number, number, number];

/** From early to late; distinguishable without red and green. */
const RAMP: readonly Colour[] = [
  [40, 120, 215],
  [128, 84, 205],
  [208, 66, 140],
  [240, 120, 40],
];

/** Return a colour (sRGB, 0 to 255 each) for a `share` of the mission's time from 0 to 1. */
export function timeColour(share: number): Colour {
  const at = Math.min(1, Math.max(0, share)) * (RAMP.length - 1);
  const first = Math.min(RAMP.length - 2, Math.floor(at));
  const [from, to] = [RAMP[first] as Colour, RAMP[first + 1] as Colour];
  const mixed = (i: 0 | 1 | 2) => Math.round(from[i] + (to[i] - from[i]) * (at - first));
  return [mixed(0), mixed(1), mixed(2)];
}

/** Return the colour of a highlighted path in the dark or light theme. */
export function markedColour(dark: boolean): string {
  return dark ? "#ffffff" : "#0b1016";
}
