/** The evaluations of the open mission: start, watch, stop and resume them, and replay their runs. */

import { batch, computed, effect, signal } from "@preact/signals-core";

import { responseData, client, Refusal, Unreached } from "../api/client";
import type { operations } from "../api/schema";
import type { EvaluationAsked, EvaluationJob, FailedRun } from "../api/types";
import { dependOn } from "../state/depend-on";
import { tryWithPlan } from "../state/commands";
import { withErrorNotice } from "../state/notices";
import { connected, jobs, planId, revision, takeJob } from "../state/plan";
import { showReplay } from "../state/run";
import { panel } from "../state/view";

/** The request's type, in which all fields are required; fields that are left out keep their defaults. */
type Body = operations["evaluate_mission"]["requestBody"]["content"]["application/json"];

/** Evaluations of all missions as last read, the newest first; without their results. */
const knownEvaluations = signal<readonly EvaluationJob[]>([]);
/** Evaluations of the open mission. */
export const evaluations = computed(() => knownEvaluations.value.filter((one) => one.mission === planId.value));
/** A running evaluation of another mission, because of which none can start here; null: none is known. */
export const evaluationElsewhere = computed(
  () => knownEvaluations.value.find((one) => one.mission !== planId.value && one.state === "running") ?? null,
);
/** Id of the evaluation that the person chose; null: the newest one is shown. */
const chosenId = signal<string | null>(null);
/** The evaluation of the open mission that is shown: the newest one, or the chosen one; null: none is known. */
export const evaluation = computed<EvaluationJob | null>(() => {
  let newest: EvaluationJob | null = null;
  for (const one of jobs.value.values()) {
    if (one.kind !== "evaluation") continue;
    if (one.id === chosenId.value) return one;
    if (newest === null || one.begun > newest.begun) newest = one;
  }
  return newest;
});
/** Whether the mission was changed after the evaluation began. */
export const evaluationIsStale = computed(
  () => evaluation.value !== null && evaluation.value.revision !== revision.value,
);
/** Key of the run that is being repeated; null: none is. */
export const replaying = signal<string | null>(null);

// A choice is valid for one mission only.
effect(() => {
  dependOn(planId);
  chosenId.value = null;
});
const state = computed(() => evaluation.value?.state ?? null);
// Evaluations are read when a mission is opened, when the connection returns, and when an evaluation begins
// or ends.
effect(() => {
  const id = planId.value;
  dependOn(state);
  if (id !== null && connected.value) void readEvaluations(id);
});

/** Read the list of all evaluations, and the result of the newest one of this mission. */
async function readEvaluations(id: string): Promise<void> {
  try {
    const { jobs: all } = await responseData(client.GET("/api/jobs"));
    knownEvaluations.value = all.filter((one): one is EvaluationJob => one.kind === "evaluation");
    const newest = knownEvaluations.value.find((one) => one.mission === id);
    if (newest !== undefined && !jobs.peek().has(newest.id)) await readResult(newest.id, id);
  } catch (error) {
    if (!(error instanceof Refusal || error instanceof Unreached)) throw error;
  }
}

/** Read the result of an evaluation of the mission `id`. */
async function readResult(job: string, id: string): Promise<void> {
  const whole = await responseData(client.GET("/api/jobs/{id}", { params: { path: { id: job } } }));
  if (planId.peek() === id) takeJob(whole);
}

/** Read the list of evaluations again. */
export async function refreshEvaluations(): Promise<void> {
  if (planId.value !== null) await readEvaluations(planId.value);
}

/** Show another evaluation of the mission. */
export async function chooseEvaluation(job: string): Promise<void> {
  const id = planId.value;
  if (id === null) return;
  await withErrorNotice(async () => {
    if (!jobs.peek().has(job)) await readResult(job, id);
    chosenId.value = job;
  });
}

/** Delete a finished evaluation and its results. */
export async function deleteEvaluation(job: string): Promise<void> {
  await withErrorNotice(async () => {
    await responseData(client.DELETE("/api/evaluations/{id}", { params: { path: { id: job } } }));
    batch(() => {
      jobs.value = new Map([...jobs.value].filter(([other]) => other !== job));
      if (chosenId.value === job) chosenId.value = null;
    });
    await refreshEvaluations();
  });
}

/** Start an evaluation of the mission in its present state. Returns why it has not begun; null: it has. */
export async function startEvaluation(asked: Partial<EvaluationAsked>): Promise<string | null> {
  const refused = await tryWithPlan(async (id) => {
    const begun = client.POST("/api/missions/{id}/evaluations", {
      params: { path: { id }, header: { "If-Match": `"${revision.value}"` } },
      body: asked as unknown as Body,
    });
    const job = await responseData(begun);
    if (planId.value !== id) return;
    chosenId.value = null;
    takeJob(job);
  });
  if (refused !== null) void refreshEvaluations();
  return refused;
}

export async function cancelEvaluation(id: string): Promise<void> {
  await takeAnswer(() => client.DELETE("/api/jobs/{id}", { params: { path: { id } } }));
}

export async function resumeEvaluation(id: string): Promise<void> {
  await takeAnswer(() => client.POST("/api/jobs/{id}/go_on", { params: { path: { id } } }));
}

/** Repeat a run of an evaluation, and show it in place of the robot's run. */
export async function replayRun(job: EvaluationJob, run: FailedRun): Promise<void> {
  if (replaying.value !== null) return;
  replaying.value = run.key;
  await withErrorNotice(async () => {
    const path = { id: job.id, key: run.key };
    const made = await responseData(client.GET("/api/jobs/{id}/runs/{key}", { params: { path } }));
    batch(() => {
      showReplay(made, run);
      if (planId.peek() === job.mission) panel.value = "run";
    });
  }).finally(() => (replaying.value = null));
}

async function takeAnswer(ask: () => Parameters<typeof responseData>[0]): Promise<void> {
  const id = planId.value;
  const done = await withErrorNotice(async () => {
    const job = (await responseData(ask())) as EvaluationJob;
    if (planId.value === id) takeJob(job);
  });
  if (!done) void refreshEvaluations();
}
