/** The mode of a run, in one word by which people act. */

import type { RequestState, RunState } from "../api/types";

export type ShownMode =
  | "unknown"
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

/** Return the mode of a run; `known`: whether its state is the present one. */
export function shownMode(run: RunState, known = true): ShownMode {
  if (!known && run.status !== "ended") return "unknown";
  switch (run.status) {
    case "preparing":
      return "preparing";
    case "interrupted":
      return "interrupted";
    case "ended":
      return run.headline?.tone ?? "notice";
    case "running":
      // A person who has told the robot to stop must see when it stands.
      return run.mode === "paused" && run.moving ? "stopping" : run.mode;
  }
}

/** Return whether a request of this kind is in progress. */
export function isUnderWay(run: RunState, kind: string): boolean {
  return run.requests.some((one) => one.kind === kind && !isOver(one));
}

export function isOver(request: RequestState): boolean {
  return request.progress !== "accepted" && request.progress !== "under way";
}

/** Return the requests that the panel shows: all open ones, and the last `past` finished ones. */
export function shownRequests(requests: readonly RequestState[], past: number): RequestState[] {
  const open = requests.filter((one) => !isOver(one));
  const over = requests.filter(isOver);
  return [...over.slice(Math.max(0, over.length - past)), ...open].reverse();
}

/** Return who has taken the robot over last; null: unknown. */
export function takenOverBy(run: RunState): string | null {
  return run.requests.findLast((one) => one.kind === "take_over" && one.progress === "confirmed")?.by ?? null;
}
