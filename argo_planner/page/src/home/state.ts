/** What the home page shows of the service: missions, runs, drafts, examples and the bin. */

import { batch, computed, signal } from "@preact/signals-core";

import { client, responseData } from "../api/client";
import type { DraftSummary, ExampleSummary, PlanSummary, RunSummary } from "../api/types";
import { listedMissions } from "../model/mission-search";
import { run } from "../state/run";
import { world } from "../state/world";

/** null: not read yet */
export const missions = signal<readonly PlanSummary[] | null>(null);
export const bin = signal<readonly PlanSummary[]>([]);
export const drafts = signal<readonly DraftSummary[]>([]);
export const examples = signal<readonly ExampleSummary[]>([]);
export const latestRuns = signal<readonly RunSummary[]>([]);
const lastRuns = signal<readonly RunSummary[]>([]);
/** The mission that the pointer or the focus is on; its checkpoints light up in the picture of the site. */
export const pointedMission = signal<PlanSummary | null>(null);

const checkpointNames = computed(
  () => new Map((world.value?.checkpoints ?? []).map((one) => [String(one.id), one.name])),
);
/** All missions, the last changed ones first. */
export const listed = computed(() => listedMissions(missions.value ?? [], lastRuns.value, checkpointNames.value));
export const missionNames = computed(() => new Map((missions.value ?? []).map((one) => [one.id, one.name])));
/** Changes when the robot's run begins, is interrupted or ends. */
export const runTurn = computed(() => `${run.value?.id ?? ""} ${run.value?.status ?? ""}`);

/** Read all of it. Throws `Refusal` or `Unreached`. */
export async function readHome(): Promise<void> {
  const [all, deleted, begun, runs, shipped] = await Promise.all([
    responseData(client.GET("/api/missions")),
    responseData(client.GET("/api/bin")),
    responseData(client.GET("/api/drafts")),
    responseData(client.GET("/api/runs/latest", { params: { query: { most: 6 } } })),
    examples.peek().length > 0 ? null : responseData(client.GET("/api/examples")),
  ]);
  batch(() => {
    missions.value = all.missions;
    bin.value = deleted.missions;
    drafts.value = begun.drafts;
    latestRuns.value = runs.latest;
    lastRuns.value = runs.by_mission;
    if (shipped !== null) examples.value = shipped.examples;
  });
}
