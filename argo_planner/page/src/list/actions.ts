/** Actions on the selection: group, delete, rename, copy, paste. */

import type { Group, Mission, Reaction } from "../api/types";
import { copiedText, pasteEdits, parseCopied } from "../model/clipboard";
import { freeName } from "../model/naming";
import { groupKey, nameOfKey, ownName, taskKey, type Row } from "../model/outline";
import { groupsOf, positionForNew, tasksOf } from "../model/task-positions";
import { edit, editInTurn } from "../state/commands";
import { showNotice } from "../state/notices";
import { mission, select, selection } from "../state/plan";
import { mayPlan } from "../state/session";
import { panel } from "../state/view";
import { t } from "../texts";
import { allRows, shownRows } from "./rows";

/** Group the selection and open the details of the group. */
export function groupSelection(): Promise<void> {
  return editInTurn(async (make) => {
    const open = mission.value;
    if (open === null || !mayPlan() || selection.value.length === 0) return;
    const tasks = tasksOf(open, allRows.value, selection.value);
    const [first, last] = [tasks[0], tasks.at(-1)];
    if (!first || !last) return;
    if (open.tasks.indexOf(last) - open.tasks.indexOf(first) + 1 !== tasks.length) {
      showNotice("warn", t().list.notTogether);
      return;
    }
    const row = allRows.value.find((one) => one.key === selection.value[0]);
    const inside = row?.inside ? `${row.inside}/` : "";
    const taken = new Set(open.groups.map((group) => group.name));
    const wanted = inside + t().list.newGroup;
    const whole = freeName(wanted, taken, (number) => `${wanted} ${number}`);
    const name = whole.slice(inside.length);
    const group = { name, start: first.name, end: last.name, max_repeat_count: 1 };
    if (!(await make({ kind: "wrap_tasks", group }))) return;
    select([groupKey(whole)]);
    openDetails(t().forms.duration);
  });
}

/** Delete the selection when its turn comes, and select the next row. */
export function deleteSelection(): Promise<void> {
  return editInTurn(async (make) => {
    const open = mission.value;
    const keys = selection.value;
    if (open === null || keys.length === 0) return;
    const shown = shownRows.value;
    const reactions = keys.filter((key) => key.startsWith("reaction:")).map(nameOfKey);
    const tasks = tasksOf(open, allRows.value, keys).map((task) => task.name);
    const first = shown.findIndex((row) => keys.includes(row.key));
    const last = shown.findLastIndex((row) => keys.includes(row.key));
    const stays = (row: Row) => row.kind === "task" && !tasks.includes(row.task.name);
    const next = shown.slice(last + 1).find(stays) ?? shown.slice(0, Math.max(0, first)).findLast(stays);
    const done = await make(
      ...emptiedGroups(open, tasks).map((name) => ({ kind: "dissolve_group", name }) as const),
      ...tasks.map((name) => ({ kind: "remove_task", name }) as const),
      ...reactions.map(
        (event) => ({ kind: "remove_reaction", event: event as Reaction["event"] }) as const,
      ),
    );
    if (done && next) select([next.key]);
  });
}

/** Return the groups that would become empty, the inner ones first. They are dissolved, so that their tasks
 * can be removed one by one. */
function emptiedGroups(open: Mission, gone: readonly string[]): string[] {
  const away = new Set(gone);
  const at = new Map(open.tasks.map((task, index) => [task.name, index]));
  const isEmptied = ({ start, end }: Group) =>
    open.tasks.slice(at.get(start), (at.get(end) ?? -1) + 1).every((task) => away.has(task.name));
  const depth = (name: string) => name.split("/").length;
  return open.groups
    .filter(isEmptied)
    .map((group) => group.name)
    .sort((a, b) => depth(b) - depth(a));
}

/** Rename a task or a group and select it. Returns whether it has the new name. */
export function renameRow(row: Row, name: string): Promise<boolean> {
  if (row.kind === "task") {
    const old = row.task.name;
    if (name === "" || name === old) return Promise.resolve(true);
    return edit({ kind: "rename_task", name: old, new_name: name });
  }
  const whole = row.group.name;
  const old = ownName(whole);
  if (name === "" || name === old) return Promise.resolve(true);
  return edit({ kind: "rename_group", name: whole, own_name: name });
}

/** Return the selected tasks as text; null: none are selected. */
export function copySelection(): string | null {
  const open = mission.value;
  const tasks = open === null ? [] : tasksOf(open, allRows.value, selection.value);
  if (tasks.length === 0) return null;
  showNotice("info", t().list.copiedCount(tasks.length));
  return copiedText({ tasks, groups: open === null ? [] : groupsOf(open, selection.value) });
}

/** Add the tasks of a copied text after the selection. */
export function pasteTasks(text: string): Promise<void> {
  return editInTurn(async (make) => {
    const open = mission.value;
    const found = parseCopied(text);
    if (open === null || found === null) {
      showNotice("info", t().list.nothingToPaste);
      return;
    }
    const { edits, names } = pasteEdits(open, found, positionForNew(allRows.value, selection.value));
    if (await make(...edits)) select(names.map(taskKey));
  });
}

/** Open the details of the selection, with the cursor in a field. */
export function openDetails(label?: string): void {
  panel.value = "properties";
  // The panel is rendered first.
  setTimeout(() => dispatchEvent(new CustomEvent("open-details", { detail: label })));
}
