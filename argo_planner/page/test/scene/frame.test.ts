import { expect, test, vi } from "vitest";

import { type Frame, PointerWatch } from "../../src/scene/pointer";

function watched(mayFrame = true) {
  const element = document.createElement("div");
  document.body.append(element);
  const framed = vi.fn<(frame: Frame, done: boolean) => void>();
  const clicked = vi.fn();
  const ignored = vi.fn();
  new PointerWatch(element, {
    pointed: ignored,
    left: ignored,
    clicked,
    clickedRight: ignored,
    framed,
    mayFrame: () => mayFrame,
    wheeled: () => false,
  });
  const fire = (type: string, x: number, y: number, shiftKey: boolean) =>
    element.dispatchEvent(
      new PointerEvent(type, { pointerId: 1, button: 0, clientX: x, clientY: y, shiftKey, bubbles: true, composed: true }),
    );
  return { fire, framed, clicked };
}

test("a drag with Shift draws a frame, whatever its direction", () => {
  const { fire, framed, clicked } = watched();
  fire("pointerdown", 50, 40, true);
  fire("pointermove", 20, 60, true);
  fire("pointerup", 10, 70, true);
  expect(framed.mock.calls).toEqual([
    [{ left: 20, top: 40, right: 50, bottom: 60 }, false],
    [{ left: 10, top: 40, right: 50, bottom: 70 }, true],
  ]);
  expect(clicked).not.toHaveBeenCalled();
});

test("a click with Shift is a click", () => {
  const { fire, framed, clicked } = watched();
  fire("pointerdown", 50, 40, true);
  fire("pointerup", 51, 40, true);
  expect(framed).not.toHaveBeenCalled();
  expect(clicked).toHaveBeenCalledOnce();
});

test.each([
  [false, true],
  [true, false],
])("no frame with Shift %s where frames may be drawn: %s", (shift, may) => {
  const { fire, framed } = watched(may);
  fire("pointerdown", 50, 40, shift);
  fire("pointermove", 20, 60, shift);
  fire("pointerup", 10, 70, shift);
  expect(framed).not.toHaveBeenCalled();
});
