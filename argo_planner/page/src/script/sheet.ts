/** The editor of the script: numbered lines, with marks of diagnostics and of the selection. */

import type { Diagnostic } from "../api/types";
import { groupKey, nameOfKey, taskKey } from "../model/outline";
import {
  lineOf,
  linesBySource,
  linesBySteps,
  nameInLine,
  offsetOf,
  worstSeverities,
  type Lines,
} from "../model/script-lines";
import { pointedName } from "../state/view";
import { revision, select, selection, tasksByName } from "../state/plan";
import { missionSentences } from "../state/sentences";
import { mayPlan } from "../state/session";
import { t } from "../texts";
import { valueOf } from "../ui/controls";
import { css, customElement, html, PageElement, query } from "../ui/element";
import { applyDraft, baseScript, draftIsChanged, draft, draftIsOutdated, refusedDraft, editDraft } from "./draft";

@customElement("argo-script-sheet")
export class ScriptSheet extends PageElement {
  static override styles = css`
    :host {
      display: flex;
      flex: 1;
      flex-direction: column;
      min-height: 160px;
    }
    .paper {
      flex: 1;
      min-height: 0;
      overflow: auto;
      border: 1px solid var(--line);
      border-radius: var(--round);
      background: var(--surface);
    }
    .paper:focus-within {
      outline: 2px solid var(--accent);
    }
    /* The text area lies over a mirror of the text, which draws the numbers and marks. */
    .sheet {
      display: grid;
      min-height: 100%;
    }
    .mirror,
    textarea {
      grid-area: 1 / 1;
      margin: 0;
      padding: 6px 8px 6px 42px;
      border: 0;
      font: 13px/1.5 ui-monospace, "DejaVu Sans Mono", monospace;
      white-space: pre-wrap;
      overflow-wrap: anywhere;
      tab-size: 4;
    }
    .mirror {
      white-space: normal;
    }
    .mirror div {
      white-space: pre-wrap;
    }
    textarea {
      position: relative;
      z-index: 1;
      width: 100%;
      height: 100%;
      overflow: hidden;
      resize: none;
      border-radius: 0;
      background: none;
      color: var(--text);
      outline: 0;
    }
    .mirror {
      color: transparent;
      counter-reset: line;
      user-select: none;
      pointer-events: none;
    }
    .mirror div {
      position: relative;
      min-height: 1.5em;
      margin: 0 -8px 0 -42px;
      padding: 0 8px 0 42px;
      counter-increment: line;
    }
    .mirror div::before {
      content: counter(line);
      position: absolute;
      top: 0;
      left: 0;
      width: 32px;
      color: var(--dim);
      font-size: 11px;
      text-align: right;
    }
    .mirror .chosen {
      background: var(--chosen);
    }
    .mirror .lit {
      outline: 2px solid var(--accent);
      outline-offset: -2px;
      background: var(--chosen);
    }
    .mirror .error {
      background: var(--bad-ground);
    }
    .mirror .warning {
      background: var(--warn-ground);
    }
    .mirror .error::before {
      color: var(--bad);
      font-weight: 700;
    }
    .mirror .warning::before {
      color: var(--warn);
      font-weight: 700;
    }
  `;

  @query("textarea") private readonly field!: HTMLTextAreaElement | null;
  @query(".chosen") private readonly chosen!: HTMLElement | null;
  private shownSelection: unknown;

  override render() {
    const text = draft.value;
    const found = refusedDraft.value?.text === text ? refusedDraft.value.found : [];
    const marks = worstSeverities(found);
    const places = this.places();
    const chosen = selection.value.map((key) => places.get(nameOfKey(key)));
    const isChosen = (line: number) =>
      chosen.some((part) => part !== undefined && part.from <= line && line <= part.to);
    const pointed = pointedName.value === null ? undefined : places.get(pointedName.value);
    const isLit = (line: number) => pointed !== undefined && pointed.from <= line && line <= pointed.to;
    return html`<div class="paper"><div class="sheet">
      <div class="mirror" aria-hidden="true">
        ${text.split("\n").map((line, at) => {
          const marked = marks.get(at + 1) ?? (isChosen(at + 1) ? "chosen" : "");
          return html`<div class="${marked} ${isLit(at + 1) ? "lit" : ""}">${line}</div>`;
        })}
      </div>
      <textarea
        aria-label=${t().script.title}
        spellcheck="false"
        autocomplete="off"
        autocapitalize="off"
        ?readonly=${!mayPlan()}
        .value=${text}
        @input=${(event: Event) => editDraft(valueOf(event))}
        @keydown=${this.onKey}
        @click=${this.onClick}
        @mousemove=${this.onPoint}
        @mouseleave=${() => (pointedName.value = null)}
      ></textarea>
    </div></div>`;
  }

  /** Return the lines of each task, while the text is that of the mission. */
  private places(): Map<string, Lines> {
    const from = baseScript.value;
    const read = missionSentences.value;
    if (from === null || read === null || draftIsChanged.value || read.revision !== revision.value) return new Map();
    const { entries } = read.reading;
    return from.own ? linesBySource(from.text, entries) : linesBySteps(from.text, entries);
  }

  override updated(): void {
    if (this.shownSelection === selection.value) return;
    this.shownSelection = selection.value;
    if (this.renderRoot instanceof ShadowRoot && this.renderRoot.activeElement === this.field) return;
    this.chosen?.scrollIntoView({ block: "nearest" });
  }

  private onKey(event: KeyboardEvent): void {
    if (event.key !== "Enter" || !(event.ctrlKey || event.metaKey)) return;
    event.preventDefault();
    if (mayPlan() && draftIsChanged.value && !draftIsOutdated.value) void applyDraft();
  }

  /** Light the task whose line is under the pointer. */
  private onPoint(event: MouseEvent): void {
    const lines = [...this.renderRoot.querySelectorAll(".mirror div")];
    const line = lines.findIndex((one) => event.clientY < one.getBoundingClientRect().bottom) + 1;
    pointedName.value = draftIsChanged.value || line === 0 ? null : nameInLine(this.places(), line);
  }

  /** Select the task at the cursor. */
  private onClick(): void {
    const field = this.field;
    if (field === null || draftIsChanged.value || field.selectionStart !== field.selectionEnd) return;
    const name = nameInLine(this.places(), lineOf(field.value, field.selectionStart));
    if (name !== null) select([tasksByName.value.has(name) ? taskKey(name) : groupKey(name)]);
  }

  /** Move the cursor to a diagnostic. */
  goTo({ span }: Diagnostic): void {
    const field = this.field;
    if (!span || field === null) return;
    const at = offsetOf(field.value, span.line, span.column);
    field.focus();
    field.setSelectionRange(at, at + span.length);
    this.renderRoot.querySelectorAll(".mirror div")[span.line - 1]?.scrollIntoView({ block: "nearest" });
  }
}
