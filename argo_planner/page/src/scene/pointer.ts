/** What the pointer does over the picture: it points, clicks, or drags, which is the camera's. */

import { moved, pressed, type Press } from "../model/gesture";

export interface PointerTold {
  pointed(x: number, y: number): void;
  left(): void;
  /** `add`: with Ctrl or the command key. */
  clicked(x: number, y: number, add: boolean): void;
  clickedRight(x: number, y: number): void;
  /** The wheel was turned; whether that was for a tool, and not for the camera. */
  wheeled(steps: number): boolean;
}

/** px that a touchpad tells for a notch of a wheel */
const NOTCH_PX = 50;

export class PointerWatch {
  private press: Press | null = null;
  private turned = 0;

  constructor(
    private readonly element: HTMLElement,
    private readonly told: PointerTold,
  ) {
    element.addEventListener("pointerdown", this.down);
    element.addEventListener("pointerleave", this.leave);
    element.addEventListener("contextmenu", this.noMenu);
    element.addEventListener("wheel", this.wheel, { passive: false });
    // Before the camera hears of it: what is still a click does not turn it.
    window.addEventListener("pointermove", this.move, true);
    window.addEventListener("pointerup", this.up, true);
    window.addEventListener("pointercancel", this.cancel, true);
  }

  dispose(): void {
    this.element.removeEventListener("pointerdown", this.down);
    this.element.removeEventListener("pointerleave", this.leave);
    this.element.removeEventListener("contextmenu", this.noMenu);
    this.element.removeEventListener("wheel", this.wheel);
    window.removeEventListener("pointermove", this.move, true);
    window.removeEventListener("pointerup", this.up, true);
    window.removeEventListener("pointercancel", this.cancel, true);
  }

  private place(event: MouseEvent): [number, number] {
    const box = this.element.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  private readonly down = (event: PointerEvent): void => {
    // A second finger makes it a gesture of the camera.
    const drag = this.press !== null;
    this.press = { ...pressed(event.pointerId, event.button, event.clientX, event.clientY), drag };
  };

  private readonly move = (event: PointerEvent): void => {
    if (this.press === null) {
      if (event.composedPath()[0] === this.element) this.told.pointed(...this.place(event));
      return;
    }
    if (event.pointerId !== this.press.pointer) return;
    this.press = moved(this.press, event.clientX, event.clientY);
    if (!this.press.drag) event.stopImmediatePropagation();
  };

  private readonly up = (event: PointerEvent): void => {
    const press = this.press;
    if (press?.pointer !== event.pointerId) return;
    this.press = null;
    if (moved(press, event.clientX, event.clientY).drag) return;
    const place = this.place(event);
    if (press.button === 0) this.told.clicked(...place, event.ctrlKey || event.metaKey);
    else if (press.button === 2) this.told.clickedRight(...place);
  };

  private readonly cancel = (): void => {
    this.press = null;
  };

  private readonly leave = (): void => {
    if (this.press === null) this.told.left();
  };

  private readonly noMenu = (event: Event): void => event.preventDefault();

  /** Wheels turn in notches; touchpads tell small parts of them. */
  private readonly wheel = (event: WheelEvent): void => {
    const { deltaY, deltaMode } = event;
    const notch = deltaMode !== WheelEvent.DOM_DELTA_PIXEL || Math.abs(deltaY) >= NOTCH_PX;
    this.turned = notch ? Math.sign(deltaY) : this.turned + deltaY / NOTCH_PX;
    const steps = Math.trunc(this.turned);
    this.turned -= steps;
    if (!event.ctrlKey && this.told.wheeled(steps)) event.preventDefault();
  };
}
