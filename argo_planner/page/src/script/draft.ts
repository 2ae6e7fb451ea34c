/** The draft of a script. It is kept until the person applies or discards it. */

import { batch, computed, effect, signal } from "@preact/signals-core";

import { responseData, client, Refusal, Unreached } from "../api/client";
import { uploadFile } from "../api/upload";
import type { Diagnostic } from "../api/types";
import { commandId, allAnswered } from "../state/commands";
import { messageOf, showError, withErrorNotice } from "../state/notices";
import { missionHasErrors, planId, planName, revision, takePlanState } from "../state/plan";
import { storeSetting, storedSetting } from "../state/session";
import { readNotes } from "./notes";

interface Base {
  readonly revision: number;
  readonly text: string;
  /** Whether a person wrote the text, and not the service. */
  readonly own: boolean;
}

/** The mission as a script, with its revision; null: not loaded. */
export const baseScript = signal<Base | null>(null);
export const draft = signal("");
/** The diagnostics of a rejected draft, with its text. */
export const refusedDraft = signal<{
  readonly text: string;
  readonly found: readonly Diagnostic[];
  /** Whether lines are only to be confirmed or answered. */
  readonly incomplete: boolean;
} | null>(null);
/** Why the mission can't be written as a script. */
export const noScriptReason = signal<string | null>(null);
/** The last discarded draft, which can be restored. */
export const discardedDraft = signal<string | null>(null);
export const applying = signal(false);

export const draftIsChanged = computed(() => baseScript.value !== null && draft.value !== baseScript.value.text);
/** Whether the mission was changed after the draft was begun. */
export const draftIsOutdated = computed(() => draftIsChanged.value && baseScript.value?.revision !== revision.value);

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
  if (id === null || at === 0 || missionHasErrors.value || baseScript.peek()?.revision === at) return;
  waiting = setTimeout(() => void readScript(id, at), PAUSE_MS);
});

function begin(id: string | null): void {
  if (keeping !== undefined) storeDraft(); // of the previous mission
  plan = id;
  batch(() => {
    baseScript.value = refusedDraft.value = noScriptReason.value = discardedDraft.value = null;
    draft.value = "";
  });
}

async function readScript(id: string, at: number): Promise<void> {
  if (baseScript.value?.revision === at) return;
  try {
    const text = await responseData(
      client.GET("/api/missions/{id}/export/{format}", {
        params: { path: { id, format: "script" } },
        parseAs: "text",
      }),
    );
    // An applied draft keeps its own wording.
    if (baseScript.value?.revision === at) return;
    if (planId.value === id && revision.value === at) takeBase({ revision: at, text, own: false });
  } catch (error) {
    if (error instanceof Refusal) noScriptReason.value = messageOf(error);
    else if (!(error instanceof Unreached)) throw error;
    else waiting = setTimeout(() => void readScript(id, at), 4 * PAUSE_MS);
  }
}

/** Take a new script of the mission. A changed draft stays. */
function takeBase(now: Base): void {
  const first = baseScript.value === null;
  batch(() => {
    noScriptReason.value = null;
    const before = first ? storedSetting(draftName()) : null;
    if (before && before !== now.text) {
      // A stored draft of an earlier day was begun on another revision; 0 marks it as outdated.
      baseScript.value = { ...now, revision: 0 };
      draft.value = before;
    } else if (!draftIsChanged.value) {
      baseScript.value = now;
      draft.value = now.text;
      refusedDraft.value = null;
    }
  });
}

export function editDraft(text: string): void {
  draft.value = text;
  clearTimeout(keeping);
  keeping = setTimeout(storeDraft, KEPT_MS);
}

function storeDraft(): void {
  clearTimeout(keeping);
  keeping = undefined;
  if (plan !== null) storeSetting(draftName(), draftIsChanged.value ? draft.value : "");
}

function draftName(): string {
  return `draft.${plan ?? ""}`;
}

/** Discard the draft for the mission's script. */
export async function discardDraft(): Promise<void> {
  const id = planId.value;
  if (id === null) return;
  batch(() => {
    discardedDraft.value = draft.value;
    refusedDraft.value = null;
    if (baseScript.value) draft.value = baseScript.value.text;
  });
  storeDraft();
  if (baseScript.value?.revision !== revision.value) await readScript(id, revision.value);
}

export function restoreDraft(): void {
  const text = discardedDraft.value;
  if (text === null) return;
  discardedDraft.value = null;
  editDraft(text);
}

/** Replace the mission by the draft; `anyway`: even if the mission was changed meanwhile. */
export async function applyDraft(anyway = false): Promise<void> {
  const id = planId.value;
  const from = baseScript.value;
  const script = draft.value;
  if (id === null || from === null || applying.value) return;
  const on = anyway ? revision.value : from.revision;
  applying.value = true;
  await allAnswered();
  try {
    const done = await responseData(
      client.PUT("/api/missions/{id}/script", {
        params: { path: { id }, header: { "If-Match": `"${on}"` } },
        body: { id: commandId(), script },
      }),
    );
    if (planId.value !== id) return;
    takePlanState(done);
    void readNotes(id, false);
    batch(() => {
      refusedDraft.value = null;
      // The text keeps its wording and comments until the mission is changed in another way.
      baseScript.value = { revision: done.revision.number, text: script, own: true };
    });
    storeDraft();
  } catch (error) {
    const incomplete = error instanceof Refusal && error.problem.code === "incomplete";
    if (error instanceof Refusal && (incomplete || error.problem.diagnostics.length > 0))
      refusedDraft.value = { text: script, found: error.problem.diagnostics, incomplete };
    // If the mission was changed meanwhile, the panel says so, and nothing is overwritten.
    else if (!(error instanceof Refusal && error.problem.code === "stale-revision")) showError(error);
  } finally {
    applying.value = false;
  }
}

/** Open the text as a draft to decide on line by line. It becomes a mission of its own. */
export async function decideLineByLine(): Promise<void> {
  storeDraft();
  await withErrorNotice(async () => {
    const made = await responseData(uploadFile(`${planName.value}.txt`, draft.value));
    location.hash = "lines" in made ? `#/drafts/${made.id}` : `#/missions/${made.id}`;
  });
}
