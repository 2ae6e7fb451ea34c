/** Keyboard shortcuts of the list. */

import { groupKey } from "../model/outline";
import { select, selection } from "../state/plan";
import { mayPlan } from "../state/session";
import { deleteSelection, openDetails } from "./actions";
import { enterGroup, leaveGroup, moveByStep } from "./moving";
import { chooseRow, setFolded, folded, shownRows } from "./rows";

/** Handle a key of the list; `page` is the number of visible rows. Returns whether the key was handled. */
export function onListKey(event: KeyboardEvent, page: number): boolean {
  if (event.altKey) return onMovingKey(event.key);
  if (event.ctrlKey || event.metaKey) {
    if (event.key.toLowerCase() !== "a") return false;
    select(shownRows.value.map((one) => one.key));
    return true;
  }
  return onGoingKey(event, page) || onFoldingKey(event.key) || onActingKey(event.key);
}

function onMovingKey(key: string): boolean {
  const move = {
    ArrowUp: () => moveByStep("up"),
    ArrowDown: () => moveByStep("down"),
    ArrowLeft: leaveGroup,
    ArrowRight: enterGroup,
  }[key];
  if (move === undefined) return false;
  if (mayPlan()) void move();
  return true;
}

function onGoingKey(event: KeyboardEvent, page: number): boolean {
  const shown = shownRows.value;
  const at = shown.findIndex((row) => row.key === selection.value.at(-1));
  const to = {
    ArrowDown: at + 1,
    ArrowUp: at < 0 ? shown.length - 1 : at - 1,
    Home: 0,
    End: shown.length - 1,
    PageDown: at + page,
    PageUp: at - page,
  }[event.key];
  if (to === undefined) return false;
  const row = shown[Math.max(0, Math.min(shown.length - 1, to))];
  if (row) chooseRow(row, event.shiftKey, false);
  return true;
}

/** Handle the right arrow, which unfolds a group and then enters it, and the left arrow, which folds it or
 * goes to the outer group. */
function onFoldingKey(key: string): boolean {
  if (key !== "ArrowRight" && key !== "ArrowLeft") return false;
  const shown = shownRows.value;
  const at = shown.findIndex((row) => row.key === selection.value.at(-1));
  const row = shown[at];
  const open = row?.kind === "group" && !folded.value.has(row.key);
  if (key === "ArrowRight") {
    const next = shown[at + 1];
    if (row?.kind === "group" && !open) setFolded(row, false);
    else if (open && next) select([next.key]);
  } else if (row && open) setFolded(row, true);
  else if (row?.inside) select([groupKey(row.inside)]);
  return true;
}

function onActingKey(key: string): boolean {
  if (key === "Enter") openDetails();
  else if (key !== "Delete" && key !== "Backspace") return false;
  else if (mayPlan()) void deleteSelection();
  return true;
}
