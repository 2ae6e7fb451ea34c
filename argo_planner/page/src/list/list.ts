/** The mission as a list: nested groups that fold, reordered by hand or by keys. Only the rows that
 * are in view are in the page, so that thousands of tasks open and scroll as fast as ten. */

import { effect, untracked } from "@preact/signals-core";
import { repeat } from "lit/directives/repeat.js";

import { isTyping } from "../frame/keys";
import { groupKey, nameOfKey, reactionKey, type Row } from "../model/outline";
import type { Side } from "../model/places";
import { mission, planId, select, selection, tasksByName } from "../state/plan";
import { mayPlan } from "../state/session";
import { lookAt, panel, tool } from "../state/view";
import { t } from "../texts";
import { css, customElement, html, look, nothing, PageElement, query, state } from "../ui/element";
import { icon } from "../ui/icons";
import { styled } from "../ui/styled";
import { copyChosen, deleteChosen, groupChosen, openDetails, paste, renameRow } from "./acting";
import "./add";
import type { AddTasks } from "./add";
import { marksOf } from "./marks";
import { enterGroup, leaveGroup, moveByStep, moveTo } from "./moving";
import "./problems";
import { rowView, ROW_HEIGHT, rowStyles } from "./row";
import { fold, folded, rowOf, shownRows, unfoldAround } from "./rows";

const BEYOND = 12;

@customElement("argo-list")
export class MissionList extends PageElement {
  static override styles = [
    look,
    rowStyles,
    css`
      :host {
        display: grid;
        grid-template-rows: auto auto minmax(0, 1fr) auto;
      }
      .tools {
        display: flex;
        gap: 2px;
        padding: 6px;
        border-bottom: 1px solid var(--line);
      }
      .tree {
        position: relative;
        overflow: auto;
        outline-offset: -2px;
      }
      .all {
        position: relative;
      }
      .drop {
        position: absolute;
        right: 4px;
        z-index: 2;
        height: 3px;
        border-radius: 2px;
        background: var(--accent);
        pointer-events: none;
      }
      .drop.into {
        height: ${ROW_HEIGHT}px;
        border: 2px solid var(--accent);
        background: none;
      }
      .reactions {
        max-height: 26vh;
        overflow: auto;
        border-top: 1px solid var(--line);
      }
      .reactions h2 {
        padding: 6px 10px 2px;
      }
      .reactions button {
        justify-content: start;
        width: 100%;
        text-align: left;
      }
      .empty {
        padding: 16px;
      }
    `,
  ];

  @query(".tree") private readonly tree!: HTMLElement;
  @query("argo-add") private readonly adding!: AddTasks;
  @state() private top = 0;
  @state() private height = 800;
  @state() private renaming: string | null = null;
  @state() private drop: { row: Row; side: Side } | null = null;
  private readonly stop: (() => void)[] = [];
  /** Where Shift extends the selection from. */
  private anchor: string | null = null;
  private resized = new ResizeObserver(([entry]) => {
    if (entry) this.height = entry.contentRect.height;
  });

  override connectedCallback(): void {
    super.connectedCallback();
    addEventListener("keydown", this.onGlobalKey);
    addEventListener("focus-list", this.focusTree);
    addEventListener("paste", this.onPaste);
    addEventListener("copy", this.onCopy);
    const shown = effect(() => {
      const key = selection.value.at(-1);
      untracked(() => this.reveal(key)); // not again when the groups are folded
    });
    this.stop.push(shown);
  }

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    removeEventListener("keydown", this.onGlobalKey);
    removeEventListener("focus-list", this.focusTree);
    removeEventListener("paste", this.onPaste);
    removeEventListener("copy", this.onCopy);
    this.resized.disconnect();
    for (const one of this.stop.splice(0)) one();
  }

  private readonly focusTree = (): void => this.tree.focus();

  override firstUpdated(): void {
    this.resized.observe(this.tree);
  }

  override updated(changes: Map<string, unknown>): void {
    if (!changes.has("renaming") || this.renaming === null) return;
    this.renderRoot.querySelector<HTMLInputElement>(".names input")?.select();
  }

  override render() {
    const texts = t().list;
    const shown = shownRows.value;
    const chosen = new Set(selection.value);
    const may = mayPlan();
    const first = Math.max(0, Math.floor(this.top / ROW_HEIGHT) - BEYOND);
    const last = Math.min(shown.length, Math.ceil((this.top + this.height) / ROW_HEIGHT) + BEYOND);
    const active = selection.value.at(-1);
    const at = shown.findIndex((row) => row.key === active);
    return html`
      <div class="tools" role="toolbar" aria-label=${texts.tasks}>
        <argo-add @focus-list=${this.focusTree}></argo-add>
        <span class="grow"></span>
        <button
          class="bare icon"
          aria-label=${texts.group}
          title=${`${texts.group} (g)`}
          ?disabled=${!may || chosen.size === 0}
          @click=${groupChosen}
        >
          ${icon("group")}
        </button>
        <button
          class="bare icon"
          aria-label=${texts.delete}
          title=${`${texts.delete} (Del)`}
          ?disabled=${!may || chosen.size === 0}
          @click=${deleteChosen}
        >
          ${icon("bin")}
        </button>
      </div>
      <argo-problems></argo-problems>
      <div
        class="tree"
        role="tree"
        tabindex="0"
        aria-label=${texts.tasks}
        aria-multiselectable="true"
        aria-activedescendant=${at >= first && at < last ? `row-${at}` : nothing}
        @scroll=${() => (this.top = this.tree.scrollTop)}
        @keydown=${this.onKey}
        @click=${this.onClick}
        @dblclick=${this.onDoubleClick}
        @dragstart=${this.onDragStart}
        @dragover=${this.onDragOver}
        @dragleave=${() => (this.drop = null)}
        @dragend=${() => (this.drop = null)}
        @drop=${this.onDrop}
      >
        ${shown.length === 0 ? html`<p class="empty dim">${texts.empty}</p>` : nothing}
        <div
          class="all"
          role="presentation"
          ${styled({ height: `${shown.length * ROW_HEIGHT}px` })}
        >
          ${repeat(
            shown.slice(first, last),
            (row) => row.key,
            (row, index) =>
              rowView(row, first + index, {
                chosen: chosen.has(row.key),
                folded: folded.value.has(row.key),
                renaming: this.renaming === row.key,
                of: shown.length,
                marks: marksOf(row),
                may,
                onRename: this.onRename,
              }),
          )}
          ${this.drop ? this.dropMark(this.drop, shown) : nothing}
        </div>
      </div>
      ${this.reactions()}
    `;
  }

  private dropMark({ row, side }: { row: Row; side: Side }, shown: readonly Row[]) {
    const index = shown.indexOf(row);
    const top = (side === "after" ? index + 1 : index) * ROW_HEIGHT - (side === "into" ? 0 : 2);
    const place = { top: `${top}px`, left: `${8 + 16 * row.depth}px` };
    return html`<div class=${side === "into" ? "drop into" : "drop"} ${styled(place)}></div>`;
  }

  private reactions() {
    const found = mission.value?.reactions ?? [];
    if (found.length === 0) return html`<span></span>`;
    const chosen = selection.value.at(-1);
    return html`<section class="reactions">
      <h2>${t().list.reactions}</h2>
      ${found.map((reaction) => {
        const key = reactionKey(reaction.event);
        return html`<button
          class="bare"
          aria-pressed=${chosen === key}
          @click=${() => {
            select([key]);
            panel.value = "properties";
          }}
        >
          ${icon("reaction", 16)}
          <span class="grow"
            >${t().list.when(t().words.event[reaction.event])}
            <span class="dim">${t().words.response[reaction.response]}</span></span
          >
        </button>`;
      })}
    </section>`;
  }

  /** Brings a row into view, and opens the groups that it lies in. */
  private reveal(key: string | undefined): void {
    if (key === undefined || !this.hasUpdated) return;
    if (rowOf(key) === undefined) unfoldAround(key);
    const at = shownRows.value.findIndex((row) => row.key === key) * ROW_HEIGHT;
    void this.updateComplete.then(() => {
      if (at < this.tree.scrollTop) this.tree.scrollTop = at;
      else if (at + ROW_HEIGHT > this.tree.scrollTop + this.height)
        this.tree.scrollTop = at + ROW_HEIGHT - this.height;
    });
  }

  private rowAt(event: Event): Row | null {
    const found = (event.target as HTMLElement).closest<HTMLElement>("[role=treeitem]");
    return found ? (shownRows.value[Number(found.dataset["index"])] ?? null) : null;
  }

  private onClick(event: MouseEvent): void {
    const row = this.rowAt(event);
    if (!row) return;
    if ((event.target as HTMLElement).closest(".fold")) fold(row, !folded.value.has(row.key));
    else this.choose(row, event.shiftKey, event.ctrlKey || event.metaKey);
  }

  private choose(row: Row, extend: boolean, toggle: boolean): void {
    const shown = shownRows.value;
    const { value: chosen } = selection;
    if (this.anchor === null || !chosen.includes(this.anchor)) this.anchor = chosen.at(-1) ?? null;
    if (extend && this.anchor !== null) {
      const from = shown.findIndex((one) => one.key === this.anchor);
      const to = shown.indexOf(row);
      const between = shown.slice(Math.min(from, to), Math.max(from, to) + 1).map((one) => one.key);
      select([...between.filter((key) => key !== row.key), row.key]);
      return;
    }
    this.anchor = row.key;
    if (!toggle) select([row.key]);
    else if (selection.value.includes(row.key)) select(selection.value.filter((k) => k !== row.key));
    else select([...selection.value, row.key]);
  }

  private onDoubleClick(event: MouseEvent): void {
    const row = this.rowAt(event);
    if (row && mayPlan()) this.renaming = row.key;
  }

  /** Keys that work wherever the focus is, but in fields. */
  private readonly onGlobalKey = (event: KeyboardEvent): void => {
    if (event.defaultPrevented || isTyping(event) || planId.value === null) return;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (!mayPlan() && event.key !== "v") return;
    const act = {
      m: () => this.adding.openMeasure(),
      g: () => void groupChosen(),
      v: () => {
        const task = tasksByName.value.get(nameOfKey(selection.value.at(-1) ?? ""));
        if (task) lookAt(task);
      },
      n: () => (tool.value = tool.value === "navigate" ? "select" : "navigate"),
      o: () => (tool.value = tool.value === "obstacle" ? "select" : "obstacle"),
      w: () => this.adding.addAtPlace(),
    }[event.key];
    if (!act) return;
    act();
    event.preventDefault();
  };

  private onKey(event: KeyboardEvent): void {
    if (isTyping(event)) return;
    const shown = shownRows.value;
    const at = shown.findIndex((row) => row.key === selection.value.at(-1));
    const row = shown[at];
    const command = event.ctrlKey || event.metaKey;
    const go = (index: number) => {
      const next = shown[Math.max(0, Math.min(shown.length - 1, index))];
      if (next) this.choose(next, event.shiftKey, false);
    };
    const key = event.altKey ? `Alt+${event.key}` : command ? `Ctrl+${event.key.toLowerCase()}` : event.key;
    const page = Math.max(1, Math.floor(this.height / ROW_HEIGHT) - 1);
    switch (key) {
      case "ArrowDown":
        go(at + 1);
        break;
      case "ArrowUp":
        go(at < 0 ? shown.length - 1 : at - 1);
        break;
      case "Home":
        go(0);
        break;
      case "End":
        go(shown.length - 1);
        break;
      case "PageDown":
        go(at + page);
        break;
      case "PageUp":
        go(at - page);
        break;
      case "ArrowRight":
        if (row?.kind === "group" && folded.value.has(row.key)) fold(row, false);
        else if (row?.kind === "group") go(at + 1);
        break;
      case "ArrowLeft":
        if (row?.kind === "group" && !folded.value.has(row.key)) fold(row, true);
        else if (row?.inside) select([groupKey(row.inside)]);
        break;
      case "Ctrl+a":
        select(shown.map((one) => one.key));
        break;
      case "Enter":
        openDetails();
        break;
      case "F2":
        if (row && mayPlan()) this.renaming = row.key;
        break;
      case "Delete":
      case "Backspace":
        if (mayPlan()) void deleteChosen();
        break;
      case "Alt+ArrowUp":
        if (mayPlan()) void moveByStep("up");
        break;
      case "Alt+ArrowDown":
        if (mayPlan()) void moveByStep("down");
        break;
      case "Alt+ArrowLeft":
        if (mayPlan()) void leaveGroup();
        break;
      case "Alt+ArrowRight":
        if (mayPlan()) void enterGroup();
        break;
      default:
        return;
    }
    event.preventDefault();
  }

  private readonly onRename = (row: Row, name: string): void => {
    this.renaming = null;
    this.tree.focus();
    void renameRow(row, name);
  };

  private readonly onCopy = (event: ClipboardEvent): void => {
    if (planId.value === null || typing() || getSelection()?.toString()) return;
    const text = copyChosen();
    if (text === null) return;
    event.clipboardData?.setData("text/plain", text);
    event.preventDefault();
  };

  private readonly onPaste = (event: ClipboardEvent): void => {
    if (planId.value === null || typing() || !mayPlan()) return;
    event.preventDefault();
    void paste(event.clipboardData?.getData("text/plain") ?? "");
  };

  private onDragStart(event: DragEvent): void {
    const row = this.rowAt(event);
    if (!row || !mayPlan()) return event.preventDefault();
    if (!selection.value.includes(row.key)) select([row.key]);
    event.dataTransfer?.setData("text/plain", row.key);
  }

  private onDragOver(event: DragEvent): void {
    const row = this.rowAt(event);
    if (!row) return;
    event.preventDefault();
    const box = (event.target as HTMLElement).closest("[role=treeitem]")?.getBoundingClientRect();
    const share = box ? (event.clientY - box.top) / box.height : 0;
    const closed = folded.value.has(row.key);
    let side: Side = share < 0.5 ? "before" : "after";
    if (row.kind === "group" && share > 0.3 && !(closed && share > 0.8)) side = "into";
    if (this.drop?.row !== row || this.drop.side !== side) this.drop = { row, side };
  }

  private onDrop(event: DragEvent): void {
    event.preventDefault();
    const drop = this.drop;
    this.drop = null;
    if (drop) void moveTo(drop.row, drop.side);
  }
}

function typing(): boolean {
  let active = document.activeElement;
  while (active?.shadowRoot?.activeElement) active = active.shadowRoot.activeElement;
  return active !== null && active.matches("input, textarea, select");
}
