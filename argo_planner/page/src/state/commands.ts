/** What is asked of the mission that is open: edits, undone and made again, one after the other. */

import { signal } from "@preact/signals-core";

import { answered, client, newId, Refusal, Unreached } from "../api/client";
import type { CommandDone, Edit, Revision } from "../api/types";
import { touched } from "../model/change";
import { t } from "../texts";
import { messageOf, tell, tellError } from "./notices";
import { doneSince, planId, revision, take, takeRevision } from "./plan";

/** An edit of which only what is given is sent. */
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

/** How many commands wait for an answer. */
export const waiting = signal(0);

let queue: Promise<unknown> = Promise.resolve();
/** Ids of the commands that were asked for here. */
const own = new Set<string>();

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

/** What was seen when something was asked for: a mission, and its revision. */
interface Seen {
  readonly plan: string | null;
  readonly revision: number;
}

/** Commands are sent one after the other. Each is told what was seen when it was asked for. */
function queued<T>(work: (seen: Seen) => Promise<T>): Promise<T> {
  const seen = { plan: planId.value, revision: revision.value };
  waiting.value++;
  const done = queue.then(() => work(seen)).finally(() => waiting.value--);
  queue = done.catch(() => undefined);
  return done;
}

async function carriedOut(
  asked: Command,
  refused: (error: unknown) => void,
  seen: Seen,
): Promise<boolean> {
  const { plan } = seen;
  if (plan === null || planId.value !== plan) return false;
  if (asked.kind === "edit" && asked.edits.length === 0) return true;
  const commandId = newId();
  own.add(commandId);
  let known = seen.revision;
  while (planId.value === plan) {
    const meanwhile = doneSince(known)?.filter((one) => !own.has(one.id)) ?? null;
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

/** Whether what others did touches nothing that the command is about. */
function apart(asked: Command, since: readonly Revision[] | null): boolean {
  if (since === null) return false;
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
