import { expect, test } from "vitest";

import { directionOf, goalOf, isStraight } from "../../src/model/hand-driving";

test("arrows and WASD drive, wherever the letters are on the keyboard", () => {
  expect(["ArrowUp", "KeyS", "ArrowLeft", "KeyD", "KeyQ"].map(directionOf)).toEqual([
    "forward",
    "backward",
    "left",
    "right",
    null,
  ]);
});

test("the goal is ahead, behind, or turned in place", () => {
  const north = [1, 2, 3, Math.PI / 2, 0] as const;
  expect(goalOf(north, "forward", 2).y).toBeCloseTo(4);
  expect(goalOf(north, "backward", 2).y).toBeCloseTo(1);
  expect(goalOf(north, "left", 1)).toMatchObject({ x: 1, y: 2, z: 3 });
  expect(Math.abs(goalOf(north, "left", 1).yaw)).toBeCloseTo(Math.PI);
  expect(goalOf(north, "right", 1).yaw).toBeCloseTo(0);
});

test("on stairs the goal follows the robot's pitch", () => {
  const up = [0, 0, 0, 0, -Math.PI / 6] as const;
  expect(goalOf(up, "forward", 2).z).toBeCloseTo(1);
  expect(goalOf(up, "backward", 2).z).toBeCloseTo(-0.5);
});

test("detours, missing paths and paths without motion are not driven", () => {
  expect(isStraight({ distance: 2.1, time: 8 }, "forward", 2)).toBe(true);
  expect(isStraight({ distance: 9, time: 30 }, "forward", 2)).toBe(false);
  expect(isStraight({ distance: 0, time: 0.1 }, "forward", 2)).toBe(false);
  expect(isStraight({ distance: 2, time: null }, "forward", 2)).toBe(false);
  expect(isStraight({ distance: 0, time: 4 }, "left", 1)).toBe(true);
  expect(isStraight({ distance: 3, time: 14 }, "left", 1)).toBe(false);
});
