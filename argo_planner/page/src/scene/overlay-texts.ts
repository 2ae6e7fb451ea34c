/** Texts beside moving objects of the scene: the ghost and the robot. */

import { modeWords } from "../run/mode-words";
import { shownRunState, shownTime } from "../state/run";
import { t } from "../texts";
import { dependOn } from "../state/depend-on";
import { ghost, verdictWords } from "./navigate";
import type { RobotView } from "./robot-view";
import type { SceneView } from "./view";

/** Place the verdict beside the ghost. */
export function placeGhostText(view: SceneView, element: HTMLElement | null): void {
  const at = ghost.value;
  dependOn(view.frames);
  if (element === null) return;
  const seen = at === null ? null : view.project(at);
  element.hidden = seen === null;
  if (seen === null) return;
  element.textContent = verdictWords(at);
  element.classList.toggle("bad", at?.verdict !== null && at?.verdict.ground !== "reached");
  element.style.setProperty("transform", `translate(${Math.round(seen.x + 22)}px, ${Math.round(seen.y + 14)}px)`);
}

/** Place the mode of the run above the robot. */
export function placeRobotText(view: SceneView, robot: RobotView, element: HTMLElement | null): void {
  const shown = robot.shown.value;
  dependOn(view.frames);
  if (element === null) return;
  const seen = shown !== null && view.site.isShown(shown.floor) ? view.project(shown.at) : null;
  element.hidden = seen === null;
  if (seen === null || shown === null) return;
  element.className = shown.mode;
  const back = shownTime.value;
  const state = shownRunState.value;
  const now = state === null ? t().run.modes[shown.mode] : modeWords(state);
  element.textContent = back === null ? now : t().words.seconds(back);
  const place = `translate(${Math.round(seen.x)}px, ${Math.round(seen.y)}px) translate(-50%, -100%)`;
  element.style.setProperty("transform", place);
}
