/** The mission as a list of nested groups that can be folded and reordered by mouse or keyboard. Only visible
 * rows are in the DOM, so that thousands of tasks open and scroll as fast as ten. */

import { untracked } from "@preact/signals-core";
import { repeat } from "lit/directives/repeat.js";

import { isTyping } from "../frame/keys";
import { nameOfKey, type Row } from "../model/outline";
import { identityOf } from "../state/identity";
import { planId, select, selection, tasksByName } from "../state/plan";
import { mayPlan } from "../state/session";
import { lookAt, pointedName, showList, tool } from "../state/view";
import { t } from "../texts";
import { iconButton, valueOf } from "../ui/controls";
import { css, customElement, html, nothing, PageElement, query, state } from "../ui/element";
import { styled } from "../ui/styled";
import { copySelection, deleteSelection, groupSelection, pasteTasks, renameRow } from "./actions";
import "./add";
import type { AddTasks } from "./add";
import { branchLines, branches, branchStyles, branchWidth } from "./branches";
import { RowDrag, rowAt } from "./drag";
import { onListKey } from "./keys";
import { marksOf } from "./marks";
import "./problems";
import "./reactions";
import { nameOf, rowView, ROW_HEIGHT, rowStyles } from "./row";
import { allRows, chooseRow, filter, setFolded, folded, rowOf, shownRows, unfoldAround } from "./rows";

const BEYOND = 12;

@customElement("argo-list")
export class MissionList extends PageElement {
  static override styles = [
    rowStyles,
    branchStyles,
    css`
      :host {
        display: grid;
        grid-template-rows: auto auto auto minmax(0, 1fr) auto;
      }
      .tools {
        grid-row: 1;
        display: flex;
        gap: 2px;
        padding: 6px;
        border-bottom: 1px solid var(--line);
      }
      .filter {
        display: flex;
        align-items: center;
        gap: 6px;
        grid-row: 2;
        padding: 4px 6px;
        border-bottom: 1px solid var(--line);
      }
      .filter input {
        flex: 1;
        min-width: 0;
      }
      argo-problems {
        grid-row: 3;
      }
      argo-reactions {
        grid-row: 5;
      }
      .tree {
        grid-row: 4;
        position: relative;
        container-type: inline-size;
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
      .empty {
        padding: 16px;
      }
    `,
  ];

  @query(".tree") private readonly tree!: HTMLElement;
  @query("argo-add") private readonly adding!: AddTasks;
  /** Whether the field for the filter is open. */
  @state() private filtering = false;
  @state() private top = 0;
  @state() private height = 800;
  /** What is being renamed, and the initial text of the field in its row. */
  @state() private naming: { readonly identity: string; readonly text: string } | null = null;
  private readonly drag: RowDrag = new RowDrag(this);
  private resized = new ResizeObserver(([entry]) => {
    if (entry) this.height = entry.contentRect.height;
  });

  constructor() {
    super();
    this.listen("keydown", this.onGlobalKey);
    this.listen("focus-list", this.focusTree);
    this.listen("paste", this.onPaste);
    this.listen("copy", this.onCopy);
    this.watch(() => {
      const key = selection.value.at(-1);
      untracked(() => this.reveal(key)); // not again when groups are folded
    });
  }

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    this.resized.disconnect();
  }

  private readonly focusTree = (): void => this.tree.focus();

  override firstUpdated(): void {
    this.resized.observe(this.tree);
  }

  override updated(changes: Map<string, unknown>): void {
    if (!changes.has("naming") || this.naming === null) return;
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
        ${iconButton("search", texts.filter, this.openFilter, {
          title: `${texts.filter} (/)`,
          expanded: this.filtering,
        })}
        ${iconButton("group", texts.group, groupSelection, {
          title: `${texts.group} (g)`,
          disabled: !may || chosen.size === 0,
        })}
        ${iconButton("bin", texts.delete, deleteSelection, {
          title: `${texts.delete} (Del)`,
          disabled: !may || chosen.size === 0,
        })}
      </div>
      ${this.filtering ? this.filterField() : nothing}
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
        @mouseover=${this.onPoint}
        @mouseleave=${() => (pointedName.value = null)}
        @dragstart=${this.drag.begin}
        @dragover=${this.drag.over}
        @dragleave=${this.drag.leave}
        @dragend=${this.drag.end}
        @drop=${this.drag.drop}
      >
        ${shown.length === 0
          ? html`<p class="empty dim">${filter.value.trim() === "" ? texts.empty : texts.noneMatches}</p>`
          : nothing}
        <div
          class="all"
          role="presentation"
          ${styled({ height: `${shown.length * ROW_HEIGHT}px` })}
        >
          ${repeat(
            shown.slice(first, last),
            (row) => identityOf(row.key),
            (row, index) =>
              rowView(row, first + index, {
                chosen: chosen.has(row.key),
                lit: pointedName.value === nameOfKey(row.key),
                folded: folded.value.has(row.key),
                name: this.naming?.identity === identityOf(row.key) ? this.naming.text : null,
                of: shown.length,
                branches: branchWidth.value,
                marks: marksOf(row),
                may,
                onNamed: this.onNamed,
              }),
          )}
          ${branchLines(branches.value, first, last, at)} ${this.drag.mark()}
        </div>
      </div>
      <argo-reactions></argo-reactions>
    `;
  }

  /** Scroll a row into view and unfold its groups. */
  private reveal(key: string | undefined): void {
    if (key === undefined || !this.hasUpdated) return;
    if (rowOf(key) === undefined) unfoldAround(key);
    const index = shownRows.value.findIndex((row) => row.key === key);
    if (index < 0) return;
    const at = index * ROW_HEIGHT;
    void this.updateComplete.then(() => {
      if (at < this.tree.scrollTop) this.tree.scrollTop = at;
      else if (at + ROW_HEIGHT > this.tree.scrollTop + this.height)
        this.tree.scrollTop = at + ROW_HEIGHT - this.height;
    });
  }

  private readonly openFilter = (): void => {
    this.filtering = true;
    void this.updateComplete.then(() => this.renderRoot.querySelector<HTMLInputElement>("#filter")?.select());
  };

  private filterField() {
    const texts = t().list;
    const [shown, all] = [shownRows.value.length, allRows.value.length];
    return html`<div class="filter">
      <input
        id="filter"
        type="search"
        aria-label=${texts.filter}
        placeholder=${texts.filterHint}
        autocomplete="off"
        .value=${filter.value}
        @input=${(event: Event) => (filter.value = valueOf(event))}
        @keydown=${this.onFilterKey}
      />
      <span class="dim" role="status">${filter.value.trim() === "" ? nothing : texts.matching(shown, all)}</span>
      ${iconButton("close", texts.endFilter, this.endFilter, { size: 14 })}
    </div>`;
  }

  private onFilterKey(event: KeyboardEvent): void {
    if (event.key === "Escape") this.endFilter();
    else if (event.key === "Enter" || event.key === "ArrowDown") {
      const [first] = shownRows.value;
      if (first) chooseRow(first, false, false);
      this.tree.focus();
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }

  private readonly endFilter = (): void => {
    filter.value = "";
    this.filtering = false;
    this.tree.focus();
  };

  private onClick(event: MouseEvent): void {
    const row = rowAt(event);
    if (!row) {
      if (event.target === this.tree) select([]); // a click beside the rows selects the mission itself
      return;
    }
    if ((event.target as HTMLElement).closest(".fold")) setFolded(row, !folded.value.has(row.key));
    else chooseRow(row, event.shiftKey, event.ctrlKey || event.metaKey);
  }

  /** Light the words of a task in the script. */
  private onPoint(event: MouseEvent): void {
    const row = rowAt(event);
    pointedName.value = row ? nameOfKey(row.key) : null;
  }

  private onDoubleClick(event: MouseEvent): void {
    const row = rowAt(event);
    if (row) this.beginNaming(row);
  }

  /** Handle keys that work everywhere but in fields. */
  private readonly onGlobalKey = (event: KeyboardEvent): void => {
    if (event.defaultPrevented || isTyping(event) || planId.value === null) return;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (!mayPlan() && event.key !== "v" && event.key !== "/") return;
    const act = {
      "/": () => {
        showList();
        this.openFilter();
      },
      m: () => {
        showList();
        this.adding.openMeasure();
      },
      g: () => void groupSelection(),
      v: () => {
        const task = tasksByName.value.get(nameOfKey(selection.value.at(-1) ?? ""));
        if (task) lookAt(task);
      },
      n: () => (tool.value = tool.value === "navigate" ? "select" : "navigate"),
      o: () => (tool.value = tool.value === "obstacle" ? "select" : "obstacle"),
      w: () => {
        showList();
        this.adding.addAtPlace();
      },
    }[event.key];
    if (!act) return;
    act();
    event.preventDefault();
  };

  private onKey(event: KeyboardEvent): void {
    if (isTyping(event)) return;
    const page = Math.max(1, Math.floor(this.height / ROW_HEIGHT) - 1);
    if (event.key === "F2") {
      const row = rowOf(selection.value.at(-1));
      if (row) this.beginNaming(row);
    } else if (!onListKey(event, page)) return;
    event.preventDefault();
  }

  private beginNaming(row: Row): void {
    if (mayPlan()) this.naming = { identity: identityOf(row.key), text: nameOf(row) };
  }

  /** Save the typed name. If it is refused, the field opens again with the text. */
  private readonly onNamed = async (row: Row, name: string, byKey: boolean): Promise<void> => {
    if (this.naming?.identity !== identityOf(row.key)) return; // the field loses the focus because it is removed
    this.naming = null;
    if (byKey) this.tree.focus();
    if (!(await renameRow(row, name))) this.nameAgain(row, name);
  };

  private nameAgain(row: Row, text: string): void {
    this.naming ??= { identity: identityOf(row.key), text };
  }

  private readonly onCopy = (event: ClipboardEvent): void => {
    if (planId.value === null || typing() || getSelection()?.toString()) return;
    const text = copySelection();
    if (text === null) return;
    event.clipboardData?.setData("text/plain", text);
    event.preventDefault();
  };

  private readonly onPaste = (event: ClipboardEvent): void => {
    if (planId.value === null || typing() || !mayPlan()) return;
    event.preventDefault();
    void pasteTasks(event.clipboardData?.getData("text/plain") ?? "");
  };
}

function typing(): boolean {
  let active = document.activeElement;
  while (active?.shadowRoot?.activeElement) active = active.shadowRoot.activeElement;
  return active !== null && active.matches("input, textarea, select");
}
