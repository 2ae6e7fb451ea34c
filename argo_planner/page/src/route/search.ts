/** The search for an order of the open mission: start it, stop it, accept its result. */

import { batch, computed, effect, signal } from "@preact/signals-core";

import { answered, client, Refusal, Unreached } from "../api/client";
import type { operations } from "../api/schema";
import type { OrderJob } from "../api/types";
import { commandId, settled, withPlan } from "../state/commands";
import { tell, tellError, telling } from "../state/notices";
import { connected, jobs, planId, revision, take, takeJob } from "../state/plan";
import { comparedPreview } from "../state/preview";
import { t } from "../texts";

export interface Asked {
  readonly budget: number | null;
  readonly before: readonly (readonly [string, string])[];
  readonly windows: readonly { readonly what: string; readonly earliest: number; readonly latest: number | null }[];
}

/** The request's type, in which all fields are required; fields that are left out keep their defaults. */
type SearchAsked =
  operations["suggest_order"]["requestBody"]["content"]["application/json"];

/** The shown search; null: none. */
const shown = signal<OrderJob | null>(null);
let plan: string | null = null;
let previewed = "";

/** The newest state of the shown search. */
export const job = computed<OrderJob | null>(() => {
  const known = shown.value;
  const newest = known === null ? undefined : jobs.value.get(known.id);
  return newest?.kind === "order" ? newest : known;
});
/** Whether the mission was changed after the search began. */
export const jobIsStale = computed(() => job.value !== null && job.value.revision !== revision.value);

effect(() => {
  const id = planId.value;
  if (id !== plan) leave();
  plan = id;
});

effect(() => {
  const found = job.value;
  if (found?.state === "done" && found.found?.reordering && previewed !== found.id) {
    previewed = found.id;
    void preview(found.id);
  }
});

// When the connection returns, the state of the search is read again.
effect(() => {
  const known = job.peek();
  if (!connected.value || known === null || isOver(known)) return;
  answered(client.GET("/api/jobs/{id}", { params: { path: { id: known.id } } }))
    .then((found) => {
      if (shown.peek()?.id === found.id) takeJob(found);
    })
    .catch((error: unknown) => {
      if (error instanceof Refusal) leave();
      else if (!(error instanceof Unreached)) throw error;
    });
});

function isOver(one: OrderJob): boolean {
  return one.state !== "running";
}

/** Show the paths of the suggested order on the site, to compare them with the present ones. */
async function preview(id: string): Promise<void> {
  try {
    const ways = await answered(client.GET("/api/jobs/{id}/preview", { params: { path: { id } } }));
    if (shown.value?.id === id) comparedPreview.value = ways;
  } catch (error) {
    if (!(error instanceof Refusal || error instanceof Unreached)) throw error;
  }
}

export async function search(seconds: number, asked: Asked): Promise<void> {
  await withPlan(async (id) => {
    const body = { time_limit: seconds, requirements: asked } as unknown as SearchAsked;
    const begun = await answered(client.POST("/api/missions/{id}/orders", { params: { path: { id } }, body }));
    if (planId.value !== id) return;
    leave();
    shown.value = begun;
  });
}

export async function cancel(): Promise<void> {
  const id = job.value?.id;
  if (id === undefined) return;
  await telling(async () => {
    takeJob(await answered(client.DELETE("/api/jobs/{id}", { params: { path: { id } } })));
  });
}

export async function accept(): Promise<void> {
  const now = job.value;
  const id = planId.value;
  if (now === null || id === null) return;
  await settled();
  try {
    const done = await answered(
      client.POST("/api/jobs/{id}/accept", {
        params: { path: { id: now.id }, header: { "If-Match": `"${now.revision}"` } },
        body: { id: commandId() },
      }),
    );
    if (planId.value !== id) return;
    take(done);
    leave();
    tell("info", t().route.accepted);
  } catch (error) {
    if (error instanceof Refusal && error.problem.code === "stale-revision") tell("warn", t().route.stale);
    else tellError(error);
  }
}

export function leave(): void {
  batch(() => {
    shown.value = null;
    comparedPreview.value = null;
  });
}
