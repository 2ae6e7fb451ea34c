/** Fixes of diagnostics that need only one click. */

import type { Diagnostic, Transition } from "../api/types";
import { type LooseEdit } from "../state/commands";
import { mission, tasksByName } from "../state/plan";
import { freeName, taskNames } from "../model/naming";
import { nameOfKey } from "../model/outline";
import { world } from "../state/world";
import { t } from "../texts";
import { keyOfSubject } from "./marks";

export interface Fix {
  readonly label: string;
  readonly edits: () => LooseEdit[];
}

/** Return the fix of a diagnostic; null: there is no simple one. */
export function fixOf(found: Diagnostic): Fix | null {
  const texts = t().list.fixes;
  const key = keyOfSubject(found.subject);
  const name = key === null ? null : nameOfKey(key);
  const way = /\.transitions\[(\d+)\]/.exec(found.subject ?? "");
  switch (found.code) {
    case "il.no-dock": {
      const dock = world.value?.docks[0];
      if (!dock) return null;
      const edits = () => [{ kind: "set_header", dock: dock.pose } as const];
      return { label: texts.chooseDock(dock.area), edits };
    }
    case "il.unknown-target":
    case "il.start-condition":
      if (name === null || way === null) return null;
      return { label: texts.removeWay, edits: removeTransition(name, Number(way[1])) };
    case "il.unknown-current":
      return { label: texts.forget, edits: () => [{ kind: "set_header", current: null }] };
    case "il.left-out":
      return { label: texts.forget, edits: () => [{ kind: "set_header", left_out: [] }] };
    case "il.endless-group":
      if (name === null) return null;
      return {
        label: texts.once,
        edits: () => [{ kind: "change_group", name, max_repeat_count: 1 }],
      };
    case "analysis.end-elsewhere":
      return driveHome(name);
    case "il.never-measured":
      return neverMeasured(found);
    default:
      return null;
  }
}

/** Let the mission end at its dock: add a task that drives there. */
function driveHome(task: string | null): Fix | null {
  const open = mission.value;
  const area = open?.end_area ?? null;
  const dock = world.value?.docks.find((one) => one.area === area);
  if (!open || !dock || open.tasks.at(-1)?.name !== task) return null;
  const name = freeName("DOCK", taskNames(open));
  return {
    label: t().list.addReturn(dock.area),
    edits: () => [{ kind: "add_task", task: { name, action: "WAYPOINT", pose: dock.pose } }],
  };
}

/** Remove the transition wherever it is when the edit is made. */
function removeTransition(task: string, at: number): () => LooseEdit[] {
  const meant = transitionsOf(task)?.[at];
  return () => {
    const now = transitionsOf(task)?.findIndex((one) => JSON.stringify(one) === JSON.stringify(meant)) ?? -1;
    return now < 0 ? [] : [{ kind: "remove_transition", task, at: now }];
  };
}

function transitionsOf(task: string): readonly Transition[] | undefined {
  return tasksByName.value.get(task)?.transitions;
}

/** Measure a checkpoint first that a condition compares and no task measures. */
function neverMeasured(found: Diagnostic): Fix | null {
  const id = /checkpoint '?#?(\d+)/.exec(found.message)?.[1];
  const first = mission.value?.tasks.find((task) => task.action !== "START");
  if (id === undefined || !first) return null;
  return {
    label: t().list.fixes.measureFirst(id),
    edits: () => [
      {
        kind: "add_task",
        task: { name: `MEASURE ${id}`, action: "MEASURE", object_id: id },
        before: first.name,
      },
    ],
  };
}
