/** The evaluations of the open mission: start, watch, stop and resume them, and replay their runs. */

import { batch, computed, effect, signal } from "@preact/signals-core";

import { answered, client, Refusal, Unreached } from "../api/client";
import type { operations } from "../api/schema";
import type { EvaluationAsked, EvaluationJob, FailedRun } from "../api/types";
import { heed } from "../scene/heed";
import { settled } from "../state/commands";
import { telling } from "../state/notices";
import { connected, jobs, planId, revision, takeJob } from "../state/plan";
import { showReplay } from "../state/run";
import { panel } from "../state/view";

/** The request's type, in which all fields are required; fields that are left out keep their defaults. */
type Body = operations["evaluate_mission"]["requestBody"]["content"]["application/json"];

/** Evaluations of all missions as last read, the newest first; without their results. */
const known = signal<readonly EvaluationJob[]>([]);
/** Evaluations of the open mission. */
export const evaluations = computed(() => known.value.filter((one) => one.mission === planId.value));
/** A running evaluation of another mission, because of which none can start here; null: none is known. */
export const elsewhere = computed(
  () => known.value.find((one) => one.mission !== planId.value && one.state === "running") ?? null,
);
/** Id of the evaluation that the person chose; null: the newest one is shown. */
const chosen = signal<string | null>(null);
/** The evaluation of the open mission that is shown: the newest one, or the chosen one; null: none is known. */
export const evaluation = computed<EvaluationJob | null>(() => {
  let newest: EvaluationJob | null = null;
  for (const one of jobs.value.values()) {
    if (one.kind !== "evaluation") continue;
    if (one.id === chosen.value) return one;
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
  heed(planId);
  chosen.value = null;
});
const state = computed(() => evaluation.value?.state ?? null);
// Evaluations are read when a mission is opened, when the connection returns, and when an evaluation begins
// or ends.
effect(() => {
  const id = planId.value;
  heed(state);
  if (id !== null && connected.value) void ask(id);
});

/** Read the list of all evaluations, and the result of the newest one of this mission. */
async function ask(id: string): Promise<void> {
  try {
    const { jobs: all } = await answered(client.GET("/api/jobs"));
    known.value = all.filter((one): one is EvaluationJob => one.kind === "evaluation");
    const newest = known.value.find((one) => one.mission === id);
    if (newest !== undefined && !jobs.peek().has(newest.id)) await read(newest.id, id);
  } catch (error) {
    if (!(error instanceof Refusal || error instanceof Unreached)) throw error;
  }
}

/** Read the result of an evaluation of the mission `id`. */
async function read(job: string, id: string): Promise<void> {
  const whole = await answered(client.GET("/api/jobs/{id}", { params: { path: { id: job } } }));
  if (planId.peek() === id) takeJob(whole);
}

/** Read the list of evaluations again. */
export async function lookElsewhere(): Promise<void> {
  if (planId.value !== null) await ask(planId.value);
}

/** Show another evaluation of the mission. */
export async function choose(job: string): Promise<void> {
  const id = planId.value;
  if (id === null) return;
  await telling(async () => {
    if (!jobs.peek().has(job)) await read(job, id);
    chosen.value = job;
  });
}

/** Delete a finished evaluation and its results. */
export async function forget(job: string): Promise<void> {
  await telling(async () => {
    await answered(client.DELETE("/api/evaluations/{id}", { params: { path: { id: job } } }));
    batch(() => {
      jobs.value = new Map([...jobs.value].filter(([other]) => other !== job));
      if (chosen.value === job) chosen.value = null;
    });
    await lookElsewhere();
  });
}

/** Start an evaluation of the mission in its present state. */
export async function evaluate(asked: Partial<EvaluationAsked>): Promise<void> {
  const id = planId.value;
  if (id === null) return;
  await settled();
  chosen.value = null;
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

/** Repeat a run of an evaluation, and show it in place of the robot's run. */
export async function replay(job: EvaluationJob, run: FailedRun): Promise<void> {
  if (replaying.value !== null) return;
  replaying.value = run.key;
  await telling(async () => {
    const path = { id: job.id, key: run.key };
    const made = await answered(client.GET("/api/jobs/{id}/runs/{key}", { params: { path } }));
    batch(() => {
      showReplay(made, run);
      if (planId.peek() === job.mission) panel.value = "run";
    });
  }).finally(() => (replaying.value = null));
}

async function taken(ask: () => Parameters<typeof answered>[0]): Promise<void> {
  const id = planId.value;
  const done = await telling(async () => {
    const job = (await answered(ask())) as EvaluationJob;
    if (planId.value === id) takeJob(job);
  });
  if (!done) void lookElsewhere();
}
