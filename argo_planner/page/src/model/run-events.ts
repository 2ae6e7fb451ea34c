/** The noteworthy events of a run, from its many entries. */

import type { Entry, Trouble, VerdictPart, Wording } from "../api/types";

export type RunEvent =
  | { readonly kind: "done" | "by hand"; readonly task: string }
  | { readonly kind: "failed" | "stopped"; readonly task: string; readonly why: string; readonly wording?: Wording }
  | { readonly kind: "read" | "given"; readonly checkpoint: string; readonly value: number; readonly unit: string; readonly normal: boolean | null }
  | { readonly kind: "found"; readonly event: string; readonly detail: string; readonly wording?: Wording }
  | { readonly kind: "steered"; readonly how: "pause" | "resume" | "take_over" | "give_back" | "cancel" }
  | { readonly kind: "fault"; readonly fault: string }
  | { readonly kind: "mishap"; readonly trouble: Trouble; readonly detail: string; readonly wording?: Wording }
  | { readonly kind: "contact"; readonly link: string; readonly element: string }
  | { readonly kind: "resumed" | "edited" }
  | { readonly kind: "ended"; readonly stopped: VerdictPart | null };

export interface TimedEvent {
  /** s */
  readonly t: number;
  /** index of the entry */
  readonly entry: number;
  readonly what: RunEvent;
  readonly tone: "plain" | "good" | "warn" | "bad";
}

/** Return the events of the entries from index `from` to `to`, in order. */
export function runEvents(entries: readonly Entry[], from = 0, to = entries.length): TimedEvent[] {
  const found: TimedEvent[] = [];
  for (let at = from; at < to; at++) {
    const entry = entries[at] as Entry;
    if (!isPlain(entry))
      for (const [what, tone] of eventsOfEntry(entry, at === entries.length - 1))
        found.push({ t: entry.t, entry: at, what, tone });
  }
  return found;
}

/** Return whether an entry only reports the robot's pose. */
function isPlain(entry: Entry): boolean {
  return (
    entry.events.length === 0 &&
    entry.faults.length === 0 &&
    entry.mishaps.length === 0 &&
    entry.contacts.length === 0 &&
    !entry.task &&
    !entry.reading &&
    !entry.resumed &&
    !entry.ended
  );
}

function* eventsOfEntry(entry: Entry, isLast: boolean): Generator<[RunEvent, TimedEvent["tone"]]> {
  if (entry.resumed) yield [{ kind: "resumed" }, "warn"];
  for (const fault of entry.faults) yield [{ kind: "fault", fault: fault.kind }, "warn"];
  const { reading, task } = entry;
  if (reading) {
    const { name, value, unit, normal } = reading;
    yield [{ kind: "read", checkpoint: name, value, unit, normal }, normal ? "plain" : "bad"];
  }
  for (const event of entry.events) {
    if (event.event && !(reading && event.event === "abnormal_reading"))
      yield [{ kind: "found", event: event.event, detail: event.detail ?? "", ...worded(event.detail_wording) }, isGoodEvent(event.event) ? "good" : "bad"];
    if (event.kind === "reading_given" && !reading)
      yield [
        { kind: "given", checkpoint: `#${event.object_id ?? ""}`, value: event.value ?? NaN, unit: "", normal: null },
        "plain",
      ];
    if (isSteering(event.kind)) yield [{ kind: "steered", how: event.kind }, "warn"];
  }
  for (const mishap of entry.mishaps)
    yield [{ kind: "mishap", trouble: mishap.trouble, detail: mishap.detail, ...worded(mishap.detail_wording) }, "bad"];
  for (const contact of entry.contacts)
    yield [{ kind: "contact", link: contact.link, element: contact.element }, "bad"];
  if (task) {
    const why = task.reason ?? "";
    if (task.outcome === "done")
      yield [{ kind: task.by_hand ? "by hand" : "done", task: task.task }, "good"];
    else if (task.outcome === "failed") yield [{ kind: "failed", task: task.task, why, ...worded(task.reason_wording) }, "bad"];
    else yield [{ kind: "stopped", task: task.task, why, ...worded(task.reason_wording) }, "warn"];
  }
  // A run that continues after its end does so with an edited mission.
  if (entry.ended)
    yield isLast ? [{ kind: "ended", stopped: entry.stopped ?? null }, "plain"] : [{ kind: "edited" }, "warn"];
}

function worded(wording: Wording | null | undefined): { wording?: Wording } {
  return wording ? { wording } : {};
}

type Steering = Extract<RunEvent, { kind: "steered" }>["how"];

function isSteering(kind: string): kind is Steering {
  return ["pause", "resume", "take_over", "give_back", "cancel"].includes(kind);
}

function isGoodEvent(event: string): boolean {
  return ["all_clear", "battery_charged", "connection_restored"].includes(event);
}
