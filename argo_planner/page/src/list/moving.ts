/** Moving the selection: beside a row, by one step, out of a group and into one. */

import { mission, selection } from "../state/plan";
import { editInTurn } from "../state/commands";
import { moveEdits, stepTarget, type Side } from "../model/task-positions";
import type { Row } from "../model/outline";
import { allRows, shownRows } from "./rows";

interface Target {
  readonly target: Row;
  readonly side: Side;
}

/** Move the selection beside a row. Returns whether it was moved. */
export function moveTo(target: Row, side: Side): Promise<boolean> {
  return moveSelection(() => ({ target, side }));
}

export function moveByStep(direction: "up" | "down"): Promise<boolean> {
  return moveSelection(() => stepTarget(shownRows.value, selection.value, direction));
}

/** Move the selection out of its group, to the position after it. */
export function leaveGroup(): Promise<boolean> {
  return moveSelection(() => {
    const row = allRows.value.find((one) => one.key === selection.value.at(-1));
    const target = allRows.value.find(
      (one) => one.kind === "group" && one.group.name === row?.inside,
    );
    return target ? { target, side: "after" } : null;
  });
}

/** Move the selection to the end of the group right above, or to the beginning of the one right below. */
export function enterGroup(): Promise<boolean> {
  return moveSelection(() => {
    const all = allRows.value;
    const first = all.findIndex((one) => selection.value.includes(one.key));
    const last = all.findLastIndex((one) => selection.value.includes(one.key));
    const [above, here, below] = [all[first - 1], all[first], all[last + 1]];
    if (above && here && above.depth > here.depth) return { target: above, side: "after" };
    return below?.kind === "group" ? { target: below, side: "into" } : null;
  });
}

/** Move the selection beside the row that `find` returns when the edit's turn comes. */
function moveSelection(find: () => Target | null): Promise<boolean> {
  return editInTurn(async (make) => {
    const open = mission.value;
    const found = find();
    if (open === null || found === null) return false;
    const target = allRows.value.find((row) => row.key === found.target.key);
    if (!target) return false;
    return make(...moveEdits(open, allRows.value, selection.value, target, found.side));
  });
}
