/** The search for an order of the open mission: start it, stop it, accept its result. */

import { batch, computed, effect, signal } from "@preact/signals-core";

import { responseData, client, Refusal, Unreached } from "../api/client";
import type { operations } from "../api/schema";
import type { OrderJob } from "../api/types";
import { commandId, allAnswered, tryWithPlan } from "../state/commands";
import { showNotice, showError, withErrorNotice } from "../state/notices";
import { connected, jobs, planId, revision, takePlanState, takeJob } from "../state/plan";
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
const shownSearch = signal<OrderJob | null>(null);
let plan: string | null = null;
let previewed = "";

/** The newest state of the shown search. */
export const job = computed<OrderJob | null>(() => {
  const known = shownSearch.value;
  const newest = known === null ? undefined : jobs.value.get(known.id);
  return newest?.kind === "order" ? newest : known;
});
/** Whether the mission was changed after the search began. */
export const jobIsStale = computed(() => job.value !== null && job.value.revision !== revision.value);

effect(() => {
  const id = planId.value;
  if (id !== plan) closeSearch();
  plan = id;
});

effect(() => {
  const found = job.value;
  if (found?.state === "done" && found.found?.reordering && previewed !== found.id) {
    previewed = found.id;
    void previewOrder(found.id);
  }
});

// When the connection returns, the state of the search is read again.
effect(() => {
  const known = job.peek();
  if (!connected.value || known === null || isOver(known)) return;
  responseData(client.GET("/api/jobs/{id}", { params: { path: { id: known.id } } }))
    .then((found) => {
      if (shownSearch.peek()?.id === found.id) takeJob(found);
    })
    .catch((error: unknown) => {
      if (error instanceof Refusal) closeSearch();
      else if (!(error instanceof Unreached)) throw error;
    });
});

function isOver(one: OrderJob): boolean {
  return one.state !== "running";
}

/** Show the paths of the suggested order on the site, to compare them with the present ones. */
async function previewOrder(id: string): Promise<void> {
  try {
    const ways = await responseData(client.GET("/api/jobs/{id}/preview", { params: { path: { id } } }));
    if (shownSearch.value?.id === id) comparedPreview.value = ways;
  } catch (error) {
    if (!(error instanceof Refusal || error instanceof Unreached)) throw error;
  }
}

/** Start a search. Returns why it has not begun; null: it has. */
export function search(seconds: number, asked: Asked, solvers: readonly string[]): Promise<string | null> {
  return tryWithPlan(async (id) => {
    const body = { time_limit: seconds, requirements: asked, solvers } as unknown as SearchAsked;
    const begun = await responseData(client.POST("/api/missions/{id}/orders", { params: { path: { id } }, body }));
    if (planId.value !== id) return;
    closeSearch();
    shownSearch.value = begun;
  });
}

export async function cancelSearch(): Promise<void> {
  const id = job.value?.id;
  if (id === undefined) return;
  await withErrorNotice(async () => {
    takeJob(await responseData(client.DELETE("/api/jobs/{id}", { params: { path: { id } } })));
  });
}

export async function acceptOrder(): Promise<void> {
  const now = job.value;
  const id = planId.value;
  if (now === null || id === null) return;
  await allAnswered();
  try {
    const done = await responseData(
      client.POST("/api/jobs/{id}/accept", {
        params: { path: { id: now.id }, header: { "If-Match": `"${now.revision}"` } },
        body: { id: commandId() },
      }),
    );
    if (planId.value !== id) return;
    takePlanState(done);
    closeSearch();
    showNotice("info", t().route.accepted);
  } catch (error) {
    if (error instanceof Refusal && error.problem.code === "stale-revision") showNotice("warn", t().route.stale);
    else showError(error);
  }
}

export function closeSearch(): void {
  batch(() => {
    shownSearch.value = null;
    comparedPreview.value = null;
  });
}
