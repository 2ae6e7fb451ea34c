/** The mode of a run, in words. */

import type { RunState } from "../api/types";
import { shownMode, takenOverBy } from "../model/run-mode";
import { isMe } from "../state/session";
import { t } from "../texts";

/** Return the mode in words; it also says whether the person at the page controls the robot. */
export function modeWords(run: RunState): string {
  const mode = shownMode(run);
  const by = mode === "supervised" ? takenOverBy(run) : null;
  return by !== null && isMe(by) ? t().run.youHave : t().run.modes[mode];
}
