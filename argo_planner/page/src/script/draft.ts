/** The draft of a script. It is kept until the person applies or discards it. */

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
  /** Whether a person wrote the text, and not the service. */
  readonly own: boolean;
}

/** The mission as a script, with its revision; null: not loaded. */
export const base = signal<Base | null>(null);
export const draft = signal("");
/** The diagnostics of a rejected draft, with its text. */
export const refused = signal<{ readonly text: string; readonly found: readonly Diagnostic[] } | null>(null);
/** Why the mission can't be written as a script. */
export const unsaid = signal<string | null>(null);
/** The last discarded draft, which can be restored. */
export const aside = signal<string | null>(null);
export const applying = signal(false);

export const dirty = computed(() => base.value !== null && draft.value !== base.value.text);
/** Whether the mission was changed after the draft was begun. */
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
  if (keeping !== undefined) keepDraft(); // of the previous mission
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
    // An applied draft keeps its own wording.
    if (base.value?.revision === at) return;
    if (planId.value === id && revision.value === at) takeBase({ revision: at, text, own: false });
  } catch (error) {
    if (error instanceof Refusal) unsaid.value = error.problem.detail;
    else if (!(error instanceof Unreached)) throw error;
    else waiting = setTimeout(() => void read(id, at), 4 * PAUSE_MS);
  }
}

/** Take a new script of the mission. A changed draft stays. */
function takeBase(now: Base): void {
  const first = base.value === null;
  batch(() => {
    unsaid.value = null;
    const before = first ? kept(draftName()) : null;
    if (before && before !== now.text) {
      // A stored draft of an earlier day was begun on another revision; 0 marks it as outdated.
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

/** Discard the draft for the mission's script. */
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

/** Replace the mission by the draft; `anyway`: even if the mission was changed meanwhile. */
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
      // The text keeps its wording and comments until the mission is changed in another way.
      base.value = { revision: done.revision.number, text: script, own: true };
    });
    keepDraft();
  } catch (error) {
    if (error instanceof Refusal && error.problem.diagnostics.length > 0)
      refused.value = { text: script, found: error.problem.diagnostics };
    // If the mission was changed meanwhile, the panel says so, and nothing is overwritten.
    else if (!(error instanceof Refusal && error.problem.code === "stale-revision")) tellError(error);
  } finally {
    applying.value = false;
  }
}
