/** The mode of a run, as far as it is known, in words. */

import type { RunState } from "../api/types";
import { shownMode, takenOverBy } from "../model/run-mode";
import { presentMode, robotLostAt } from "../state/run";
import { isMe } from "../state/session";
import { t } from "../texts";
import { timeOfDay } from "../ui/figures";

/** Return the present mode in words: since when it is unknown, or whether the person at the page has the robot. */
export function modeWords(run: RunState): string {
  if (presentMode(run) === "unknown" && robotLostAt.value !== null) return t().run.unknownSince(timeOfDay(robotLostAt.value));
  return knownModeWords(run);
}

/** Return the last known mode in words. */
export function knownModeWords(run: RunState): string {
  const mode = shownMode(run);
  const by = mode === "supervised" ? takenOverBy(run) : null;
  return by !== null && isMe(by) ? t().run.youHave : t().run.modes[mode];
}
