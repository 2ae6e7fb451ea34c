/** The open mission, as the service has it. */

import { batch, computed, signal } from "@preact/signals-core";

import { responseData, authorQuery, client, Refusal, Unreached } from "../api/client";
import { LiveConnection } from "../api/live";
import type {
  AnalysisFound,
  CommandDone,
  Findings,
  Member,
  Mission,
  EvaluationJob,
  OrderJob,
  PlanState,
  Revision,
  RoomMessage,
  VersionSummary,
} from "../api/types";
import { applyChange } from "../model/change";
import { renamesBetween } from "../model/renames";
import { groupKey, isTaskKey, nameOfKey, reactionKey, taskKey } from "../model/outline";
import { t } from "../texts";
import { said } from "../texts/messages";
import { followRenames, renamedKeys } from "./identity";
import { showNotice, showNoticesOf } from "./notices";
import { isMe } from "./session";
import { resetView } from "./view";
import { obstaclesChanged } from "./world";

const MOST_RECENT = 500;

export const planId = signal<string | null>(null);
export const planName = signal("");
export const mission = signal<Mission | null>(null);
export const revision = signal(0);
export const findings = signal<Findings>({ diagnostics: [], more: 0 });
/** Whether the mission has errors, with which it can neither be previewed nor driven. */
export const missionHasErrors = computed(() => findings.value.diagnostics.some((one) => one.severity === "error"));
/** The last analysis, possibly of an earlier revision. */
export const analysis = signal<AnalysisFound | null>(null);
export const versions = signal<readonly VersionSummary[]>([]);
export const undoable = signal<readonly number[]>([]);
export const redoable = signal<readonly number[]>([]);
/** The other people and windows that have the mission open. */
export const others = signal<readonly Member[]>([]);
/** The newest state of each job of the mission, by id. */
export const jobs = signal<ReadonlyMap<string, OrderJob | EvaluationJob>>(new Map());
export const connected = signal(false);
/** Whether somebody else has deleted the mission that was open last. */
export const wasDeleted = signal(false);
/** Keys of the selection (`taskKey`, `groupKey`, `reactionKey`), in the order of selection. */
export const selection = signal<readonly string[]>([]);
/** The last revision by anybody, used to highlight changes of others. */
export const lastRevision = signal<Revision | null>(null);

export const tasksByName = computed(
  () => new Map((mission.value?.tasks ?? []).map((task) => [task.name, task])),
);
/** Names of all tasks but START, in order. */
export const tasksAfterStart = computed(() =>
  (mission.value?.tasks ?? []).filter((task) => task.action !== "START").map((task) => task.name),
);
/** The selected task, if exactly one is selected. */
export const selectedTask = computed(() => {
  const [key, second] = selection.value;
  if (key === undefined || second !== undefined || !isTaskKey(key)) return null;
  return tasksByName.value.get(nameOfKey(key)) ?? null;
});

let live: LiveConnection<RoomMessage> | null = null;
/** This page's id among the members. */
let self = "";
/** The last revisions in order, by anybody. */
const recent: Revision[] = [];

/** Open a mission, unless `isMeant` returns false once it is loaded. Throws `Refusal` or `Unreached`. */
export async function openPlan(id: string, isMeant: () => boolean): Promise<void> {
  const state = await responseData(client.GET("/api/missions/{id}", { params: { path: { id } } }));
  if (!isMeant()) return;
  closePlan();
  wasDeleted.value = false;
  showNoticesOf(id);
  batch(() => {
    planId.value = id;
    takePlanState(state);
  });
  live = new LiveConnection<RoomMessage>({
    address: () =>
      `/api/missions/${id}/live?since=${revision.value}${and(authorQuery())}`,
    onMessage,
    onConnection: (there) => {
      connected.value = there;
      if (there) {
        sendSelection();
        obstaclesChanged(); // no message reports obstacles that were added meanwhile
      } else void checkStillExists(id);
    },
    onDeleted,
  });
}

/** Check whether the mission still exists, as its connection has ended. */
async function checkStillExists(id: string): Promise<void> {
  try {
    await responseData(client.GET("/api/missions/{id}/versions", { params: { path: { id } } }));
  } catch (error) {
    if (error instanceof Refusal && error.problem.status === 404 && planId.value === id) onDeleted();
    else if (!(error instanceof Refusal || error instanceof Unreached)) throw error;
  }
}

function onDeleted(): void {
  wasDeleted.value = true;
  showNotice("warn", t().frame.deletedBy(planName.value));
  closePlan();
  history.replaceState(null, "", "#");
}

export function closePlan(): void {
  resetView();
  live?.close();
  live = null;
  followRenames(new Map(), () => false);
  showNoticesOf(null);
  batch(() => {
    planId.value = null;
    planName.value = "";
    mission.value = null;
    selection.value = [];
    others.value = [];
    findings.value = { diagnostics: [], more: 0 };
    versions.value = undoable.value = redoable.value = [];
    analysis.value = null;
    jobs.value = new Map();
    connected.value = false;
    lastRevision.value = null;
  });
}

/** Take the new state of a job. */
export function takeJob(job: OrderJob | EvaluationJob): void {
  jobs.value = new Map(jobs.peek()).set(job.id, job);
}

export function select(keys: readonly string[]): void {
  selection.value = keys;
  sendSelection();
}

/** Return the revisions after a known one; null: they are no longer known. */
export function revisionsSince(known: number): readonly Revision[] | null {
  if (known === revision.value) return [];
  if ((recent[0]?.number ?? Infinity) > known + 1) return null;
  return recent.filter((one) => one.number > known);
}

/** Take the plan's state from an answer of the service. */
export function takePlanState(answer: PlanState | CommandDone): void {
  batch(() => {
    if ("mission" in answer) {
      mission.value = answer.mission;
      revision.value = answer.revision;
      planName.value = answer.name;
      analysis.value = answer.analysis ?? null;
      versions.value = answer.versions;
      recent.length = 0;
      if (answer.recovered) showNotice("warn", said(answer.recovered, answer.recovered_wording));
      pruneSelection(null);
    } else takeRevision(answer.revision);
    if (!("newest" in answer) || answer.newest === revision.value) findings.value = answer.findings;
    undoable.value = answer.undoable;
    redoable.value = answer.redoable;
  });
}

/** Apply a revision, if it is the next one. */
export function takeRevision(made: Revision): void {
  if (mission.value === null || made.number !== revision.value + 1) return;
  const before = mission.value;
  recent.push(made);
  if (recent.length > MOST_RECENT) recent.shift();
  batch(() => {
    const after = applyChange(before, made.change);
    const renamed = renamesBetween(before, after);
    mission.value = after;
    revision.value = made.number;
    lastRevision.value = made;
    if (renamed.size > 0) selection.value = renamedKeys(selection.value, renamed);
    const keys = pruneSelection(isMe(made.author) ? null : made.author);
    followRenames(renamed, (key) => keys.has(key));
    if (renamed.size > 0) sendSelection();
  });
}

function onMessage(message: RoomMessage): void {
  batch(() => {
    switch (message.kind) {
      case "snapshot":
        self = message.client;
        takePlanState(message.state);
        takeMembers(message.members);
        break;
      case "resumed":
        self = message.client;
        planName.value = message.name;
        versions.value = message.versions;
        takeMembers(message.members);
        break;
      case "revision":
        if (message.revision.number <= revision.value) break;
        takeRevision(message.revision);
        if (message.findings) findings.value = message.findings;
        if (isMe(message.revision.author)) takeUndoable(message.revision);
        break;
      case "analysis":
        analysis.value = message.analysis;
        break;
      case "name":
        planName.value = message.name;
        break;
      case "versions":
        versions.value = message.versions;
        break;
      case "members":
        takeMembers(message.members);
        break;
      case "job":
        takeJob(message.job);
        break;
      case "world":
        obstaclesChanged();
        break;
      case "deleted":
        break; // the connection ends, which is reported separately
    }
  });
}

/** Add a revision by the same person, even from another window, to those that can be undone. */
function takeUndoable(made: Revision): void {
  if (made.kind === "edit" || made.kind === "replace") {
    undoable.value = [...undoable.value, made.number];
    redoable.value = [];
  }
}

function takeMembers(members: readonly Member[]): void {
  others.value = members.filter((member) => member.client !== self);
}

/** Remove deleted items from the selection, and report who deleted them. Returns the keys of all items. */
function pruneSelection(by: string | null): ReadonlySet<string> {
  const open = mission.value;
  const keys = new Set([
    ...(open?.tasks ?? []).map((task) => taskKey(task.name)),
    ...(open?.groups ?? []).map((group) => groupKey(group.name)),
    ...(open?.reactions ?? []).map((reaction) => reactionKey(reaction.event)),
  ]);
  const there = selection.value.filter((key) => keys.has(key));
  if (there.length === selection.value.length) return keys;
  const lost = selection.value.filter((key) => !keys.has(key)).map(nameOfKey);
  if (by !== null) showNotice("warn", t().frame.wentAway(by, lost.slice(0, 5).join(", ")));
  select(there);
  return keys;
}

function sendSelection(): void {
  live?.send({ kind: "select", names: selection.value.slice(0, 2_000).map(nameOfKey) });
}

function and(query: string): string {
  return query === "" ? "" : `&${query}`;
}
