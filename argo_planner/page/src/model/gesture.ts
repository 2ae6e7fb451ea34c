/** Distinction of clicks and drags of the pointer. */

/** px that the pointer may move during a click */
export const CLICK_PX = 4;

export interface Press {
  readonly pointer: number;
  readonly button: number;
  readonly x: number;
  readonly y: number;
  /** Whether it has become a drag; it remains one if the pointer comes back. */
  readonly drag: boolean;
}

export function beginPress(pointer: number, button: number, x: number, y: number): Press {
  return { pointer, button, x, y, drag: false };
}

export function movePress(press: Press, x: number, y: number): Press {
  if (press.drag || Math.hypot(x - press.x, y - press.y) < CLICK_PX) return press;
  return { ...press, drag: true };
}
