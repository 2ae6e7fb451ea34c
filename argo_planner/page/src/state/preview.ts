/** The ways of the mission as they will be driven, asked for anew after each change. */

import { batch, computed, effect, signal } from "@preact/signals-core";

import { answered, client, Refusal, Unreached } from "../api/client";
import type { PreviewedMission } from "../api/types";
import { messageOf } from "./notices";
import { broken, mission, planId, revision } from "./plan";
import { obstacleRevision } from "./world";

/** Of the last revision without errors that was reckoned; null until there is one, and where the ways of
 * the mission as it is were refused. */
export const preview = signal<PreviewedMission | null>(null);
/** The revision and the obstacles that `preview` is of. */
const previewed = signal("");
/** Why there are no ways of the mission as it is; null: there are, or it is not known yet. */
export const previewRefused = signal<string | null>(null);
/** Whether what `preview` says is of the mission as it is, on the site as it is. */
export const previewIsNew = computed(() => previewed.value === state());
/** The mission in another order, to be compared with it. */
export const comparedPreview = signal<PreviewedMission | null>(null);
/** The number of the way in `preview.ways` at which somebody points. */
export const hoveredLeg = signal<number | null>(null);

const AFTER_MS = 250;
const RETRY_MS = 2_000;
let about = "";
let plan: string | null = null;
let waiting: ReturnType<typeof setTimeout> | undefined;

function state(): string {
  return `${planId.value ?? ""} ${revision.value} ${obstacleRevision.value}`;
}

effect(() => {
  const id = planId.value;
  const empty = (mission.value?.tasks.length ?? 0) === 0;
  const now = state();
  if (id !== plan || empty)
    batch(() => {
      preview.value = comparedPreview.value = hoveredLeg.value = previewRefused.value = null;
    });
  plan = id;
  if (now === about) return;
  about = "";
  clearTimeout(waiting);
  if (id === null || broken.value || empty) return;
  about = now;
  waiting = setTimeout(() => void read(id, now), AFTER_MS);
});

async function read(id: string, asked: string): Promise<void> {
  let found: PreviewedMission | null = null;
  let refused: string | null = null;
  try {
    found = await answered(client.GET("/api/missions/{id}/preview", { params: { path: { id } } }));
  } catch (error) {
    if (error instanceof Unreached && asked === about)
      waiting = setTimeout(() => void read(id, asked), RETRY_MS);
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
