/** Display settings of the site. They are stored in the browser. */

import { effect, signal } from "@preact/signals-core";

import { keep, kept } from "../state/session";
import { HIDEABLE, type Hideable } from "./site";

/** Whether the camera moves while the pointer is at an edge. */
export const edgesMove = signal(kept("edges") === "on");
export const labelsShown = signal(kept("labels") !== "off");
export const pathsShown = signal(kept("paths") !== "off");
export const hidden = signal<ReadonlySet<Hideable>>(
  new Set(HIDEABLE.filter((one) => kept("hidden")?.split(" ").includes(one) === true)),
);

effect(() => keep("edges", edgesMove.value ? "on" : "off"));
effect(() => keep("labels", labelsShown.value ? "on" : "off"));
effect(() => keep("paths", pathsShown.value ? "on" : "off"));
effect(() => keep("hidden", [...hidden.value].join(" ")));

export function hide(what: Hideable, on: boolean): void {
  const next = new Set(hidden.value);
  if (on) next.add(what);
  else next.delete(what);
  hidden.value = next;
}
