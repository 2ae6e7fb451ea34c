/** Numbers as people write them, in the language of the page. */

import { dateLocale, language, t } from "../texts";

/** A number with at most so many digits behind the point. */
export function figure(value: number, digits = 2): string {
  return value.toLocaleString(language.value, { maximumFractionDigits: digits });
}

/** A part of 1. */
export function percent(part: number, digits = 0): string {
  return `${figure(100 * part, digits)} %`;
}

export function seconds(s: number): string {
  return t().words.seconds(s);
}

export function metres(m: number): string {
  return `${figure(m, m < 10 ? 1 : 0)} m`;
}

/** When something was, with seconds where it is told apart from what was just before. */
export function dateAndTime(time: string, dateStyle: "short" | "medium" = "medium", timeStyle: "short" | "medium" = "short") {
  return new Date(time).toLocaleString(dateLocale(), { dateStyle, timeStyle });
}

/** Wh as a share of what the battery gives, which says more; of an unknown battery as they are. */
export function share(wh: number, battery: number): string {
  return battery > 0 ? percent(wh / battery, wh < battery / 10 ? 1 : 0) : `${figure(wh, 0)} Wh`;
}
