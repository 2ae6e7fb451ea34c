/** The paths of the mission, requested again after each change. */

import { batch, computed, effect, signal } from "@preact/signals-core";

import { responseData, client, Refusal, Unreached } from "../api/client";
import type { PreviewedMission } from "../api/types";
import { messageOf } from "./notices";
import { missionHasErrors, mission, planId, revision } from "./plan";
import { obstacleRevision } from "./world";

/** The preview of the last revision without errors; null before the first one, and if the present paths were
 * refused. */
export const preview = signal<PreviewedMission | null>(null);
/** The revision and the obstacles of `preview`. */
const previewed = signal("");
/** Why the mission has no paths; null: it has, or this is not known yet. */
export const previewRefused = signal<string | null>(null);
/** Whether `preview` belongs to the present mission and site. */
export const previewIsNew = computed(() => previewed.value === previewKey());
/** The mission in another order, for comparison. */
export const comparedPreview = signal<PreviewedMission | null>(null);
/** Index in `preview.ways` of the leg under the pointer. */
export const hoveredLeg = signal<number | null>(null);

const AFTER_MS = 250;
const RETRY_MS = 2_000;
let about = "";
let plan: string | null = null;
let waiting: ReturnType<typeof setTimeout> | undefined;

function previewKey(): string {
  return `${planId.value ?? ""} ${revision.value} ${obstacleRevision.value}`;
}

effect(() => {
  const id = planId.value;
  const empty = (mission.value?.tasks.length ?? 0) === 0;
  const now = previewKey();
  if (id !== plan || empty)
    batch(() => {
      preview.value = comparedPreview.value = hoveredLeg.value = previewRefused.value = null;
    });
  plan = id;
  if (now === about) return;
  about = "";
  clearTimeout(waiting);
  if (id === null || missionHasErrors.value || empty) return;
  about = now;
  waiting = setTimeout(() => void readPreview(id, now), AFTER_MS);
});

async function readPreview(id: string, asked: string): Promise<void> {
  let found: PreviewedMission | null = null;
  let refused: string | null = null;
  try {
    found = await responseData(client.GET("/api/missions/{id}/preview", { params: { path: { id } } }));
  } catch (error) {
    if (error instanceof Unreached && asked === about)
      waiting = setTimeout(() => void readPreview(id, asked), RETRY_MS);
    if (!(error instanceof Refusal)) return;
    refused = messageOf(error);
  }
  if (asked !== about) return;
  batch(() => {
    preview.value = found;
    previewed.value = asked;
    previewRefused.value = refused;
    hoveredLeg.value = null;
  });
}
