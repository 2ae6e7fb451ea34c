/** The mission in sentences of the script, read again shortly after each change. */

import { effect, signal } from "@preact/signals-core";

import { responseData, client, Refusal, Unreached } from "../api/client";
import type { MissionReading } from "../api/types";
import { missionHasErrors, mission, planId, revision } from "./plan";

/** The last sentences and their revision; null: none yet. */
export const missionSentences = signal<{ revision: number; reading: MissionReading } | null>(null);

const PAUSE_MS = 300;
const RETRY_MS = 2_000;
const LARGE = 500;
let waiting: ReturnType<typeof setTimeout> | undefined;

effect(() => {
  const id = planId.value;
  const at = revision.value;
  clearTimeout(waiting);
  if (id === null) missionSentences.value = null;
  if (id === null || missionHasErrors.value || at === 0) return;
  const many = (mission.peek()?.tasks.length ?? 0) > LARGE;
  waiting = setTimeout(() => void readSentences(id, at), many ? 4 * PAUSE_MS : PAUSE_MS);
});

async function readSentences(id: string, at: number): Promise<void> {
  try {
    const found = await responseData(
      client.GET("/api/missions/{id}/reading", { params: { path: { id } } }),
    );
    if (planId.value === id && revision.value === at) missionSentences.value = { revision: at, reading: found };
  } catch (error) {
    // Until they are read, at the latest after the next change, the list uses its own words.
    if (error instanceof Unreached && planId.value === id && revision.value === at)
      waiting = setTimeout(() => void readSentences(id, at), RETRY_MS);
    if (!(error instanceof Refusal || error instanceof Unreached)) throw error;
  }
}
