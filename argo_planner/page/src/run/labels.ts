/** Names of tasks, checkpoints and requests in the shown run. */

import type { RequestState } from "../api/types";
import { planId, revision } from "../state/plan";
import { shownRunState } from "../state/run";
import { taskLabel } from "../state/task-labels";
import { checkpointsById } from "../state/world";
import { t } from "../texts";
import { faultText } from "../texts/fault-names";

/** Return the number and the title of a task, or its name if the mission has changed since the run began. */
export function runTaskLabel(name: string): string {
  const run = shownRunState.value;
  return run?.plan === planId.value && run.revision === revision.value ? taskLabel(name) : name;
}

/** Return the name and the number of a checkpoint. */
export function checkpointLabel(id: string): string {
  const checkpoint = checkpointsById.value.get(id);
  return checkpoint ? t().tasks.checkpoint(checkpoint.name, id) : `#${id}`;
}

/** Return what a request asks for, with what it names. */
export function requestText({ kind, subject }: RequestState): string {
  const { run, words } = t();
  const name = run.requests[kind] ?? kind;
  if (subject === "") return name;
  switch (kind) {
    case "do_task":
    case "skip":
      return `${name}: ${runTaskLabel(subject)}`;
    case "measure":
    case "reading":
      return `${name}: ${checkpointLabel(subject)}`;
    case "event":
      return `${name}: ${words.event[subject as keyof typeof words.event]}`;
    case "fault":
      return `${name}: ${faultText(subject)}`;
    default:
      return name;
  }
}
