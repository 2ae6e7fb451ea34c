/** Display settings of the site. They are stored in the browser. */

import { effect, signal } from "@preact/signals-core";

import { storeSetting, storedSetting } from "../state/session";
import { HIDEABLE, type Hideable } from "./site";

/** Whether the camera moves while the pointer is at an edge. */
export const edgesMove = signal(storedSetting("edges") === "on");
export const labelsShown = signal(storedSetting("labels") !== "off");
export const pathsShown = signal(storedSetting("paths") !== "off");
export const hidden = signal<ReadonlySet<Hideable>>(
  new Set(HIDEABLE.filter((one) => storedSetting("hidden")?.split(" ").includes(one) === true)),
);

effect(() => storeSetting("edges", edgesMove.value ? "on" : "off"));
effect(() => storeSetting("labels", labelsShown.value ? "on" : "off"));
effect(() => storeSetting("paths", pathsShown.value ? "on" : "off"));
effect(() => storeSetting("hidden", [...hidden.value].join(" ")));

export function hide(what: Hideable, on: boolean): void {
  const next = new Set(hidden.value);
  if (on) next.add(what);
  else next.delete(what);
  hidden.value = next;
}
