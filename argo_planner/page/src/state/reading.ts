/** The mission in the script's own sentences, read again a moment after each change. */

import { effect, signal } from "@preact/signals-core";

import { answered, client, Refusal, Unreached } from "../api/client";
import type { MissionReading } from "../api/types";
import { findings, mission, planId, revision } from "./plan";

/** What was read last, and of which revision; null: nothing yet, or the mission has errors. */
export const reading = signal<{ revision: number; reading: MissionReading } | null>(null);

const PAUSE_MS = 300;
const LARGE = 500;
let waiting: ReturnType<typeof setTimeout> | undefined;

effect(() => {
  const id = planId.value;
  const at = revision.value;
  const wrong = findings.value.diagnostics.some((one) => one.severity === "error");
  clearTimeout(waiting);
  if (id === null) reading.value = null;
  if (id === null || wrong || at === 0) return;
  const many = (mission.peek()?.tasks.length ?? 0) > LARGE;
  waiting = setTimeout(() => void read(id, at), many ? 4 * PAUSE_MS : PAUSE_MS);
});

async function read(id: string, at: number): Promise<void> {
  try {
    const found = await answered(
      client.GET("/api/missions/{id}/reading", { params: { path: { id } } }),
    );
    if (planId.value === id) reading.value = { revision: at, reading: found };
  } catch (error) {
    // It is read again after the next change; until then the list says it in its own words.
    if (!(error instanceof Refusal || error instanceof Unreached)) throw error;
  }
}
