/** Commands to the open mission: edits, undo and redo, sent one after the other. */

import { signal } from "@preact/signals-core";

import { responseData, client, newId, delay, Refusal, Unreached } from "../api/client";
import type { CommandDone, Edit, Revision } from "../api/types";
import { changedNames, changedHeaderFields } from "../model/change";
import { t } from "../texts";
import { messageOf, showNotice, showError, reasonOfFailure, withErrorNotice } from "./notices";
import { revisionsSince, planId, revision, takePlanState, takeRevision } from "./plan";

/** An edit of which optional fields may be left out. */
export type LooseEdit = Edit extends infer One
  ? One extends { readonly kind?: infer Kind }
    ? { readonly kind: NonNullable<Kind> } & Partial<Loose<Omit<One, "kind">>>
    : never
  : never;
type Loose<T> = { [key in keyof T]: T[key] extends object | null | undefined ? unknown : T[key] };

type Command =
  | { readonly kind: "edit"; readonly edits: readonly LooseEdit[] }
  | { readonly kind: "undo" | "redo" };

const RETRY_MS = 1_000;

/** Number of commands without an answer. */
export const waiting = signal(0);

let queue: Promise<unknown> = Promise.resolve();
/** Ids of this page's commands. */
const own = new Set<string>();

/** Create the id of a command of this page. */
export function commandId(): string {
  const id = newId();
  own.add(id);
  return id;
}

/** Return whether a revision was made by this page. */
export function isOwn(made: Revision): boolean {
  return own.has(made.id);
}

/** Wait until all commands so far are answered. */
export async function allAnswered(): Promise<void> {
  await queue;
}

/** Send a request about the open mission, once all edits are answered. Returns whether it succeeded;
 * otherwise a notice gives the reason. */
export async function withPlan(work: (id: string) => Promise<unknown>): Promise<boolean> {
  const id = planId.value;
  if (id === null) return false;
  await allAnswered();
  return withErrorNotice(() => work(id));
}

/** As `withPlan`, but returns the reason of a failure, for the place that it is about; null: it succeeded. */
export async function tryWithPlan(work: (id: string) => Promise<unknown>): Promise<string | null> {
  const id = planId.value;
  if (id === null) return null;
  await allAnswered();
  return reasonOfFailure(() => work(id));
}

/** Make edits, all of them or none. Returns whether they were made; otherwise a notice gives the reason. */
export function edit(...edits: LooseEdit[]): Promise<boolean> {
  return editInTurn((make) => make(...edits));
}

/** Make edits that depend on the mission's state when their turn comes: keys may be pressed faster than the
 * service answers. `work` is called when all earlier edits are done. */
export function editInTurn<T>(work: (make: typeof edit) => Promise<T>): Promise<T> {
  return enqueue((seen) =>
    work((...edits) => carryOut({ kind: "edit", edits }, showError, seen)),
  );
}

/** Make the edits of a form, when all earlier edits are done. Returns the reason of a refusal, for the field;
 * null: they were made. */
export async function editFromForm(edits: () => readonly LooseEdit[]): Promise<string | null> {
  let reason = "";
  const refused = (error: unknown) => {
    if (error instanceof Refusal) reason = messageOf(error);
    else showError(error);
  };
  const done = await enqueue((seen) =>
    carryOut({ kind: "edit", edits: edits() }, refused, seen),
  );
  return done ? null : reason;
}
export function undo(): Promise<boolean> {
  return enqueue((seen) => carryOut({ kind: "undo" }, showError, seen));
}
export function redo(): Promise<boolean> {
  return enqueue((seen) => carryOut({ kind: "redo" }, showError, seen));
}

/** The mission and revision that the person saw when giving a command. */
interface SeenState {
  readonly plan: string | null;
  readonly revision: number;
}

/** Run commands one after the other. Each gets the state that the person saw when giving it. */
function enqueue<T>(work: (seen: SeenState) => Promise<T>): Promise<T> {
  const seen = { plan: planId.value, revision: revision.value };
  waiting.value++;
  const done = queue.then(() => work(seen)).finally(() => waiting.value--);
  queue = done.catch(() => undefined);
  return done;
}

async function carryOut(
  asked: Command,
  refused: (error: unknown) => void,
  { plan, revision: seen }: SeenState,
): Promise<boolean> {
  if (plan === null || planId.value !== plan) return false;
  if (asked.kind === "edit" && asked.edits.length === 0) return true;
  const id = commandId();
  let known = seen;
  while (planId.value === plan) {
    const meanwhile = revisionsSince(known)?.filter((one) => !isOwn(one)) ?? null;
    if (!isIndependent(asked, meanwhile)) {
      showConflict(asked, meanwhile ?? [], plan);
      return false;
    }
    known = revision.value;
    try {
      await sendOnce(plan, id, asked);
      return true;
    } catch (error) {
      // The command may have been carried out: with the same id it can safely be sent again.
      if (error instanceof Unreached) {
        showNotice("warn", t().frame.offline);
        await delay(RETRY_MS);
      } else if (!isStale(error)) {
        refused(error);
        return false;
      }
    }
  }
  return false;
}

/** Send a command once. If it is stale, take the missed revisions before throwing that error. */
async function sendOnce(plan: string, id: string, asked: Command): Promise<void> {
  try {
    const done = await postCommand(plan, id, asked, `"${revision.value}"`);
    if (planId.value === plan) takePlanState(done);
  } catch (error) {
    if (isStale(error)) await catchUp(plan, error.problem.since ?? null);
    throw error;
  }
}

function isStale(error: unknown): error is Refusal {
  return error instanceof Refusal && error.problem.code === "stale-revision";
}

function postCommand(plan: string, id: string, asked: Command, made: string): Promise<CommandDone> {
  return responseData(
    client.POST("/api/missions/{id}/commands", {
      params: { path: { id: plan }, header: { "If-Match": made } },
      body: { id, ...asked } as never,
    }),
  );
}

/** Take the missed revisions, or the whole mission if they are no longer known. */
async function catchUp(plan: string, since: readonly Revision[] | null): Promise<void> {
  const state =
    since === null
      ? await responseData(client.GET("/api/missions/{id}", { params: { path: { id: plan } } }))
      : null;
  if (planId.value !== plan) return;
  if (state !== null) takePlanState(state);
  else for (const one of since ?? []) takeRevision(one);
}

/** Return whether the revisions of others touch nothing that the command is about. */
function isIndependent(asked: Command, since: readonly Revision[] | null): boolean {
  if (since === null) return false;
  if (asked.kind !== "edit") return true;
  const names = new Set<unknown>();
  const fields = new Set<string>();
  for (const one of asked.edits) {
    for (const value of Object.values(one)) if (typeof value === "string") names.add(value);
    if (one.kind === "wrap_tasks") {
      const { start, end } = one.group as { start?: string; end?: string };
      names.add(start).add(end);
    }
    if (one.kind === "set_header") for (const field of Object.keys(one)) fields.add(field);
  }
  return since.every(
    ({ change }) =>
      [...changedNames(change)].every((name) => !names.has(name)) &&
      [...changedHeaderFields(change)].every((field) => !fields.has(field)),
  );
}

function showConflict(asked: Command, since: readonly Revision[], plan: string): void {
  const details = since.slice(-4).map(({ author, change }) => {
    const what = [...changedNames(change)].slice(0, 5);
    if (changedHeaderFields(change).size > 0) what.push(t().frame.missionItself);
    return t().frame.changedBy(author, what);
  });
  const act = () =>
    void enqueue((seen) => {
      if (seen.plan === plan) return carryOut(asked, showError, seen);
      showNotice("warn", t().frame.otherMission);
      return Promise.resolve(false);
    });
  showNotice("warn", t().frame.stale, { details, actions: [{ label: t().frame.doItAnyway, act }] });
}
