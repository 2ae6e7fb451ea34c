/** The view of floor plans and the mission sheet: whether it is open, and what it shows. */

import { computed, effect, signal } from "@preact/signals-core";

import { client, Refusal, responseData, Unreached } from "../api/client";
import { floorsVisited, stepPlaces } from "../model/floor-drawing";
import { dependOn } from "../state/depend-on";
import { messageOf, showNotice } from "../state/notices";
import { mission, missionHasErrors, planId, revision } from "../state/plan";
import { preview } from "../state/preview";
import { stepNumbers } from "../state/task-labels";
import { panel } from "../state/view";
import { world } from "../state/world";
import { t } from "../texts";

export type PlansShown = "off" | "plans" | "sheet";

export const plansShown = signal<PlansShown>("off");
/** Number of the floor whose plan is shown; null: the first one that the mission visits. */
export const planFloor = signal<number | null>(null);

effect(() => {
  dependOn(planId);
  plansShown.value = "off";
  planFloor.value = null;
});
// A panel that a key or the bar at the top opens is to be seen.
effect(() => {
  dependOn(panel);
  plansShown.value = "off";
});

/** Load the view, and open it. */
export async function openPlans(shown: Exclude<PlansShown, "off">): Promise<void> {
  const id = planId.value;
  try {
    await import("./view");
  } catch {
    showNotice("warn", t().frame.notReached);
    return;
  }
  if (planId.value === id && id !== null) plansShown.value = shown;
}

export const places = computed(() =>
  mission.value === null || world.value === null ? [] : stepPlaces(mission.value, world.value, stepNumbers.value),
);
/** Numbers of the floors that the mission visits. */
export const visited = computed(() => (world.value === null ? [] : floorsVisited(places.value, preview.value, world.value)));

/** The mission as Argo writes it, or why there is no script; null: it is not read yet. */
export const writtenScript = signal<{ readonly text: string } | { readonly problem: string } | null>(null);
let about = "";
const RETRY_MS = 2_000;

effect(() => {
  const id = planId.value;
  const now = `${id ?? ""} ${revision.value}`;
  if (plansShown.value !== "sheet" || id === null || now === about) return;
  about = now;
  writtenScript.value = null;
  if (!missionHasErrors.value) void readScript(id, now);
  else writtenScript.value = { problem: t().script.hasErrors };
});

async function readScript(id: string, asked: string): Promise<void> {
  try {
    const path = { id, format: "script" };
    const text = await responseData(
      client.GET("/api/missions/{id}/export/{format}", { params: { path }, parseAs: "text" }),
    );
    if (asked === about) writtenScript.value = { text };
  } catch (error) {
    if (asked !== about) return;
    if (error instanceof Refusal) writtenScript.value = { problem: messageOf(error) };
    else if (error instanceof Unreached) setTimeout(() => asked === about && void readScript(id, asked), RETRY_MS);
    else throw error;
  }
}
