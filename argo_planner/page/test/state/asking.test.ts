import { afterEach, beforeEach, expect, test, vi } from "vitest";

import { fakeService, problem } from "./fake-service";

import type { RunState } from "../../src/api/types";
import { notices } from "../../src/state/notices";
import { ask, asking } from "../../src/state/asking";
import { run } from "../../src/state/run";

beforeEach(() => {
  vi.useFakeTimers();
  notices.value = [];
  run.value = { id: "r1", plan: "a1", status: "running", mode: "autonomous", requests: [] } as unknown as RunState;
});
afterEach(() => void vi.useRealTimers());

test("what the robot is to do is given up where the service is not reached, and said to be", async () => {
  const asked = fakeService(() => null);
  const answer = ask({ kind: "go_on" });
  expect(asking.value).toEqual(["go_on"]);
  await vi.advanceTimersByTimeAsync(5_000);
  expect(await answer).toBeNull();
  expect(asking.value).toEqual([]);
  expect(notices.value).toHaveLength(1);
  const count = asked.length;
  await vi.advanceTimersByTimeAsync(60_000);
  expect(asked).toHaveLength(count);
});

test("to stand still is tried for longer", async () => {
  let reached = false;
  fakeService(() => (reached ? [200, { id: "q", kind: "pause", progress: "accepted", by: "Ann" }] : null));
  const answer = ask({ kind: "pause" });
  await vi.advanceTimersByTimeAsync(20_000);
  reached = true;
  await vi.advanceTimersByTimeAsync(1_000);
  expect((await answer)?.progress).toBe("accepted");
});

test("nobody drives on whose key was let go", async () => {
  let held = true;
  const asked = fakeService(() => null);
  const answer = ask({ kind: "drive_to", pose: { x: 1, y: 1, z: 0, yaw: 0 } }, true, () => held);
  await vi.advanceTimersByTimeAsync(600);
  held = false;
  const count = asked.length;
  await vi.advanceTimersByTimeAsync(60_000);
  expect(await answer).toBeNull();
  expect(asked).toHaveLength(count);
});

test("a refusal is told, but not where somebody holds a key", async () => {
  fakeService(() => problem(409, "conflict"));
  await ask({ kind: "skip", task: "A" });
  expect(notices.value).toHaveLength(1);
  notices.value = [];
  await ask({ kind: "stop_by_hand" }, true);
  expect(notices.value).toHaveLength(0);
});
