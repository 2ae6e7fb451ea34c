import { beforeEach, expect, test, vi } from "vitest";

import { type Answer, type Asked, fakeService, problem } from "./fake-service";

import { edit, allAnswered } from "../../src/state/commands";
import { notices } from "../../src/state/notices";
import { mission, planId, revision, takePlanState } from "../../src/state/plan";
import { mission as missionOf } from "../model/missions";

const NOTHING = { header: {}, tasks: null, groups: null, reactions: null };

function made(number: number, id: string, change: object = NOTHING, author = "Bob") {
  return { number, id, author, change, kind: "edit", about: "", time: "" };
}

function done(asked: Asked, number: number): Answer {
  const { id } = asked.body as { id: string };
  return [200, { revision: made(number, id), findings: { diagnostics: [], more: 0 }, undoable: [], redoable: [] }];
}

beforeEach(() => {
  planId.value = "a1";
  mission.value = missionOf("A B C");
  revision.value = 3;
  notices.value = [];
});

test("an edit without an answer is sent again with the same id", async () => {
  let answers = 0;
  const asked = fakeService((one) => (++answers < 3 ? null : done(one, 4)));
  vi.useFakeTimers();
  const made = edit({ kind: "remove_task", name: "A" });
  await vi.advanceTimersByTimeAsync(5_000);
  vi.useRealTimers();
  expect(await made).toBe(true);
  expect(new Set(asked.map((one) => (one.body as { id: string }).id)).size).toBe(1);
  expect(asked).toHaveLength(3);
  expect(revision.value).toBe(4);
});

test("edits of others elsewhere don't prevent an edit", async () => {
  const change = { ...NOTHING, tasks: { put: [], gone: ["C"], placed: [] } };
  const asked = fakeService((one) =>
    one.ifMatch === '"3"' ? problem(412, "stale-revision", { since: [made(4, "x", change)] }) : done(one, 5),
  );
  expect(await edit({ kind: "remove_task", name: "A" })).toBe(true);
  expect(asked.map((one) => one.ifMatch)).toEqual(['"3"', '"4"']);
  expect(mission.value?.tasks.map((task) => task.name)).toEqual(["A", "B"]);
});

test.each([
  ["a task", { kind: "remove_task", name: "A" } as const, { tasks: { put: [], gone: ["A"], placed: [] } }],
  ["a field of the mission", { kind: "set_header", max_duration: 60 } as const, { header: { max_duration: 90 } }],
  [
    "the end of a group",
    { kind: "wrap_tasks", group: { name: "G", start: "A", end: "C" } } as const,
    { tasks: { put: [], gone: [], placed: [["C", null]] } },
  ],
])("an edit of %s that somebody else has changed is not made, but can be applied anyway", async (_, asked, change) => {
  fakeService((one) =>
    one.ifMatch === '"3"'
      ? problem(412, "stale-revision", { since: [made(4, "x", { ...NOTHING, ...change })] })
      : done(one, 5),
  );
  expect(await edit(asked)).toBe(false);
  const [told] = notices.value;
  expect(told?.details[0]).toContain("Bob");
  told?.actions[0]?.act();
  await allAnswered();
  expect(revision.value).toBe(5);
});

test("applying anyway does not affect another mission", async () => {
  const change = { ...NOTHING, tasks: { put: [], gone: ["A"], placed: [] } };
  const asked = fakeService(() => problem(412, "stale-revision", { since: [made(4, "x", change)] }));
  await edit({ kind: "remove_task", name: "A" });
  const [told] = notices.value;
  planId.value = "b2";
  told?.actions[0]?.act();
  await allAnswered();
  expect(asked.every((one) => one.path.includes("a1"))).toBe(true);
});

test("an answer for a closed mission does not change another one", async () => {
  fakeService((one) => {
    planId.value = "b2"; // somebody opens another mission meanwhile
    return done(one, 4);
  });
  await edit({ kind: "remove_task", name: "A" });
  expect(revision.value).toBe(3);
});

test("a snapshot replaces the previous state", () => {
  const state = { id: "a1", name: "Round", mission: missionOf("X"), revision: 9, findings: { diagnostics: [], more: 0 } };
  takePlanState({ ...state, versions: [], undoable: [], redoable: [], newest: 9 } as never);
  expect(mission.value?.tasks.map((task) => task.name)).toEqual(["X"]);
});
