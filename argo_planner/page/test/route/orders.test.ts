import { expect, test } from "vitest";

import { convergence } from "../../src/model/curves";
import { compareOrders, longestIncreasing } from "../../src/model/order-comparison";

test("a longest increasing subsequence", () => {
  expect(longestIncreasing([])).toEqual([]);
  expect(longestIncreasing([3, 1, 2])).toEqual([1, 2]);
  expect(longestIncreasing([5, 0, 1, 7, 2, 3])).toEqual([0, 1, 2, 3]);
});

test("only the fewest possible tasks are marked as moved", () => {
  const { before, after } = compareOrders(["a", "b", "c", "d"], ["d", "a", "b", "c"]);
  expect(after.filter((one) => one.moved).map((one) => one.name)).toEqual(["d"]);
  expect(before.filter((one) => one.moved).map((one) => one.name)).toEqual(["d"]);
  expect(compareOrders(["a", "b"], ["a", "b"]).after.some((one) => one.moved)).toBe(false);
});

test("a task that is left out is marked in the first order", () => {
  const { before, after } = compareOrders(["a", "b", "c"], ["a", "c"]);
  expect(before.map((one) => one.moved)).toEqual([false, true, false]);
  expect(after.map((one) => one.moved)).toEqual([false, false]);
});

test("the best order and the bound are step functions that approach each other", () => {
  const steps = [
    { time: 0, best: null, bound: 50 },
    { time: 1, best: 110, bound: 90 },
    { time: 4, best: 100, bound: 100 },
  ];
  const found = convergence(steps, 100, 50);
  expect(found?.end).toBe(4);
  expect(found?.best.startsWith("M25 ")).toBe(true);
  expect(found?.bound.startsWith("M0 ")).toBe(true);
  expect(found?.best.endsWith("H100")).toBe(true);
  const last = (path: string | undefined) => path?.split("V").at(-1);
  expect(last(found?.best)).toBe(last(found?.bound));
  expect(convergence([], 100, 50)).toBeNull();
  expect(convergence([{ time: 0, best: null, bound: 0 }], 10, 10)?.best).toBe("");
});
