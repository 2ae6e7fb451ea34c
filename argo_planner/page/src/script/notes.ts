/** Notes of the last import: unclear passages that a person has to confirm. Confirmed ones are stored in the
 * browser. */

import { effect, signal } from "@preact/signals-core";

import { answered, client, Refusal, Unreached } from "../api/client";
import type { Diagnostic } from "../api/types";
import { tell } from "../state/notices";
import { lastRevision, planId } from "../state/plan";
import { keep, kept } from "../state/session";
import { panel } from "../state/view";
import { t } from "../texts";

export interface Note {
  readonly number: number;
  readonly said: Diagnostic;
}

/** The notes that have not been confirmed in this browser. */
export const openNotes = signal<readonly Note[]>([]);

let plan: string | null = null;
let of = 0;

effect(() => {
  const id = planId.value;
  const scripted = lastRevision.value?.kind === "replace";
  if (id === plan && !scripted) return;
  const opened = id !== plan;
  plan = id;
  if (opened) openNotes.value = [];
  if (id !== null) void readNotes(id, opened);
});

/** Read the open notes; `opened`: the mission was opened just now, so a notice points to them. */
export async function readNotes(id: string, opened: boolean): Promise<void> {
  try {
    const found = await answered(
      client.GET("/api/missions/{id}/notes", { params: { path: { id } } }),
    );
    if (planId.value !== id) return;
    of = found.revision;
    const done = confirmed(id);
    openNotes.value = found.notes
      .map((said, number) => ({ number, said }))
      .filter(({ number }) => !done.has(number));
    if (opened && openNotes.value.length > 0 && panel.value !== "script")
      tell("warn", t().script.notesOpen(openNotes.value.length), {
        actions: [{ label: t().script.look, act: () => (panel.value = "script") }],
      });
  } catch (error) {
    if (!(error instanceof Refusal || error instanceof Unreached)) throw error;
  }
}

export function confirm(notes: readonly Note[]): void {
  if (plan === null) return;
  const done = confirmed(plan);
  for (const { number } of notes) done.add(number);
  keep(name(plan), JSON.stringify([...done]));
  openNotes.value = openNotes.value.filter(({ number }) => !done.has(number));
}

function confirmed(id: string): Set<number> {
  try {
    const known: unknown = JSON.parse(kept(name(id)) ?? "[]");
    return new Set(Array.isArray(known) ? known.filter((one) => typeof one === "number") : []);
  } catch {
    return new Set();
  }
}

function name(id: string): string {
  return `confirmed.${id}.${of}`;
}
