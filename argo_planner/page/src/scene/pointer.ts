/** Pointer input of the scene: pointing, clicks, and drags, which move the camera. */

import { movePress, beginPress, type Press } from "../model/gesture";

export interface PointerHandlers {
  pointed(x: number, y: number): void;
  left(): void;
  /** `add`: with Ctrl or the command key */
  clicked(x: number, y: number, add: boolean): void;
  clickedRight(x: number, y: number): void;
  /** Handles a frame (px) while it is drawn with Shift; `done`: the pointer was released. */
  framed(frame: Frame, done: boolean): void;
  /** Returns whether a frame can be drawn. */
  mayFrame(): boolean;
  /** Handles the wheel; returns whether a tool used it, so that the camera doesn't. */
  wheeled(steps: number): boolean;
}

/** px that a touchpad reports for one notch of a wheel */
const NOTCH_PX = 50;

/** A rectangle of the view (px). */
export interface Frame {
  readonly left: number;
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
}

export class PointerWatch {
  private press: Press | null = null;
  /** Where the frame begins that is being drawn; null: none is. */
  private corner: readonly [number, number] | null = null;
  private turned = 0;
  private readonly over = new AbortController();

  constructor(
    private readonly element: HTMLElement,
    private readonly handlers: PointerHandlers,
  ) {
    const { signal } = this.over;
    element.addEventListener("pointerdown", this.down, { signal });
    element.addEventListener("pointerleave", () => this.press === null && handlers.left(), { signal });
    element.addEventListener("contextmenu", (event) => event.preventDefault(), { signal });
    element.addEventListener("wheel", this.wheel, { signal, passive: false });
    // The camera gets the event later: a click must not turn it.
    window.addEventListener("pointermove", this.move, { signal, capture: true });
    window.addEventListener("pointerup", this.up, { signal, capture: true });
    window.addEventListener("pointercancel", () => (this.press = this.corner = null), { signal, capture: true });
  }

  dispose(): void {
    this.over.abort();
  }

  private place(event: MouseEvent): [number, number] {
    const box = this.element.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  private readonly down = (event: PointerEvent): void => {
    // A second finger makes it a camera gesture.
    const drag = this.press !== null;
    this.press = { ...beginPress(event.pointerId, event.button, event.clientX, event.clientY), drag };
    const frames = event.shiftKey && event.button === 0 && !drag && this.handlers.mayFrame();
    this.corner = frames ? this.place(event) : null;
  };

  private readonly move = (event: PointerEvent): void => {
    if (this.press === null) {
      if (event.composedPath()[0] === this.element) this.handlers.pointed(...this.place(event));
      return;
    }
    if (event.pointerId !== this.press.pointer) return;
    this.press = movePress(this.press, event.clientX, event.clientY);
    if (this.press.drag && this.corner !== null) this.handlers.framed(frameTo(this.corner, this.place(event)), false);
    if (!this.press.drag || this.corner !== null) event.stopImmediatePropagation();
  };

  private readonly up = (event: PointerEvent): void => {
    const press = this.press;
    if (press?.pointer !== event.pointerId) return;
    const { corner } = this;
    this.press = this.corner = null;
    const place = this.place(event);
    if (movePress(press, event.clientX, event.clientY).drag) {
      if (corner !== null) this.handlers.framed(frameTo(corner, place), true);
      return;
    }
    if (press.button === 0) this.handlers.clicked(...place, event.ctrlKey || event.metaKey);
    else if (press.button === 2) this.handlers.clickedRight(...place);
  };

  /** Convert wheel events to notches; touchpads report small parts of them. */
  private readonly wheel = (event: WheelEvent): void => {
    const { deltaY, deltaMode } = event;
    const notch = deltaMode !== WheelEvent.DOM_DELTA_PIXEL || Math.abs(deltaY) >= NOTCH_PX;
    this.turned = notch ? Math.sign(deltaY) : this.turned + deltaY / NOTCH_PX;
    const steps = Math.trunc(this.turned);
    this.turned -= steps;
    if (!event.ctrlKey && this.handlers.wheeled(steps)) event.preventDefault();
  };
}

function frameTo([x, y]: readonly [number, number], [toX, toY]: readonly [number, number]): Frame {
  return { left: Math.min(x, toX), top: Math.min(y, toY), right: Math.max(x, toX), bottom: Math.max(y, toY) };
}
