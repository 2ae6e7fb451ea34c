/** Two runs of the open mission that are compared. */

import { effect, signal } from "@preact/signals-core";

import { client, Refusal, responseData } from "../api/client";
import type { FinishedRun, RunReport } from "../model/run-comparison";
import { planId } from "./plan";
import { entriesOf } from "./run";

/** The compared runs; null: none are. The scene shows their paths. */
export const comparedRuns = signal<readonly [FinishedRun, FinishedRun] | null>(null);
let turn = 0;
effect(() => {
  const plan = planId.value;
  if (comparedRuns.peek()?.some((one) => one.state.plan !== plan)) stopComparing();
});

export function stopComparing(): void {
  turn++;
  comparedRuns.value = null;
}

/** Compare two runs. Throws `Refusal` or `Unreached`. */
export async function compareRuns(first: string, second: string): Promise<void> {
  const mine = ++turn;
  const found = await Promise.all([first, second].map(readRun));
  if (mine !== turn || found.some((one) => one.state.plan !== planId.value)) return;
  comparedRuns.value = found as unknown as readonly [FinishedRun, FinishedRun];
}

/** Read a run that has ended. Throws `Refusal` or `Unreached`. */
export async function readRun(id: string): Promise<FinishedRun> {
  const known = comparedRuns.peek()?.find((one) => one.state.id === id);
  if (known !== undefined && known.report !== null) return known; // a report may be written late
  const [state, entries, report] = await Promise.all([
    responseData(client.GET("/api/runs/{run}", { params: { path: { run: id } } })),
    entriesOf(id, 0),
    readReport(id),
  ]);
  return { state, entries, report };
}

/** Read the report of a run; null: it has none. Throws `Unreached`. */
async function readReport(run: string): Promise<RunReport | null> {
  const path = { run, file: "report.json" };
  try {
    const found: unknown = await responseData(
      client.GET("/api/runs/{run}/report/{file}", { params: { path }, parseAs: "json" }),
    );
    return found as RunReport;
  } catch (error) {
    if (error instanceof Refusal) return null;
    throw error;
  }
}
