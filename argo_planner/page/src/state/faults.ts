/** The faults that a person has chosen for the next run and the next evaluation of the open mission. */

import { batch, computed, effect, signal, type Signal } from "@preact/signals-core";

import { client, responseData } from "../api/client";
import type { FaultDescription } from "../api/types";
import { placedAt, placeForm, type FaultClick, type FaultDraft } from "../model/faults";
import { dependOn } from "./depend-on";
import { withErrorNotice } from "./notices";
import { planId } from "./plan";
import { pastRun } from "./run";
import { panel, tool } from "./view";
import { world } from "./world";

export type FaultList = "run" | "evaluate";

/** Kinds of faults by name; empty until they are read. */
export const faultDescriptions = signal<ReadonlyMap<string, FaultDescription>>(new Map());
const chosen: Readonly<Record<FaultList, Signal<readonly FaultDraft[]>>> = { run: signal([]), evaluate: signal([]) };
/** The fault whose fields are shown; null: none. */
export const openedFault = signal<{ readonly list: FaultList; readonly index: number } | null>(null);
/** The fault that the next click in the site gives a place; `corner`: the first corner of its area. */
export const placingFault = signal<{
  readonly list: FaultList;
  readonly index: number;
  readonly corner: readonly [number, number, number] | null;
} | null>(null);

// What a person has chosen for one mission does not belong to the next one.
effect(() => {
  dependOn(planId);
  batch(() => {
    chosen.run.value = chosen.evaluate.value = [];
    openedFault.value = placingFault.value = null;
  });
});
// Another tool or panel ends the placing.
effect(() => {
  const list = panel.value;
  if (tool.value !== "fault") placingFault.value = null;
  else if (placingFault.peek()?.list !== list) stopPlacing();
});

/** How the next click gives a fault its place; null: it gives none. */
export const placingForm = computed(() => {
  const placing = placingFault.value;
  const description = placing && faultDescriptions.value.get(faultsOf(placing.list)[placing.index]?.kind ?? "");
  return description ? placeForm(description) : null;
});

/** The list whose faults the open panel shows; null: it shows none. */
export const shownFaultList = computed<FaultList | null>(() => {
  if (panel.value === "evaluate") return "evaluate";
  return panel.value === "run" && pastRun.value === null ? "run" : null;
});

export function faultsOf(list: FaultList): readonly FaultDraft[] {
  return chosen[list].value;
}

/** Read the kinds of faults once. */
export async function readFaultKinds(): Promise<void> {
  if (faultDescriptions.peek().size > 0) return;
  await withErrorNotice(async () => {
    const { kinds } = await responseData(client.GET("/api/faults"));
    faultDescriptions.value = new Map(kinds.map((one) => [one.kind, one]));
  });
}

/** Add a fault of a kind, and show its fields. */
export function addFault(list: FaultList, kind: string): void {
  batch(() => {
    openedFault.value = { list, index: faultsOf(list).length };
    chosen[list].value = [...faultsOf(list), { kind }];
  });
}

export function removeFault(list: FaultList, index: number): void {
  batch(() => {
    stopPlacing();
    openedFault.value = null;
    chosen[list].value = faultsOf(list).filter((_, other) => other !== index);
  });
}

export function replaceFault(list: FaultList, index: number, fault: FaultDraft): void {
  chosen[list].value = faultsOf(list).map((one, at) => (at === index ? fault : one));
}

/** Let the next click in the site give a fault its place. */
export function beginPlacing(list: FaultList, index: number): void {
  batch(() => {
    placingFault.value = { list, index, corner: null };
    tool.value = "fault";
  });
}

export function stopPlacing(): void {
  if (tool.peek() === "fault") tool.value = "select";
  placingFault.value = null;
}

/** Give the fault its place, or the first corner of its area. */
export function placeFault(click: FaultClick): void {
  const placing = placingFault.value;
  const site = world.value;
  const fault = placing && faultsOf(placing.list)[placing.index];
  const description = fault && faultDescriptions.value.get(fault.kind);
  if (!placing || !fault || !description || site === null) return;
  if (placeForm(description) === "area" && placing.corner === null) {
    placingFault.value = { ...placing, corner: click.point };
    return;
  }
  const placed = placedAt(fault, description, click, placing.corner, site);
  if (placed === null) return;
  batch(() => {
    replaceFault(placing.list, placing.index, placed);
    stopPlacing();
  });
}

