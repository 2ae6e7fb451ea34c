/** How a run stands, in the one word that people act by. */

import type { RequestState, RunState } from "../api/types";

export type ShownMode =
  | "preparing"
  | "autonomous"
  | "stopping"
  | "paused"
  | "supervised"
  | "reacting"
  | "interrupted"
  | "good"
  | "notice"
  | "bad";

export function shownMode(run: RunState): ShownMode {
  switch (run.status) {
    case "preparing":
      return "preparing";
    case "interrupted":
      return "interrupted";
    case "ended":
      return run.headline?.tone ?? "notice";
    case "running":
      // Someone who has told the robot to stand still must see when it does.
      return run.mode === "paused" && run.moving ? "stopping" : run.mode;
  }
}

/** Whether a request of this kind is on its way. */
export function isUnderWay(run: RunState, kind: string): boolean {
  return run.requests.some((one) => one.kind === kind && !isOver(one));
}

export function isOver(request: RequestState): boolean {
  return request.progress !== "accepted" && request.progress !== "under way";
}

/** What the panel tells of the requests: those that are not over, and the last ones that are. */
export function shownRequests(requests: readonly RequestState[], past: number): RequestState[] {
  const open = requests.filter((one) => !isOver(one));
  const over = requests.filter(isOver);
  return [...over.slice(Math.max(0, over.length - past)), ...open].reverse();
}

/** Who has taken the robot over last; null: that is not known. */
export function takenOverBy(run: RunState): string | null {
  return run.requests.findLast((one) => one.kind === "take_over" && one.progress === "confirmed")?.by ?? null;
}
