/** What people do with missions in the list. */

import { client, Refusal, responseData } from "../api/client";
import type { PlanSummary } from "../api/types";
import { freeName } from "../model/naming";
import { messageOf, showError, showNotice, withErrorNotice } from "../state/notices";
import { t } from "../texts";
import { missions, readHome } from "./state";

const LONGEST_NAME = 200;

/** Return a name that no mission has, made from another one. */
function freeMissionName(name: string): string {
  const taken = new Set((missions.value ?? []).map((one) => one.name));
  const cut = (text: string, room: number) => Array.from(text).slice(0, LONGEST_NAME - room).join("");
  return freeName(cut(name, 0), taken, (number) => `${cut(name, 8)} ${number}`);
}

/** Do something with missions, and read the list again. */
async function changeList(work: () => Promise<unknown>): Promise<void> {
  await withErrorNotice(work);
  await withErrorNotice(readHome);
}

/** Create an empty mission, and open it. */
export async function createMission(): Promise<void> {
  const name = freeMissionName(t().frame.untitled);
  await withErrorNotice(async () => open(await responseData(client.POST("/api/missions", { body: { name } }))));
}

/** Create a mission from an example, and open it. */
export async function openExample(example: string, title: string): Promise<void> {
  const [path, name] = [{ example }, freeMissionName(title)];
  await withErrorNotice(async () =>
    open(await responseData(client.POST("/api/examples/{example}/mission", { params: { path }, body: { name } }))),
  );
}

/** Create a copy of a mission, and open it. */
export async function copyMission(one: PlanSummary): Promise<void> {
  const path = { id: one.id };
  const name = freeMissionName(t().frame.copyOf(one.name));
  await withErrorNotice(async () =>
    open(await responseData(client.POST("/api/missions/{id}/duplicate", { params: { path }, body: { name } }))),
  );
}

function open({ id }: PlanSummary): void {
  location.hash = `#/missions/${id}`;
}

/** Move a mission to the bin, and offer to restore it. */
export function binMission(one: PlanSummary): Promise<void> {
  return changeList(async () => {
    await responseData(client.DELETE("/api/missions/{id}", { params: { path: { id: one.id } } }) as never);
    const back = { label: t().frame.undo, act: () => void restoreMission(one) };
    showNotice("info", t().frame.deletedOne(one.name), { actions: [back] });
  });
}

export function restoreMission(one: PlanSummary): Promise<void> {
  return changeList(() => responseData(client.POST("/api/bin/{id}/restore", { params: { path: { id: one.id } } })));
}

/** Move a mission to a folder (empty: to none), and offer to move it back. If somebody else has moved it since it
 * was seen in `seen`, it stays there, and the person may move it nevertheless; null: move it from anywhere. */
export async function fileMission(one: PlanSummary, folder: string, seen: string | null = one.folder): Promise<void> {
  const texts = t().home;
  try {
    await responseData(
      client.PUT("/api/missions/{id}/folder", { params: { path: { id: one.id } }, body: { folder, seen } }),
    );
    const back = { label: t().frame.undo, act: () => void fileMission(one, one.folder, folder) };
    const text = folder === "" ? texts.unfiled(one.name) : texts.filed(one.name, folder);
    showNotice("info", text, { actions: [back] });
  } catch (error) {
    if (!(error instanceof Refusal) || error.problem.code !== "filed-since") showError(error);
    else {
      const anyway = { label: t().frame.doItAnyway, act: () => void fileMission(one, folder, null) };
      showNotice("warn", texts.filedSince(one.name), { details: [messageOf(error)], actions: [anyway] });
    }
  }
  await withErrorNotice(readHome);
}
