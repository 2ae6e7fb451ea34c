import { afterEach, beforeEach, expect, test, vi } from "vitest";

import { fakeService, problem } from "./fake-service";

import type { RunState } from "../../src/api/types";
import { notices } from "../../src/state/notices";
import { sendRequest, pendingRequests } from "../../src/state/requests";
import { run } from "../../src/state/run";

beforeEach(() => {
  vi.useFakeTimers();
  notices.value = [];
  run.value = { id: "r1", plan: "a1", status: "running", mode: "autonomous", requests: [] } as unknown as RunState;
});
afterEach(() => void vi.useRealTimers());

test("a request to the robot is given up with a notice if the service can't be reached", async () => {
  const asked = fakeService(() => null);
  const answer = sendRequest({ kind: "go_on" });
  expect(pendingRequests.value).toEqual(["go_on"]);
  await vi.advanceTimersByTimeAsync(5_000);
  expect(await answer).toBeNull();
  expect(pendingRequests.value).toEqual([]);
  expect(notices.value).toHaveLength(1);
  const count = asked.length;
  await vi.advanceTimersByTimeAsync(60_000);
  expect(asked).toHaveLength(count);
});

test("a request to stop is repeated for longer", async () => {
  let reached = false;
  fakeService(() => (reached ? [200, { id: "q", kind: "pause", progress: "accepted", by: "Ann" }] : null));
  const answer = sendRequest({ kind: "pause" });
  await vi.advanceTimersByTimeAsync(20_000);
  reached = true;
  await vi.advanceTimersByTimeAsync(1_000);
  expect((await answer)?.progress).toBe("accepted");
});

test("driving is not requested again after the key is released", async () => {
  let held = true;
  const asked = fakeService(() => null);
  const answer = sendRequest({ kind: "drive_to", pose: { x: 1, y: 1, z: 0, yaw: 0 } }, true, () => held);
  await vi.advanceTimersByTimeAsync(600);
  held = false;
  const count = asked.length;
  await vi.advanceTimersByTimeAsync(60_000);
  expect(await answer).toBeNull();
  expect(asked).toHaveLength(count);
});

test("a refusal shows a notice, but not while a key is held", async () => {
  fakeService(() => problem(409, "conflict"));
  await sendRequest({ kind: "skip", task: "A" });
  expect(notices.value).toHaveLength(1);
  notices.value = [];
  await sendRequest({ kind: "stop_by_hand" }, true);
  expect(notices.value).toHaveLength(0);
});
