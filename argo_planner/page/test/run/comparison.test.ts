import { expect, test } from "vitest";

import type { Entry, Noticed } from "../../src/api/types";
import { compareNoticed, compareReadings, compareTasks, runSum, type FinishedRun } from "../../src/model/run-comparison";

const KNOWN = new Map([["7", { name: "gauge 3", unit: "bar", nominal: { low: 1, high: 3 } }]]);

function measure(t: number, task: string, id: number, value: number, normal = true) {
  return {
    t,
    task: { task, action: "MEASURE", object_id: String(id), start: t - 5, end: t, outcome: "done", distance: 2, climbed: 0, by_hand: false },
    reading: { checkpoint: id, name: "own name", unit: "bar", nominal: { low: 1, high: 3 }, task, t, value, normal },
  };
}

function failed(t: number, task: string, id: number, how: object, outcome = "failed") {
  const run = { task, action: "MEASURE", object_id: String(id), start: t - 4, end: t, outcome, distance: 1, climbed: 0, by_hand: false };
  return { t, task: run, events: [{ kind: outcome === "failed" ? "failed" : "stopped", ...how }] };
}

function run(tasks: readonly (readonly [name: string, id: string | null])[] | null, ...entries: object[]): FinishedRun {
  const planned = tasks?.map(([name, id]) => ({ name, action: id === null ? "WAIT" : "MEASURE", object_id: id }));
  const all = entries.map((one) => ({ events: [], distance: 4, climbed: 1, charge: 0.5, ...one })) as unknown as Entry[];
  const report = planned === undefined ? null : { mission: { tasks: planned }, faults: [], waits: [{ task: "pause", start: 2, end: 12 }] };
  return { state: { t: 60 }, entries: all, report } as unknown as FinishedRun;
}

const PLANNED = [["a", "7"], ["b", "8"]] as const;

test("readings stand side by side, one measurement after the other", () => {
  const first = run(PLANNED, measure(10, "a", 7, 2), measure(20, "a", 7, 2.5));
  const second = run(PLANNED, measure(11, "a", 7, 3.5, false));
  const [one, two] = compareReadings(first, second, KNOWN);
  expect(one).toMatchObject({ name: "gauge 3", unit: "bar", number: 1, count: 2, difference: 1.5, differs: true });
  expect(two?.runs.map((run) => run.kind)).toEqual(["read", "no more"]);
});

test("equal values do not differ, and unknown checkpoints have the name of their reading", () => {
  const [row] = compareReadings(run(PLANNED, measure(1, "a", 7, 2)), run(PLANNED, measure(9, "a", 7, 2)), new Map());
  expect(row).toMatchObject({ name: "own name", difference: 0, differs: false });
});

test("what only one run has read is told apart", () => {
  const kindsOf = (other: FinishedRun) =>
    compareReadings(run(PLANNED, measure(1, "a", 7, 2)), other, KNOWN)[0]?.runs[1].kind;
  expect(kindsOf(run(PLANNED, failed(5, "a", 7, { unreadable: true })))).toBe("unreadable");
  expect(kindsOf(run(PLANNED, failed(5, "a", 7, { unreachable: true })))).toBe("unreachable");
  expect(kindsOf(run(PLANNED, failed(5, "a", 7, {})))).toBe("failed");
  expect(kindsOf(run(PLANNED, failed(5, "a", 7, {}, "interrupted")))).toBe("stopped");
  expect(kindsOf(run(PLANNED, { t: 1, events: [{ kind: "give_back", by_hand: [{ task: "a", skipped: true }] }] }))).toBe("skipped");
  expect(kindsOf(run(PLANNED))).toBe("not reached");
  expect(kindsOf(run([["b", "8"]]))).toBe("absent");
  expect(kindsOf(run(null))).toBe("unknown");
});

test("tasks have the sums of their visits, and those of one revision are marked", () => {
  const first = run([...PLANNED, ["pause", null]], measure(10, "a", 7, 2), measure(20, "a", 7, 2));
  const second = run([["a", "9"], ["c", "8"]], measure(10, "a", 9, 2));
  const rows = compareTasks(first, second);
  expect(rows.map((row) => row.name)).toEqual(["a", "b", "pause", "c"]);
  expect(rows[0]).toMatchObject({ redefined: true, differs: true, runs: [{ visits: 2, duration: 10, distance: 4 }, { visits: 1 }] });
  expect(rows[1]?.runs).toEqual(["not reached", "absent"]);
  expect(rows[2]?.runs[0]).toMatchObject({ visits: 1, duration: 10 });
  expect(rows[3]?.runs).toEqual(["absent", "not reached"]);
});

test("times that look the same are no difference", () => {
  const other = measure(10, "a", 7, 2);
  other.task.end += 0.01;
  expect(compareTasks(run([["a", "7"]], measure(10, "a", 7, 2)), run([["a", "7"]], other))[0]?.differs).toBe(false);
});

test("equal findings stand side by side, others in the order of time", () => {
  const leak = { kind: "finding", event: "gas_leak", t: 30, answered: true, response: "report" } as Noticed;
  const late = { ...leak, t: 40, answered: false } as Noticed;
  const touch = { kind: "contact", link: "arm", element: "rail", t: 10 } as Noticed;
  expect(compareNoticed([leak], [{ ...leak, t: 33 }]).map((row) => row.differs)).toEqual([false]);
  expect(compareNoticed([leak], [touch, late]).map((row) => row.runs)).toEqual([[null, touch], [leak, late]]);
  expect(compareNoticed([leak], [late])[0]?.differs).toBe(true);
});

test("a run is summed up", () => {
  const sum = runSum(run(PLANNED, measure(10, "a", 7, 4, false), failed(12, "b", 8, {})));
  expect(sum).toEqual({ duration: 60, distance: 4, climbed: 1, charge: 0.5, done: 1, tasks: 2, readings: 1, abnormal: 1 });
});
