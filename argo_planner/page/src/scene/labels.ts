/** Text labels beside the marks. They don't catch the pointer. */

import type { Vector3 } from "three";

import { declutter, type LabelRequest, type PlacedLabel, type Side } from "../model/declutter";
import type { Mark } from "./marks";
import type { Stage } from "./stage";

const FONT = "12px system-ui, 'Segoe UI', Roboto, 'Noto Sans', sans-serif";
const HEIGHT = 20;
const [PADDING, BADGE] = [12, 12];
/** px: longer names are truncated */
const WIDEST = 190;
/** More labels would hide the site. */
const MOST = 60;

interface Shown {
  readonly element: HTMLElement;
  content: string;
}

export class Labels {
  private readonly shown = new Map<string, Shown>();
  private readonly widths = new Map<string, number>();
  private readonly ruler = document.createElement("canvas").getContext("2d");
  private sides = new Map<string, Side>();
  private placed: readonly PlacedLabel[] = [];

  constructor(
    private readonly host: HTMLElement,
    private readonly stage: Stage,
  ) {}

  /** Place labels; those of marks `behind` other objects come last, and are faint. */
  update(marks: readonly Mark[], behind: ReadonlySet<string>): void {
    const { width, height } = this.stage.size;
    const wishes: LabelRequest[] = [];
    const byKey = new Map<string, Mark>();
    for (const mark of marks) {
      const seen = this.project(mark.at, width, height);
      if (seen === null) continue;
      byKey.set(mark.key, mark);
      const weight = mark.weight - (behind.has(mark.key) ? 4 : 0) - seen.depth / 200;
      wishes.push({ key: mark.key, x: seen.x, y: seen.y, width: this.width(mark), height: HEIGHT, weight });
    }
    this.placed = declutter(wishes, width, height, this.sides, MOST);
    this.sides = new Map(this.placed.map((one) => [one.key, one.side]));
    for (const one of this.placed) this.draw(one, byKey.get(one.key) as Mark, behind.has(one.key));
    for (const [key, { element }] of this.shown)
      if (!this.sides.has(key)) {
        element.remove();
        this.shown.delete(key);
      }
  }

  /** Return the key of the label at a point (px). */
  at(x: number, y: number): string | null {
    const found = this.placed.find(
      (one) => x >= one.left && x < one.left + one.width && y >= one.top && y < one.top + one.height,
    );
    return found?.key ?? null;
  }

  dispose(): void {
    for (const { element } of this.shown.values()) element.remove();
    this.shown.clear();
  }

  private project(at: Vector3, width: number, height: number) {
    const seen = this.stage.project(at);
    if (seen === null || seen.x < 0 || seen.y < 0 || seen.x > width || seen.y > height) return null;
    return seen;
  }

  private draw(box: PlacedLabel, mark: Mark, behind: boolean): void {
    let shown = this.shown.get(box.key);
    if (shown === undefined) {
      shown = { element: document.createElement("div"), content: "" };
      this.shown.set(box.key, shown);
      this.host.append(shown.element);
    }
    const { element } = shown;
    const content = [mark.numbers, mark.text, mark.value, mark.tone, behind].join("\n");
    if (content !== shown.content) {
      shown.content = content;
      element.className = `label ${mark.tone}${behind ? " behind" : ""}`;
      element.dataset["key"] = mark.key;
      element.replaceChildren(
        ...[mark.numbers, mark.text, mark.value].flatMap((text, index) => {
          if (text === "") return [];
          const part = document.createElement("span");
          part.className = ["numbers", "name", "value"][index] ?? "";
          part.textContent = text;
          return [part];
        }),
      );
      element.style.setProperty("width", `${box.width}px`);
    }
    element.style.setProperty("transform", `translate(${box.left}px, ${box.top}px)`);
  }

  private width(mark: Mark): number {
    const text = [mark.numbers, mark.text, mark.value].filter((one) => one !== "").join(" ");
    const bold = mark.tone !== "plain" && mark.tone !== "dim";
    const known = this.widths.get(`${String(bold)} ${text}`);
    if (known !== undefined) return known;
    if (this.ruler) this.ruler.font = bold ? `600 ${FONT}` : FONT;
    const badges = (mark.numbers === "" ? 0 : BADGE) + (mark.value === "" ? 0 : BADGE / 2);
    const long = (this.ruler?.measureText(text.slice(0, 60)).width ?? 7 * text.length) + PADDING + badges;
    const width = Math.ceil(Math.min(WIDEST, long));
    this.widths.set(`${String(bold)} ${text}`, width);
    return width;
  }
}
