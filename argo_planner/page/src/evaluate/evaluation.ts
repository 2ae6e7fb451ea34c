/** The evaluation of the mission that is open: begun, watched, ended, gone on with; its runs replayed. */

import { batch, computed, effect, signal } from "@preact/signals-core";

import { answered, client, Refusal, Unreached } from "../api/client";
import type { operations } from "../api/schema";
import type { EvaluationAsked, EvaluationJob, FailedRun } from "../api/types";
import { settled } from "../state/commands";
import { tellError } from "../state/notices";
import { connected, jobs, planId, revision, takeJob } from "../state/plan";
import { showReplay } from "../state/run";
import { panel } from "../state/view";

/** Of what is asked only what is given is sent. */
type Body = operations["evaluate_mission"]["requestBody"]["content"]["application/json"];

/** The newest evaluation of the mission, whoever has begun it; null: none is known. */
export const evaluation = computed<EvaluationJob | null>(() => {
  let newest: EvaluationJob | null = null;
  for (const one of jobs.value.values())
    if (one.kind === "evaluation" && (newest === null || one.begun > newest.begun)) newest = one;
  return newest;
});
/** Whether the mission was changed since it was begun. */
export const evaluationIsStale = computed(
  () => evaluation.value !== null && evaluation.value.revision !== revision.value,
);
/** Key of the run that is being made again. */
export const replaying = signal<string | null>(null);

// What became of it while nobody could tell, and which one there was before the page was opened, is asked for.
effect(() => {
  const id = planId.value;
  if (id !== null && connected.value) void newestOf(id);
});

async function newestOf(id: string): Promise<void> {
  try {
    const { jobs: all } = await answered(client.GET("/api/jobs"));
    const found = all.find((one) => one.mission === id && one.kind === "evaluation");
    if (found === undefined) return;
    const whole = await answered(client.GET("/api/jobs/{id}", { params: { path: { id: found.id } } }));
    if (planId.peek() === id) takeJob(whole);
  } catch (error) {
    if (!(error instanceof Refusal || error instanceof Unreached)) throw error;
  }
}

/** Begins one of the mission as it is. */
export async function evaluate(asked: Partial<EvaluationAsked>): Promise<void> {
  const id = planId.value;
  if (id === null) return;
  await settled();
  await taken(() =>
    client.POST("/api/missions/{id}/evaluations", {
      params: { path: { id }, header: { "If-Match": `"${revision.value}"` } },
      body: asked as unknown as Body,
    }),
  );
}

export async function cancelEvaluation(id: string): Promise<void> {
  await taken(() => client.DELETE("/api/jobs/{id}", { params: { path: { id } } }));
}

export async function goOnWithEvaluation(id: string): Promise<void> {
  await taken(() => client.POST("/api/jobs/{id}/go_on", { params: { path: { id } } }));
}

/** Lets a run be made once more, and shows it in place of the robot's. */
export async function replay(job: EvaluationJob, run: FailedRun): Promise<void> {
  if (replaying.value !== null) return;
  replaying.value = run.key;
  try {
    const path = { id: job.id, key: run.key };
    const made = await answered(client.GET("/api/jobs/{id}/runs/{key}", { params: { path } }));
    batch(() => {
      showReplay(made, run);
      if (planId.peek() === job.mission) panel.value = "run";
    });
  } catch (error) {
    tellError(error);
  } finally {
    replaying.value = null;
  }
}

async function taken(ask: () => Parameters<typeof answered>[0]): Promise<void> {
  const id = planId.value;
  try {
    const job = (await answered(ask())) as EvaluationJob;
    if (planId.value === id) takeJob(job);
  } catch (error) {
    tellError(error);
  }
}
