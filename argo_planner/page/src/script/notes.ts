/** Notes of the last import: unclear passages that a person has to confirm. Confirmed ones are stored in the
 * browser. */

import { effect, signal } from "@preact/signals-core";

import { responseData, client, Refusal, Unreached } from "../api/client";
import type { Diagnostic } from "../api/types";
import { showNotice } from "../state/notices";
import { lastRevision, planId } from "../state/plan";
import { storeSetting, storedSetting } from "../state/session";
import { panel } from "../state/view";
import { t } from "../texts";

export interface Note {
  readonly number: number;
  readonly said: Diagnostic;
}

/** The notes that have not been confirmed in this browser. */
export const openNotes = signal<readonly Note[]>([]);

let plan: string | null = null;
let notesRevision = 0;

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
    const found = await responseData(
      client.GET("/api/missions/{id}/notes", { params: { path: { id } } }),
    );
    if (planId.value !== id) return;
    notesRevision = found.revision;
    const done = confirmedNumbers(id);
    openNotes.value = found.notes
      .map((said, number) => ({ number, said }))
      .filter(({ number }) => !done.has(number));
    if (opened && openNotes.value.length > 0 && panel.value !== "script")
      showNotice("warn", t().script.notesOpen(openNotes.value.length), {
        actions: [{ label: t().script.look, act: () => (panel.value = "script") }],
      });
  } catch (error) {
    if (!(error instanceof Refusal || error instanceof Unreached)) throw error;
  }
}

export function confirmNotes(notes: readonly Note[]): void {
  if (plan === null) return;
  const done = confirmedNumbers(plan);
  for (const { number } of notes) done.add(number);
  storeSetting(storageName(plan), JSON.stringify([...done]));
  openNotes.value = openNotes.value.filter(({ number }) => !done.has(number));
}

function confirmedNumbers(id: string): Set<number> {
  try {
    const known: unknown = JSON.parse(storedSetting(storageName(id)) ?? "[]");
    return new Set(Array.isArray(known) ? known.filter((one) => typeof one === "number") : []);
  } catch {
    return new Set();
  }
}

function storageName(id: string): string {
  return `confirmed.${id}.${notesRevision}`;
}
