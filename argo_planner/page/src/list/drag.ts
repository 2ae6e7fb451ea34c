/** Dragging of rows to another position in the list. */

import type { ReactiveController } from "lit";

import type { Row } from "../model/outline";
import type { Side } from "../model/task-positions";
import { select, selection } from "../state/plan";
import { mayPlan } from "../state/session";
import { html, nothing, type PageElement } from "../ui/element";
import { styled } from "../ui/styled";
import { moveTo } from "./moving";
import { ROW_HEIGHT } from "./row";
import { folded, shownRows } from "./rows";

/** Return the row that an event belongs to. */
export function rowAt(event: Event): Row | null {
  const found = (event.target as HTMLElement).closest<HTMLElement>("[role=treeitem]");
  return found ? (shownRows.value[Number(found.dataset["index"])] ?? null) : null;
}

export class RowDrag implements ReactiveController {
  /** Whether rows are dragged, rather than a file or a text. */
  private dragging = false;
  private to: { readonly row: Row; readonly side: Side } | null = null;

  constructor(private readonly host: PageElement) {
    host.addController(this);
  }

  hostDisconnected(): void {
    this.to = null;
  }

  readonly begin = (event: DragEvent): void => {
    const row = rowAt(event);
    if (!row || !mayPlan()) return event.preventDefault();
    if (!selection.value.includes(row.key)) select([row.key]);
    event.dataTransfer?.setData("text/plain", row.key);
    this.dragging = true;
  };

  readonly over = (event: DragEvent): void => {
    const row = rowAt(event);
    if (!row || !this.dragging) return;
    event.preventDefault();
    const box = (event.target as HTMLElement).closest("[role=treeitem]")?.getBoundingClientRect();
    const share = box ? (event.clientY - box.top) / box.height : 0;
    const closed = folded.value.has(row.key);
    let side: Side = share < 0.5 ? "before" : "after";
    if (row.kind === "group" && share > 0.3 && !(closed && share > 0.8)) side = "into";
    if (this.to?.row !== row || this.to.side !== side) this.show({ row, side });
  };

  readonly leave = (): void => this.show(null);

  readonly end = (): void => {
    this.dragging = false;
    this.show(null);
  };

  readonly drop = (event: DragEvent): void => {
    if (!this.dragging) return;
    event.preventDefault();
    const to = this.to;
    this.end();
    if (to) void moveTo(to.row, to.side);
  };

  /** Render the position at which the rows would be dropped. */
  mark() {
    if (this.to === null) return nothing;
    const { row, side } = this.to;
    const index = shownRows.value.indexOf(row);
    const top = (side === "after" ? index + 1 : index) * ROW_HEIGHT - (side === "into" ? 0 : 2);
    const place = { top: `${top}px`, left: `${8 + 16 * row.depth}px` };
    return html`<div class=${side === "into" ? "drop into" : "drop"} ${styled(place)}></div>`;
  }

  private show(to: typeof this.to): void {
    this.to = to;
    this.host.requestUpdate();
  }
}
