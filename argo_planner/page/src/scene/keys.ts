/** Keys while the scene has the focus. */

import { liftGhost, beginGhostAt, FAST_CELLS, ghost, hideGhost, moveGhost, turnGhost } from "./navigate";
import { beginCorner, corners, liftCorner, moveCorner, setPointedCorner } from "./obstacle-tool";
import { stopPlacing } from "../state/faults";
import { shownFloor, tool } from "../state/view";
import { world } from "../state/world";
import { Vector3 } from "three";
import type { SceneView } from "./view";

export interface Keyed {
  readonly view: SceneView;
  readonly place: () => void;
}

const ARROWS: Readonly<Record<string, readonly [number, number]>> = {
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
};

/** Handle a key of the scene. Returns whether it was handled. */
export function onSceneKey(event: KeyboardEvent, { view, place }: Keyed): boolean {
  if (event.ctrlKey || event.metaKey || event.altKey) return false;
  const arrow = ARROWS[event.key];
  const navigates = tool.value === "navigate";
  const spans = tool.value === "obstacle" && !corners.value?.second;
  const cells = event.shiftKey ? FAST_CELLS : 1;
  if (event.key === "Escape" && tool.value === "fault") stopPlacing();
  else if (arrow && navigates) {
    begin(view);
    step(view, arrow, cells, moveGhost);
  } else if (arrow && spans) {
    const middle = middleOf(view);
    if (middle) beginCorner(middle);
    step(view, arrow, cells, moveCorner);
  } else if (arrow) view.camera.key(event.key, true, event.shiftKey);
  else if (event.key === "PageUp") changeFloor(view, 1);
  else if (event.key === "PageDown") changeFloor(view, -1);
  else if (navigates && event.key === ",") turn(view, 1);
  else if (navigates && event.key === ".") turn(view, -1);
  else if (navigates && event.key === "Enter" && ghost.value !== null) place();
  else if (spans && event.key === "Enter") setPointedCorner();
  else if (event.key === "+" || event.key === "=") view.camera.zoom(1);
  else if (event.key === "-") view.camera.zoom(-1);
  else if (event.key === "Home") void view.camera.showAll(shownFloor.value);
  else return false;
  return true;
}

function turn(view: SceneView, steps: number): void {
  begin(view);
  turnGhost(steps);
}

/** Place the ghost in the middle of the view. */
function begin(view: SceneView): void {
  const middle = ghost.value === null ? middleOf(view) : undefined;
  if (middle) beginGhostAt(middle.x, middle.y, middle.z);
}

/** Return the point of the ground in the middle of the view (m), or else the first dock. */
function middleOf(view: SceneView): { readonly x: number; readonly y: number; readonly z: number } | undefined {
  const { width, height } = view.stage.size;
  return view.site.hitWays(view.rayAt(width / 2, height / 2))?.point ?? world.value?.docks[0]?.pose;
}

/** Move along the axis of the site that is nearest to the arrow's direction in the view. */
function step(
  view: SceneView,
  [right, up]: readonly [number, number],
  cells: number,
  move: (columns: number, rows: number) => void,
): void {
  const ahead = view.stage.camera.getWorldDirection(new Vector3());
  const quarter = Math.round(Math.atan2(ahead.y, ahead.x) / (Math.PI / 2)) * (Math.PI / 2);
  const [forwardX, forwardY] = [Math.round(Math.cos(quarter)), Math.round(Math.sin(quarter))];
  move((up * forwardX + right * forwardY) * cells, (up * forwardY - right * forwardX) * cells);
}

/** Show the floor above or below; the ghost moves with it. */
function changeFloor(view: SceneView, by: number): void {
  const floors = world.value?.floors ?? [];
  const at = shownFloor.value === null ? floors.length : floors.findIndex((floor) => floor.number === shownFloor.value);
  const next = at + by;
  if (next < 0) return;
  const floor = floors[next];
  shownFloor.value = floor?.number ?? null;
  view.camera.toFloor(floor ?? null);
  if (floor) liftCorner(floor.z);
  if (floor && ghost.value !== null) liftGhost(floor.z);
  else if (!floor) hideGhost();
}
