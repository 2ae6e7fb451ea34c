import { describe, expect, it } from "vitest";

import { movePress, beginPress } from "../../src/model/gesture";

describe("a press of the pointer", () => {
  it("is a click below 4 px", () => {
    expect(movePress(beginPress(1, 0, 100, 100), 102, 103).drag).toBe(false);
    expect(movePress(beginPress(1, 0, 100, 100), 103.9, 100).drag).toBe(false);
  });

  it("is a drag from 4 px on", () => {
    expect(movePress(beginPress(1, 0, 100, 100), 104, 100).drag).toBe(true);
    expect(movePress(beginPress(1, 0, 100, 100), 97, 97).drag).toBe(true);
  });

  it("stays a drag if it comes back", () => {
    const away = movePress(beginPress(1, 2, 100, 100), 120, 100);
    expect(movePress(away, 100, 100)).toEqual({ pointer: 1, button: 2, x: 100, y: 100, drag: true });
  });
});
