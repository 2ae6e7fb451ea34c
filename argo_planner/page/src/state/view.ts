/** What of the site is shown and how, and what the pointer does there. */

import { signal } from "@preact/signals-core";

import type { Pose, Task } from "../api/types";

/** What a click in the scene does: choose, place the robot's next task, or put an obstacle up. */
export type Tool = "select" | "navigate" | "obstacle";

export const tool = signal<Tool>("select");
/** Number of the floor that is shown with all below it; null: all floors. */
export const shownFloor = signal<number | null>(null);
/** How the camera follows the robot of the run that is shown. */
export const following = signal<"off" | "behind" | "above">("off");

/** A wish to see something, which the scene fulfils. */
export type Look =
  | { readonly kind: "pose"; readonly pose: Pose }
  | { readonly kind: "checkpoint"; readonly id: string }
  | { readonly kind: "all" };
export const look = signal<Look | null>(null);

/** Shows where a task is done: the face of its checkpoint, or its place. */
export function lookAt(task: Task): void {
  if (task.object_id) look.value = { kind: "checkpoint", id: task.object_id };
  else if (task.pose) look.value = { kind: "pose", pose: task.pose };
}

/** The part of the page at the right that is open; on narrow screens the only one. */
export type Panel = "properties" | "script" | "route" | "evaluate" | "run";
export const panel = signal<Panel>("properties");

/** As another mission is opened: nothing of what was seen and in hand with the one before. */
export function resetView(): void {
  tool.value = "select";
  shownFloor.value = null;
  following.value = "off";
  if (panel.value === "run") panel.value = "properties";
}
