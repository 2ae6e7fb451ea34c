/** The mission that is open, as the service has it, and what is asked of it. */

import { batch, computed, signal } from "@preact/signals-core";

import { answered, authorQuery, client, newId, Refusal, Unreached } from "../api/client";
import { LiveConnection } from "../api/live";
import type {
  AnalysisFound,
  CommandDone,
  Edit,
  Findings,
  Member,
  Mission,
  OrderJob,
  PlanState,
  Revision,
  RoomMessage,
  VersionSummary,
} from "../api/types";
import { changed, touched } from "../model/change";
import { groupKey, isTaskKey, nameOfKey, reactionKey, taskKey } from "../model/outline";
import { t } from "../texts";
import { messageOf, tell, tellError } from "./notices";
import { author } from "./session";
import { obstaclesChanged } from "./world";

/** An edit of which only what is given is sent. */
export type LooseEdit = Edit extends infer One
  ? One extends { readonly kind?: infer Kind }
    ? { readonly kind: NonNullable<Kind> } & Partial<Loose<Omit<One, "kind">>>
    : never
  : never;
type Loose<T> = { [key in keyof T]: T[key] extends object | null | undefined ? unknown : T[key] };

type Command =
  | { readonly kind: "edit"; readonly edits: readonly LooseEdit[] }
  | { readonly kind: "undo" | "redo" }
  | { readonly kind: "replace"; readonly mission: Mission; readonly about: string };

const RETRY_MS = 1_000;
const MOST_RECENT = 500;

export const planId = signal<string | null>(null);
export const planName = signal("");
export const mission = signal<Mission | null>(null);
export const revision = signal(0);
export const findings = signal<Findings>({ diagnostics: [], more: 0 });
/** The last analysis, which may be of an earlier revision. */
export const analysis = signal<AnalysisFound | null>(null);
export const versions = signal<readonly VersionSummary[]>([]);
export const undoable = signal<readonly number[]>([]);
export const redoable = signal<readonly number[]>([]);
/** Whoever else has the mission open; without this page. */
export const others = signal<readonly Member[]>([]);
/** The newest state of each search for an order, by id. */
export const jobs = signal<ReadonlyMap<string, OrderJob>>(new Map());
export const connected = signal(false);
/** How many commands wait for an answer. */
export const waiting = signal(0);
/** Keys of what is selected (`taskKey`, `groupKey`, `reactionKey`), the last one last. */
export const selection = signal<readonly string[]>([]);
/** What was done last, by whomever: to flash what others have changed. */
export const lastRevision = signal<Revision | null>(null);

export const tasksByName = computed(
  () => new Map((mission.value?.tasks ?? []).map((task) => [task.name, task])),
);
/** The one task that is selected, if it is one. */
export const chosenTask = computed(() => {
  const [key, second] = selection.value;
  if (key === undefined || second !== undefined || !isTaskKey(key)) return null;
  return tasksByName.value.get(nameOfKey(key)) ?? null;
});

let live: LiveConnection<RoomMessage> | null = null;
let client_ = "";
let queue: Promise<unknown> = Promise.resolve();
/** Ids of the commands that were asked for here. */
const own = new Set<string>();
/** The last revisions in order, by whomever. */
const recent: Revision[] = [];

/** Opens a mission; the first snapshot resolves it. Throws `Refusal` or `Unreached`. */
export async function openPlan(id: string): Promise<void> {
  const state = await answered(client.GET("/api/missions/{id}", { params: { path: { id } } }));
  closePlan();
  batch(() => {
    planId.value = id;
    take(state);
  });
  live = new LiveConnection<RoomMessage>({
    address: () =>
      `/api/missions/${id}/live?since=${revision.value}${and(authorQuery())}`,
    heard,
    changed: (there) => {
      connected.value = there;
      if (there) tellSelection();
    },
    gone: () => {
      tell("warn", t().frame.deleted);
      closePlan();
      history.replaceState(null, "", "#");
    },
  });
}

export function closePlan(): void {
  live?.close();
  live = null;
  batch(() => {
    planId.value = null;
    mission.value = null;
    selection.value = [];
    others.value = [];
    analysis.value = null;
    jobs.value = new Map();
    connected.value = false;
    lastRevision.value = null;
  });
}

export function select(keys: readonly string[]): void {
  selection.value = keys;
  tellSelection();
}

/** Makes edits, all of them or none. Whether they were made; if not, a notice says why. */
export function edit(...edits: LooseEdit[]): Promise<boolean> {
  return inTurn((make) => make(...edits));
}

/** Edits that depend on how the mission is when their turn comes: keys may be pressed faster than
 * the service answers. `work` is called when all edits before it are done. */
export function inTurn<T>(work: (make: typeof edit) => Promise<T>): Promise<T> {
  return queued((seen) =>
    work((...edits) => carriedOut({ kind: "edit", edits }, tellError, seen)),
  );
}

/** Makes the edits of a form, which says at the field why they were refused; null: they were made.
 * They are asked for when all edits before them are done. */
export async function editHere(edits: () => readonly LooseEdit[]): Promise<string | null> {
  let said = "";
  const refused = (error: unknown) => {
    if (error instanceof Refusal) said = messageOf(error);
    else tellError(error);
  };
  const done = await queued((seen) =>
    carriedOut({ kind: "edit", edits: edits() }, refused, seen),
  );
  return done ? null : said;
}
export function undo(): Promise<boolean> {
  return queued((seen) => carriedOut({ kind: "undo" }, tellError, seen));
}
export function redo(): Promise<boolean> {
  return queued((seen) => carriedOut({ kind: "redo" }, tellError, seen));
}
export function replaceMission(newMission: Mission, about: string): Promise<boolean> {
  const asked = { kind: "replace", mission: newMission, about } as const;
  return queued((seen) => carriedOut(asked, tellError, seen));
}

/** Commands are sent one after the other. Each is told the revision that was seen when it was asked
 * for. */
function queued<T>(work: (seen: number) => Promise<T>): Promise<T> {
  const seen = revision.value;
  waiting.value++;
  const done = queue.then(() => work(seen)).finally(() => waiting.value--);
  queue = done.catch(() => undefined);
  return done;
}

async function carriedOut(
  asked: Command,
  refused: (error: unknown) => void,
  seen: number,
): Promise<boolean> {
  const plan = planId.value;
  if (plan === null) return false;
  if (asked.kind === "edit" && asked.edits.length === 0) return true;
  const commandId = newId();
  own.add(commandId);
  let known = seen;
  while (planId.value === plan) {
    const meanwhile = othersSince(known);
    if (!apart(asked, meanwhile)) {
      tellStale(asked, meanwhile ?? []);
      return false;
    }
    known = revision.value;
    try {
      take(await sent(plan, commandId, asked, `"${revision.value}"`));
      return true;
    } catch (error) {
      if (error instanceof Unreached) {
        // It may have been carried out: the same id makes sending it again harmless.
        await new Promise((resolve) => setTimeout(resolve, RETRY_MS));
      } else if (error instanceof Refusal && error.problem.code === "stale-revision") {
        await caughtUp(plan, error.problem.since ?? null);
      } else {
        refused(error);
        return false;
      }
    }
  }
  return false;
}

function sent(plan: string, id: string, asked: Command, made: string): Promise<CommandDone> {
  return answered(
    client.POST("/api/missions/{id}/commands", {
      params: { path: { id: plan }, header: { "If-Match": made } },
      body: { id, ...asked } as never,
    }),
  );
}

/** Takes what was done meanwhile, or the whole mission where that is not known any more. */
async function caughtUp(plan: string, since: readonly Revision[] | null): Promise<void> {
  if (since !== null) for (const one of since) takeRevision(one);
  else take(await answered(client.GET("/api/missions/{id}", { params: { path: { id: plan } } })));
}

/** What others have done since a revision; null: that is not known any more. */
function othersSince(known: number): readonly Revision[] | null {
  if (known === revision.value) return [];
  if ((recent[0]?.number ?? Infinity) > known + 1) return null;
  return recent.filter((one) => one.number > known && !own.has(one.id));
}

/** Whether what others did touches nothing that the command is about. */
function apart(asked: Command, since: readonly Revision[] | null): boolean {
  if (since === null) return false;
  if (asked.kind === "replace") return since.length === 0;
  if (asked.kind !== "edit") return true;
  const about = new Set<unknown>();
  for (const one of asked.edits)
    for (const value of Object.values(one)) if (typeof value === "string") about.add(value);
  return since.every((one) => [...touched(one.change)].every((name) => !about.has(name)));
}

function tellStale(asked: Command, since: readonly Revision[]): void {
  const details = since
    .slice(-4)
    .map((one) => t().frame.changedBy(one.author, [...touched(one.change)].slice(0, 5)));
  const act = () => void queued((seen) => carriedOut(asked, tellError, seen));
  const again = { label: t().frame.doItAnyway, act };
  tell("warn", t().frame.stale, { details, actions: [again] });
}

function take(told: PlanState | CommandDone): void {
  batch(() => {
    if ("mission" in told) {
      mission.value = told.mission;
      revision.value = told.revision;
      planName.value = told.name;
      analysis.value = told.analysis ?? null;
      versions.value = told.versions;
      recent.length = 0;
      if (told.recovered) tell("warn", told.recovered);
      keepSelection();
    } else takeRevision(told.revision);
    if (!("newest" in told) || told.newest === revision.value) findings.value = told.findings;
    undoable.value = told.undoable;
    redoable.value = told.redoable;
  });
}

function takeRevision(made: Revision): void {
  if (mission.value === null || made.number !== revision.value + 1) return;
  const before = mission.value;
  recent.push(made);
  if (recent.length > MOST_RECENT) recent.shift();
  batch(() => {
    mission.value = changed(before, made.change);
    revision.value = made.number;
    lastRevision.value = made;
    keepSelection();
  });
}

function heard(message: RoomMessage): void {
  batch(() => {
    switch (message.kind) {
      case "snapshot":
        client_ = message.client;
        take(message.state);
        takeMembers(message.members);
        break;
      case "resumed":
        client_ = message.client;
        takeMembers(message.members);
        break;
      case "revision":
        if (message.revision.number <= revision.value) break;
        takeRevision(message.revision);
        if (message.findings) findings.value = message.findings;
        if (message.revision.author === (author.value || "somebody")) takeUndoable(message.revision);
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
        jobs.value = new Map(jobs.value).set(message.job.id, message.job);
        break;
      case "world":
        obstaclesChanged();
        break;
      case "deleted":
        break; // the connection ends, and says so itself
    }
  });
}

/** What the same person has done in another window can be undone here as well. */
function takeUndoable(made: Revision): void {
  if (made.kind === "edit" || made.kind === "replace") {
    undoable.value = [...undoable.value, made.number];
    redoable.value = [];
  }
}

function takeMembers(members: readonly Member[]): void {
  others.value = members.filter((member) => member.client !== client_);
}

/** Takes out of the selection what is not there any more. */
function keepSelection(): void {
  const open = mission.value;
  const keys = new Set([
    ...(open?.tasks ?? []).map((task) => taskKey(task.name)),
    ...(open?.groups ?? []).map((group) => groupKey(group.name)),
    ...(open?.reactions ?? []).map((reaction) => reactionKey(reaction.event)),
  ]);
  const there = selection.value.filter((key) => keys.has(key));
  if (there.length < selection.value.length) select(there);
}

function tellSelection(): void {
  live?.send({ kind: "select", names: selection.value.slice(0, 2_000).map(nameOfKey) });
}

function and(query: string): string {
  return query === "" ? "" : `&${query}`;
}
