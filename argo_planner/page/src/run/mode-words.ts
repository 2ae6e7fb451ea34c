/** How a run stands, in the words for whoever looks. */

import type { RunState } from "../api/types";
import { shownMode, takenOverBy } from "../model/run-mode";
import { isMe } from "../state/session";
import { t } from "../texts";

/** Says also whether it is whoever looks that has the robot. */
export function modeWords(run: RunState): string {
  const mode = shownMode(run);
  const by = mode === "supervised" ? takenOverBy(run) : null;
  return by !== null && isMe(by) ? t().run.youHave : t().run.modes[mode];
}
