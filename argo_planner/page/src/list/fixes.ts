/** Ways out of what was found, where one click is enough. */

import type { Diagnostic } from "../api/types";
import { type LooseEdit } from "../state/commands";
import { mission } from "../state/plan";
import { nameOfKey } from "../model/outline";
import { world } from "../state/world";
import { t } from "../texts";
import { keyOfSubject } from "./marks";

export interface Fix {
  readonly label: string;
  readonly edits: () => LooseEdit[];
}

/** The way out of a finding; null where it takes thought. */
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
      return {
        label: texts.removeWay,
        edits: () => [{ kind: "remove_transition", task: name, at: Number(way[1]) }],
      };
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
    case "il.never-measured":
      return neverMeasured(found);
    default:
      return null;
  }
}

/** A condition compares a checkpoint that nothing measures: measure it first. */
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
