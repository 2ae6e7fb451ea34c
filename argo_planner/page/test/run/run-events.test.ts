import { expect, test } from "vitest";

import type { Entry } from "../../src/api/types";
import { runEvents } from "../../src/model/run-events";

function entry(more: object): Entry {
  return { t: 1, pose: [0, 0, 0, 0, 0], distance: 0, climbed: 0, events: [], faults: [], mishaps: [], contacts: [], ...more } as unknown as Entry;
}
const kinds = (...entries: Entry[]) => runEvents(entries).map((one) => one.what.kind);

test("an entry with only a pose makes no event", () => {
  expect(kinds(entry({}), entry({ sample: true }))).toEqual([]);
});

test("an abnormal reading makes one event", () => {
  const reading = { checkpoint: 4, name: "valve", value: 1, unit: "deg", normal: false };
  const told = runEvents([
    entry({ reading, events: [{ kind: "succeeded", event: null }, { kind: "occurred", event: "abnormal_reading", detail: "" }] }),
  ]);
  expect(told.map((one) => [one.what.kind, one.tone])).toEqual([["read", "bad"]]);
});

test("interventions, tasks, faults and the end make events in order", () => {
  const done = { task: "a", outcome: "done", by_hand: false };
  expect(
    kinds(
      entry({ faults: [{ kind: "gas_leak" }] }),
      entry({ events: [{ kind: "take_over" }] }),
      entry({ task: done }),
      entry({ task: { ...done, by_hand: true } }),
      entry({ task: { ...done, outcome: "failed", reason: "stuck" } }),
      entry({ task: { ...done, outcome: "interrupted" } }),
      entry({ events: [{ kind: "occurred", event: "gas_leak", detail: "x" }] }),
      entry({ resumed: true }),
      entry({ ended: true, stopped: "by a person" }),
    ),
  ).toEqual(["fault", "steered", "done", "by hand", "failed", "stopped", "found", "resumed", "ended"]);
});

test("an end before other entries means that the run continues with an edited mission", () => {
  expect(kinds(entry({ ended: true, stopped: "it goes on" }), entry({}))).toEqual(["edited"]);
});

test("only events of the given entries are returned, with their indices", () => {
  const all = [1, 2, 3].map((t) => entry({ t, resumed: true }));
  expect(runEvents(all, 1, 3).map((one) => one.entry)).toEqual([1, 2]);
});
