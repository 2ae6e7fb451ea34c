/** The ways of the mission as they will be driven, asked for anew after each change. */

import { batch, effect, signal } from "@preact/signals-core";

import { answered, client, Unreached } from "../api/client";
import type { PreviewedMission } from "../api/types";
import { findings, mission, planId, revision } from "./plan";
import { obstacleRevision } from "./world";

/** Of the last revision without errors; null until there is one. */
export const preview = signal<PreviewedMission | null>(null);
/** The mission in another order, to be compared with it. */
export const comparedPreview = signal<PreviewedMission | null>(null);
/** The number of the way in `preview.ways` at which somebody points. */
export const hoveredLeg = signal<number | null>(null);

const AFTER_MS = 250;
const RETRY_MS = 2_000;
let about = "";
let plan: string | null = null;
let waiting: ReturnType<typeof setTimeout> | undefined;

effect(() => {
  const id = planId.value;
  const broken = findings.value.diagnostics.some((one) => one.severity === "error");
  const empty = (mission.value?.tasks.length ?? 0) === 0;
  const now = `${id ?? ""} ${revision.value} ${obstacleRevision.value}`;
  if (id !== plan || empty)
    batch(() => {
      preview.value = comparedPreview.value = hoveredLeg.value = null;
    });
  plan = id;
  if (now === about) return;
  about = "";
  clearTimeout(waiting);
  if (id === null || broken || empty) return;
  about = now;
  waiting = setTimeout(() => void read(id, now), AFTER_MS);
});

async function read(id: string, asked: string): Promise<void> {
  let found: PreviewedMission | null = null;
  try {
    found = await answered(client.GET("/api/missions/{id}/preview", { params: { path: { id } } }));
  } catch (error) {
    // A refusal says what the findings say; a mission that can't be driven has no preview.
    if (error instanceof Unreached && asked === about)
      waiting = setTimeout(() => void read(id, asked), RETRY_MS);
    if (error instanceof Unreached) return;
  }
  if (asked !== about) return;
  batch(() => {
    preview.value = found;
    hoveredLeg.value = null;
  });
}
