/** The script that somebody is writing. It is theirs until it is applied: nothing takes it away. */

import { batch, computed, effect, signal } from "@preact/signals-core";

import { answered, client, Refusal, Unreached } from "../api/client";
import type { Diagnostic } from "../api/types";
import { commandId, settled } from "../state/commands";
import { tellError } from "../state/notices";
import { broken, planId, revision, take } from "../state/plan";
import { keep, kept } from "../state/session";
import { readNotes } from "./notes";

interface Base {
  readonly revision: number;
  readonly text: string;
  /** Whether it is what somebody has written, and not the service. */
  readonly own: boolean;
}

/** The mission as a script, and of which revision; null: not read yet. */
export const base = signal<Base | null>(null);
export const draft = signal("");
/** What the service said of the draft that it refused. */
export const refused = signal<{ readonly text: string; readonly found: readonly Diagnostic[] } | null>(null);
/** Why the mission can't be said as a script. */
export const unsaid = signal<string | null>(null);
/** A text that was put aside for the one of the mission. */
export const aside = signal<string | null>(null);
export const applying = signal(false);

export const dirty = computed(() => base.value !== null && draft.value !== base.value.text);
/** Whether the mission was changed since the draft was begun. */
export const overtaken = computed(() => dirty.value && base.value?.revision !== revision.value);

const PAUSE_MS = 300;
const KEPT_MS = 500;
let plan: string | null = null;
let waiting: ReturnType<typeof setTimeout> | undefined;
let keeping: ReturnType<typeof setTimeout> | undefined;

effect(() => {
  const id = planId.value;
  const at = revision.value;
  clearTimeout(waiting);
  if (id !== plan) begin(id);
  if (id === null || at === 0 || broken.value || base.peek()?.revision === at) return;
  waiting = setTimeout(() => void read(id, at), PAUSE_MS);
});

function begin(id: string | null): void {
  if (keeping !== undefined) keepDraft(); // of the mission that was open
  plan = id;
  batch(() => {
    base.value = refused.value = unsaid.value = aside.value = null;
    draft.value = "";
  });
}

async function read(id: string, at: number): Promise<void> {
  if (base.value?.revision === at) return;
  try {
    const text = await answered(
      client.GET("/api/missions/{id}/export/{format}", {
        params: { path: { id, format: "script" } },
        parseAs: "text",
      }),
    );
    // What was applied meanwhile keeps its own words.
    if (base.value?.revision === at) return;
    if (planId.value === id && revision.value === at) takeBase({ revision: at, text, own: false });
  } catch (error) {
    if (error instanceof Refusal) unsaid.value = error.problem.detail;
    else if (!(error instanceof Unreached)) throw error;
    else waiting = setTimeout(() => void read(id, at), 4 * PAUSE_MS);
  }
}

/** The mission reads like this now. What somebody is writing stays. */
function takeBase(now: Base): void {
  const first = base.value === null;
  batch(() => {
    unsaid.value = null;
    const before = first ? kept(draftName()) : null;
    if (before && before !== now.text) {
      // From another day: it goes on with the revision that it was begun on, which is not this one.
      base.value = { ...now, revision: 0 };
      draft.value = before;
    } else if (!dirty.value) {
      base.value = now;
      draft.value = now.text;
      refused.value = null;
    }
  });
}

export function write(text: string): void {
  draft.value = text;
  clearTimeout(keeping);
  keeping = setTimeout(keepDraft, KEPT_MS);
}

function keepDraft(): void {
  clearTimeout(keeping);
  keeping = undefined;
  if (plan !== null) keep(draftName(), dirty.value ? draft.value : "");
}

function draftName(): string {
  return `draft.${plan ?? ""}`;
}

/** Takes the mission's script in place of the draft, which is put aside. */
export async function takeTheirs(): Promise<void> {
  const id = planId.value;
  if (id === null) return;
  batch(() => {
    aside.value = draft.value;
    refused.value = null;
    if (base.value) draft.value = base.value.text;
  });
  keepDraft();
  if (base.value?.revision !== revision.value) await read(id, revision.value);
}

export function takeAside(): void {
  const text = aside.value;
  if (text === null) return;
  aside.value = null;
  write(text);
}

/** Puts what the draft says in place of the mission; `anyway`: whatever was changed meanwhile. */
export async function apply(anyway = false): Promise<void> {
  const id = planId.value;
  const from = base.value;
  const script = draft.value;
  if (id === null || from === null || applying.value) return;
  const on = anyway ? revision.value : from.revision;
  applying.value = true;
  await settled();
  try {
    const done = await answered(
      client.PUT("/api/missions/{id}/script", {
        params: { path: { id }, header: { "If-Match": `"${on}"` } },
        body: { id: commandId(), script },
      }),
    );
    if (planId.value !== id) return;
    take(done);
    void readNotes(id, false);
    batch(() => {
      refused.value = null;
      // Its own words and remarks stay until the mission is changed in another way.
      base.value = { revision: done.revision.number, text: script, own: true };
    });
    keepDraft();
  } catch (error) {
    if (error instanceof Refusal && error.problem.diagnostics.length > 0)
      refused.value = { text: script, found: error.problem.diagnostics };
    // Where it was changed meanwhile, the panel says so, and nothing is overwritten.
    else if (!(error instanceof Refusal && error.problem.code === "stale-revision")) tellError(error);
  } finally {
    applying.value = false;
  }
}
