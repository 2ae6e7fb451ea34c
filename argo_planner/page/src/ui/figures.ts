/** Numbers as people write them, in the language of the page. */

import { dateLocale, language, t } from "../texts";
import { numberFormat } from "../texts/number-format";

/** Format a number with at most `digits` decimals. */
export function figure(value: number, digits = 2): string {
  return numberFormat(language.value, 0, digits).format(value);
}

/** Format a number with one decimal, so that numbers below each other are alike. */
export function tenths(value: number): string {
  return numberFormat(language.value, 1, 1).format(value);
}

/** Format a limit of a range; null: it has no limit on this side. */
export function bound(value: number | null | undefined): string {
  return value === null || value === undefined ? "∞" : figure(value);
}

/** Format a unit of a checkpoint. */
export function unitText(unit: string): string {
  return unit === "deg" ? "°" : unit;
}

/** Format a share of 1 as a percentage. */
export function percent(part: number, digits = 0): string {
  return `${figure(100 * part, digits)} %`;
}

export function seconds(s: number): string {
  return t().words.seconds(s);
}

/** Format a lower bound of a time (s), rounded down. */
export function leastSeconds(s: number): string {
  return t().words.boundSeconds(s, (value) => Math.floor(value + NOISE * Math.max(1, value)));
}

/** Format an upper bound of a time (s), rounded up. */
export function mostSeconds(s: number): string {
  return t().words.boundSeconds(s, (value) => Math.ceil(value - NOISE * Math.max(1, value)));
}

/** Format bounds of a time (s), as one time if they differ by less than a second; `most` null: without a limit. */
export function timeBounds(least: number, most: number | null): string {
  if (most === null) return t().strip.between(leastSeconds(least), t().strip.noBound);
  return most - least < 1 ? seconds(most) : t().strip.between(leastSeconds(least), mostSeconds(most));
}

/** relative error of sums of floating-point numbers, which is not rounded up or down */
const NOISE = 1e-9;

export function metres(m: number): string {
  return `${figure(m, m < 10 ? 1 : 0)} m`;
}

/** Format a time stamp. */
export function dateAndTime(time: string, dateStyle: "short" | "medium" = "medium", timeStyle: "short" | "medium" = "short") {
  return new Date(time).toLocaleString(dateLocale(), { dateStyle, timeStyle });
}

/** Format the time of day of a moment (ms since 1970). */
export function timeOfDay(moment: number): string {
  return new Date(moment).toLocaleTimeString(dateLocale(), { timeStyle: "medium" });
}

/** Format an energy (Wh) as a share of the battery's capacity, or in Wh if that is unknown. */
export function share(wh: number, battery: number): string {
  return battery > 0 ? percent(wh / battery, wh < battery / 10 ? 1 : 0) : `${figure(wh, 0)} Wh`;
}
