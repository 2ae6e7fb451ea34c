/** Marks of the rows: problems, run states, other people. */

import { computed, effect, signal } from "@preact/signals-core";

import type { Diagnostic } from "../api/types";
import { changedNames } from "../model/change";
import type { Row } from "../model/outline";
import { analysis, findings, lastRevision, others, planId, tasksByName } from "../state/plan";
import { run, shownRun } from "../state/run";
import { isOwn } from "../state/commands";
import { isMe } from "../state/session";

export interface Marks {
  readonly problem: Diagnostic | null;
  readonly run: "done" | "abnormal" | "failed" | "byHand" | "active" | "skipped" | null;
  readonly people: readonly string[];
  /** Whether somebody else has just changed the task or group. */
  readonly changed: boolean;
}

const NONE: Marks = { problem: null, run: null, people: [], changed: false };
const FLASH_MS = 1_600;

/** All diagnostics of the check and the analysis, errors first. */
export const problems = computed<readonly Diagnostic[]>(() => {
  const rank = { error: 0, warning: 1, note: 2 };
  // An empty list says this itself.
  const checked = findings.value.diagnostics.filter((one) => one.code !== "il.empty-mission");
  const analysed = analysis.value?.analysis?.diagnostics ?? [];
  const known = new Set(checked.map((one) => one.code + (one.subject ?? "") + one.message));
  const all = [
    ...checked,
    ...analysed.filter((one) => !known.has(one.code + (one.subject ?? "") + one.message)),
  ];
  return all.sort((a, b) => rank[a.severity] - rank[b.severity]);
});

const problemsBySubject = computed(() => {
  const found = new Map<string, Diagnostic>();
  for (const one of problems.value) {
    const key = keyOfSubject(one.subject);
    if (key !== null && one.severity !== "note" && !found.has(key)) found.set(key, one);
  }
  return found;
});

const selectedByOthers = computed(() => {
  const found = new Map<string, string[]>();
  for (const member of others.value)
    for (const name of member.selection) found.set(name, [...(found.get(name) ?? []), member.author]);
  return found;
});

/** Names of the tasks and groups that somebody else has just changed, and the timer that clears them. */
let ending: ReturnType<typeof setTimeout> | undefined;
const flashing = signal<ReadonlySet<string>>(new Set());
effect(() => {
  const made = lastRevision.value;
  if (made === null || isOwn(made) || isMe(made.author)) return;
  flashing.value = changedNames(made.change);
  clearTimeout(ending);
  ending = setTimeout(() => (flashing.value = new Set()), FLASH_MS);
});

const OUTCOMES = {
  done: "done",
  failed: "failed",
  stopped: null,
  "by hand": "byHand",
  skipped: "skipped",
} as const;

/** Parts of the shown run, separately: its pose changes many times a second, they do not. */
const shownPlan = computed(() => shownRun.value?.plan);
const shownOutcomes = computed(() => shownRun.value?.outcomes);
const shownReadings = computed(() => shownRun.value?.readings);
const shownTask = computed(() => shownRun.value?.task ?? null);
const shownIsLive = computed(() => shownRun.value?.live ?? false);

const abnormal = computed(
  () => new Set((shownReadings.value ?? []).filter((one) => !one.normal).map((one) => String(one.checkpoint))),
);

/** Return whether the last reading of a task's checkpoint is abnormal. */
function isAbnormal(task: string): boolean {
  return abnormal.value.has(tasksByName.value.get(task)?.object_id ?? "");
}

/** State of each task in the run: outcome of its last visit, to be skipped, or in progress. */
const runStates = computed(() => {
  const found = new Map<string, Marks["run"]>();
  if (shownPlan.value !== planId.value) return found;
  for (const [name, outcome] of shownOutcomes.value ?? [])
    found.set(name, outcome === "done" && isAbnormal(name) ? "abnormal" : OUTCOMES[outcome]);
  const live = shownIsLive.value ? run.value : null;
  for (const name of live?.skipped ?? []) found.set(name, "skipped");
  if (shownTask.value !== null && (live === null || live.status === "running"))
    found.set(shownTask.value, "active");
  return found;
});

/** Return the marks of a row. */
export function marksOf(row: Row): Marks {
  const name = row.kind === "task" ? row.task.name : row.group.name;
  const problem = problemsBySubject.value.get(row.key) ?? null;
  const people = selectedByOthers.value.get(name) ?? [];
  const changed = flashing.value.has(name);
  const state = row.kind === "task" ? (runStates.value.get(name) ?? null) : null;
  if (problem === null && people.length === 0 && !changed && state === null) return NONE;
  return { problem, run: state, people, changed };
}

/** Return the key of a diagnostic's subject, such as `tasks['valve'].transitions`; null: the whole mission. */
export function keyOfSubject(subject: string | null | undefined): string | null {
  const found = /^(tasks|groups|reactions)\['((?:[^'\\]|\\.)*)'\]/.exec(subject ?? "");
  if (!found) return null;
  const kind = { tasks: "task", groups: "group", reactions: "reaction" }[found[1] as "tasks"];
  const written = (found[2] ?? "").replaceAll("\\'", "'").replaceAll('"', '\\"');
  return `${kind}:${JSON.parse(`"${written}"`) as string}`;
}
