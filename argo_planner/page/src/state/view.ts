/** The view of the site and the selected tool. */

import { signal } from "@preact/signals-core";

import type { Pose, Task } from "../api/types";

/** Effect of a click in the scene: select, add a task at the ghost, add an obstacle, or give a fault its place. */
export type Tool = "select" | "navigate" | "obstacle" | "fault";

export const tool = signal<Tool>("select");
/** Number of the highest shown floor; null: all floors are shown. */
export const shownFloor = signal<number | null>(null);
/** Name of the task or group that the pointer is on, in the list or in the script; null: none. */
export const pointedName = signal<string | null>(null);
/** How the camera follows the robot of the shown run. */
export const following = signal<"off" | "behind" | "above">("off");

/** A requested view of the scene. */
export type Look =
  | { readonly kind: "pose"; readonly pose: Pose }
  | { readonly kind: "checkpoint"; readonly id: string }
  | { readonly kind: "all" };
export const look = signal<Look | null>(null);

/** Request a view of a task: the face of its checkpoint, or its pose. */
export function lookAt(task: Task): void {
  if (task.object_id) look.value = { kind: "checkpoint", id: task.object_id };
  else if (task.pose) look.value = { kind: "pose", pose: task.pose };
}

/** The open panel at the right; on narrow screens the only one. */
export type Panel = "properties" | "script" | "route" | "evaluate" | "run";
export const panel = signal<Panel>("properties");

/** Whether the drawer is open that the list is on narrow pages. */
export const listShown = signal(false);

/** Show the list: on narrow pages, open its drawer. */
export function showList(): void {
  listShown.value = matchMedia("(max-width: 719px)").matches;
}

/** Reset the view and the tools when another mission is opened. */
export function resetView(): void {
  tool.value = "select";
  listShown.value = false;
  shownFloor.value = null;
  following.value = "off";
  pointedName.value = look.value = null;
  if (panel.value === "run") panel.value = "properties";
}
