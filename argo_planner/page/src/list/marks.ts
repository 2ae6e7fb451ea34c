/** What stands beside the rows of the list: problems, how far a run is, who else is there, and what
 * is said of each row. */

import { computed, effect, signal } from "@preact/signals-core";

import type { Diagnostic } from "../api/types";
import { touched } from "../model/change";
import { groupKey, taskKey, type Row } from "../model/outline";
import { analysis, findings, lastRevision, others, planId } from "../state/plan";
import { reading } from "../state/reading";
import { pastRun, run, shownRun, shownTime } from "../state/run";
import { author } from "../state/session";
import { world } from "../state/world";
import { describeGroup, describeTask } from "./describe";

export interface Marks {
  readonly problem: Diagnostic | null;
  readonly run: "done" | "failed" | "byHand" | "active" | "skipped" | null;
  readonly people: readonly string[];
  /** Whether somebody else has just changed it. */
  readonly changed: boolean;
}

const NONE: Marks = { problem: null, run: null, people: [], changed: false };
const FLASH_MS = 1_600;

/** All that the check and the analysis have found, errors first. */
export const problems = computed<readonly Diagnostic[]>(() => {
  const rank = { error: 0, warning: 1, note: 2 };
  // A mission without tasks says so itself.
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

/** Names of what somebody else has just changed. */
const flashing = signal<ReadonlySet<string>>(new Set());
effect(() => {
  const made = lastRevision.value;
  if (made === null || made.author === author.peek()) return;
  flashing.value = touched(made.change);
  setTimeout(() => (flashing.value = new Set()), FLASH_MS);
});

const OUTCOMES = {
  done: "done",
  failed: "failed",
  stopped: null,
  "by hand": "byHand",
  skipped: "skipped",
} as const;

const runStates = computed(() => {
  const found = new Map<string, Marks["run"]>();
  if (shownTime.value !== null || pastRun.value !== null) {
    const past = shownRun.value;
    if (past === null || past.plan !== planId.value) return found;
    for (const [name, outcome] of past.outcomes) found.set(name, OUTCOMES[outcome]);
    if (past.task) found.set(past.task, "active");
    return found;
  }
  const shown = run.value;
  if (shown === null || shown.plan !== planId.value) return found;
  for (const task of shown.tasks)
    found.set(task.task, task.failed > 0 ? "failed" : task.by_hand > 0 ? "byHand" : "done");
  for (const name of shown.skipped) found.set(name, "skipped");
  if (shown.task && shown.status === "running") found.set(shown.task, "active");
  return found;
});

/** What stands beside a row. */
export function marksOf(row: Row): Marks {
  const name = row.kind === "task" ? row.task.name : row.group.name;
  const problem = problemsBySubject.value.get(row.key) ?? null;
  const people = selectedByOthers.value.get(name) ?? [];
  const changed = flashing.value.has(name);
  const state = row.kind === "task" ? (runStates.value.get(name) ?? null) : null;
  if (problem === null && people.length === 0 && !changed && state === null) return NONE;
  return { problem, run: state, people, changed };
}

const sentences = computed(() => {
  const found = new Map<string, string>();
  for (const entry of reading.value?.reading.entries ?? []) {
    if (entry.part !== "task" && entry.part !== "round") continue;
    const key = entry.part === "task" ? taskKey(entry.name) : groupKey(entry.name);
    const said = entry.sentences.join("; ");
    found.set(key, found.has(key) ? `${found.get(key) ?? ""}; ${said}` : said);
  }
  return found;
});

/** What is said of a row: the script's own sentence, or until that is there our words. */
export function sentenceOf(row: Row): string {
  const own = row.kind === "task" ? describeTask(row.task, world.value) : describeGroup(row.group);
  return sentences.value.get(row.key) ?? own;
}

/** The key of what a diagnostic is about, such as `tasks['valve'].transitions`; null: the whole. */
export function keyOfSubject(subject: string | null | undefined): string | null {
  const found = /^(tasks|groups|reactions)\['((?:[^'\\]|\\.)*)'\]/.exec(subject ?? "");
  if (!found) return null;
  const kind = { tasks: "task", groups: "group", reactions: "reaction" }[found[1] as "tasks"];
  const written = (found[2] ?? "").replaceAll("\\'", "'").replaceAll('"', '\\"');
  return `${kind}:${JSON.parse(`"${written}"`) as string}`;
}
