/** The mission as text, edited either way. */

import type { Diagnostic } from "../api/types";
import {
  lineOf,
  linesBySource,
  linesBySteps,
  nameInLine,
  placeOf,
  severities,
  type Lines,
} from "../model/script-lines";
import { groupKey, nameOfKey, taskKey } from "../model/outline";
import { findings, revision, select, selection, tasksByName } from "../state/plan";
import { reading } from "../state/reading";
import { mayPlan } from "../state/session";
import { t } from "../texts";
import { css, customElement, html, look, nothing, PageElement, query } from "../ui/element";
import { icon } from "../ui/icons";
import {
  apply,
  applying,
  aside,
  base,
  dirty,
  draft,
  overtaken,
  refused,
  takeAside,
  takeTheirs,
  unsaid,
  write,
} from "./draft";
import { confirm, openNotes } from "./notes";

@customElement("argo-script")
export class ScriptPanel extends PageElement {
  static override styles = [
    look,
    css`
      :host {
        display: flex;
        flex-direction: column;
        gap: 8px;
        height: 100%;
        padding: 10px;
      }
      .paper {
        flex: 1;
        min-height: 160px;
        overflow: auto;
        border: 1px solid var(--line);
        border-radius: var(--round);
        background: var(--surface);
      }
      .paper:focus-within {
        outline: 2px solid var(--accent);
      }
      /* The text lies over a mirror of itself, which has the numbers and the marks. */
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
      .told {
        max-height: 34%;
        overflow: auto;
        padding: 8px;
        border-radius: var(--round);
        border: 1px solid var(--line);
        font-size: 13px;
      }
      .told.bad {
        border-color: var(--bad);
      }
      .told.warn {
        border-color: var(--warn);
      }
      ul {
        margin: 4px 0 0;
        padding: 0;
        list-style: none;
      }
      li {
        padding: 3px 0;
        overflow-wrap: anywhere;
      }
      li button {
        min-height: 24px;
        font-size: 12px;
      }
      .error-said {
        color: var(--bad);
      }
      .state {
        font-size: 12px;
      }
    `,
  ];

  @query("textarea") private readonly field!: HTMLTextAreaElement | null;
  @query(".chosen") private readonly chosen!: HTMLElement | null;
  private shownSelection: unknown;

  override render() {
    const texts = t().script;
    const wrong = findings.value.diagnostics.some((one) => one.severity === "error");
    if (base.value === null) {
      const said = unsaid.value ?? (wrong ? texts.hasErrors : texts.loading);
      return html`<p class="dim">${said}</p>`;
    }
    return html`${this.notes()} ${overtaken.value ? this.meanwhile() : nothing}
      <div class="paper">${this.sheet()}</div>
      ${this.problems()} ${unsaid.value === null ? nothing : html`<p class="told warn">${unsaid.value}</p>`}
      <div class="row">
        <button
          class="main"
          id="apply"
          title="Ctrl+Enter"
          ?disabled=${!mayPlan() || !dirty.value || applying.value || overtaken.value}
          @click=${() => apply()}
        >
          ${icon("check")} ${applying.value ? texts.applying : texts.apply}
        </button>
        ${dirty.value ? html`<button @click=${takeTheirs}>${texts.revert}</button>` : nothing}
        ${aside.value === null || dirty.value
          ? nothing
          : html`<button @click=${takeAside}>${icon("undo", 16)} ${texts.back}</button>`}
        <span class="dim state grow" role="status">
          ${!mayPlan() ? texts.mayNotPlan : dirty.value ? texts.changed : texts.unchanged}
        </span>
      </div>`;
  }

  private sheet() {
    const text = draft.value;
    const found = refused.value?.text === text ? refused.value.found : [];
    const marks = severities(found);
    const places = this.places();
    const chosen = selection.value.map((key) => places.get(nameOfKey(key)));
    const isChosen = (line: number) =>
      chosen.some((part) => part !== undefined && part.from <= line && line <= part.to);
    return html`<div class="sheet">
      <div class="mirror" aria-hidden="true">
        ${text.split("\n").map((line, at) => {
          const marked = marks.get(at + 1) ?? (isChosen(at + 1) ? "chosen" : "");
          return html`<div class=${marked}>${line}</div>`;
        })}
      </div>
      <textarea
        aria-label=${t().script.title}
        spellcheck="false"
        autocomplete="off"
        autocapitalize="off"
        ?readonly=${!mayPlan()}
        .value=${text}
        @input=${(event: Event) => write((event.target as HTMLTextAreaElement).value)}
        @keydown=${this.onKey}
        @click=${this.onClick}
      ></textarea>
    </div>`;
  }

  /** Where in the text each task stands, as long as the text is the mission. */
  private places(): Map<string, Lines> {
    const from = base.value;
    const read = reading.value;
    if (from === null || read === null || dirty.value || read.revision !== revision.value) return new Map();
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
    if (mayPlan() && dirty.value && !overtaken.value) void apply();
  }

  /** Whoever clicks into the text means the task there. */
  private onClick(): void {
    const field = this.field;
    if (field === null || dirty.value || field.selectionStart !== field.selectionEnd) return;
    const name = nameInLine(this.places(), lineOf(field.value, field.selectionStart));
    if (name !== null) select([tasksByName.value.has(name) ? taskKey(name) : groupKey(name)]);
  }

  private meanwhile() {
    const texts = t().script;
    return html`<section class="told warn" role="alert">
      <p>${icon("warning", 14)} ${texts.overtaken}</p>
      <div class="row">
        <button @click=${takeTheirs}>${texts.theirs}</button>
        <button ?disabled=${!mayPlan() || applying.value} @click=${() => apply(true)}>${texts.anyway}</button>
      </div>
    </section>`;
  }

  private problems() {
    const told = refused.value;
    if (told === null || !dirty.value) return nothing;
    const texts = t().script;
    return html`<section class="told bad" aria-label=${texts.problems} role="alert">
      <p>${texts.refused}</p>
      <ul>
        ${told.found.map(
          (one) =>
            html`<li>
              ${one.span
                ? html`<button @click=${() => this.goTo(one)}>${texts.line(one.span.line)}</button>`
                : nothing}
              <span class=${one.severity === "error" ? "error-said" : ""}>${one.message}</span>
              ${one.hint ? html`<br /><span class="dim">${texts.hint(one.hint)}</span>` : nothing}
            </li>`,
        )}
      </ul>
    </section>`;
  }

  private goTo({ span }: Diagnostic): void {
    const field = this.field;
    if (!span || field === null) return;
    const at = placeOf(field.value, span.line, span.column);
    field.focus();
    field.setSelectionRange(at, at + span.length);
    this.renderRoot.querySelectorAll(".mirror div")[span.line - 1]?.scrollIntoView({ block: "nearest" });
  }

  private notes() {
    const open = openNotes.value;
    if (open.length === 0) return nothing;
    const texts = t().script;
    return html`<section class="told warn" aria-label=${texts.notes}>
      <div class="row">
        <h3 class="grow">${texts.notes}</h3>
        ${open.length > 1
          ? html`<button id="confirm-all" @click=${() => confirm(open)}>${icon("check", 14)} ${texts.confirmAll}</button>`
          : nothing}
      </div>
      <ul>
        ${open.map(
          (note) =>
            html`<li class="row">
              <span class="grow">
                ${note.said.span ? html`<span class="dim">${texts.line(note.said.span.line)}:</span>` : nothing}
                ${note.said.message}
                ${note.said.excerpt ? html`<br /><span class="dim">${note.said.excerpt}</span>` : nothing}
              </span>
              <button @click=${() => confirm([note])}>${icon("check", 14)} ${texts.confirm}</button>
            </li>`,
        )}
      </ul>
    </section>`;
  }
}
