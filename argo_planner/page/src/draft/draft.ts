/** The draft of a script: its lines and what they become, in two columns. Everything works by keyboard. */

import { computed, untracked } from "@preact/signals-core";
import { guard } from "lit/directives/guard.js";
import { repeat } from "lit/directives/repeat.js";

import type { Diagnostic, DraftState } from "../api/types";
import { isTyping } from "../frame/keys";
import { isLeft, isRefused, type LineAct, messagesByLine, nextLeft, type ShownLine } from "../model/draft-lines";
import { mayPlan, service } from "../state/session";
import { world } from "../state/world";
import { language, t } from "../texts";
import { placeBefore, spokenPlace } from "../texts/place";
import { options, valueOf } from "../ui/controls";
import { css, customElement, html, nothing, PageElement, query, state } from "../ui/element";
import { icon } from "../ui/icons";
import { draftRow, draftRowStyles, messageText, type RowHandlers } from "./row";
import {
  actsSaved,
  canUndo,
  chooseAreas,
  completeDraft,
  decide,
  followOthers,
  namingNothing,
  openedDraft,
  pendingActs,
  returnedTexts,
  sendingActs,
  shownLines,
  toAnswer,
  toConfirm,
  undoLast,
} from "./state";

@customElement("argo-draft")
export class DraftView extends PageElement {
  static override styles = [
    draftRowStyles,
    css`
      :host {
        overflow: auto;
        scroll-padding: 90px 0 30px;
      }
      .page {
        max-width: 1240px;
        margin: 0 auto;
        padding: 0 12px 40px;
      }
      .head {
        display: grid;
        gap: 6px;
        padding-top: 14px;
      }
      .head h1 {
        overflow-wrap: anywhere;
      }
      .bar {
        position: sticky;
        top: 0;
        z-index: 2;
        display: flex;
        flex-wrap: wrap;
        align-items: center;
        gap: 8px;
        padding: 8px 0;
        background: var(--ground);
        border-bottom: 1px solid var(--line);
      }
      .count {
        flex: 1 0 auto;
        max-width: 100%;
        font-weight: 600;
      }
      #plan {
        margin-left: auto;
      }
      .columns {
        display: grid;
        grid-template-columns: minmax(0, 2fr) minmax(0, 3fr);
        font-weight: 600;
        border-bottom: 1px solid var(--line);
        border-left: 4px solid transparent;
      }
      .columns [role="columnheader"] {
        padding: 8px 12px;
      }
      .columns [role="columnheader"]:first-child {
        padding-left: 56px;
      }
      [role="grid"] {
        margin-top: 8px;
        border: 1px solid var(--line);
        border-radius: var(--round);
        background: var(--surface);
      }
      .told {
        margin-top: 8px;
        padding: 8px 12px;
        border: 1px solid var(--warn);
        border-radius: var(--round);
      }
      .told.bad {
        border-color: var(--bad);
      }
      .told li {
        padding: 2px 0;
        overflow-wrap: anywhere;
      }
      dialog {
        width: min(620px, calc(100vw - 24px));
        max-height: calc(100dvh - 24px);
        padding: 14px;
        border: 1px solid var(--line);
        border-radius: 10px;
        background: var(--raised);
        color: var(--text);
      }
      dialog form {
        display: grid;
        gap: 10px;
      }
      dialog ul {
        max-height: 50dvh;
        overflow: auto;
        padding: 4px 8px;
        border: 1px solid var(--line);
        border-radius: var(--round);
      }
      dialog li {
        padding: 2px 0;
        overflow-wrap: anywhere;
      }
      .areas {
        display: flex;
        flex-wrap: wrap;
        align-items: end;
        gap: 10px;
      }
      @media (max-width: 900px) {
        .bar .long {
          position: absolute;
          width: 1px;
          height: 1px;
          overflow: hidden;
          clip-path: inset(50%);
          white-space: nowrap;
        }
      }
      @media (max-width: 700px) {
        .columns {
          display: none;
        }
        .count {
          flex-basis: 100%;
        }
        #saved,
        #plan {
          order: 1;
        }
      }
      @media (max-height: 480px) {
        .bar {
          position: static;
        }
      }
    `,
  ];

  /** Index of the row that can be reached by Tab. */
  @state() private active = 0;
  /** Fields for other words: the labels of their lines, each with the text at the beginning; null: the person has
   * closed the field of a text that was not understood. */
  @state() private fields: ReadonlyMap<string, string | null> = NO_FIELDS;
  @state() private announced = "";
  @state() private completing = false;
  /** The lines that name nothing, while they are listed to be set aside; null: they are not. */
  @state() private listed: readonly ShownLine[] | null = null;
  @query("#plan") private readonly planButton!: HTMLButtonElement | null;
  private shownId: string | null = null;
  /** The labels of the lines that are being read with other words. */
  private reading: readonly string[] = [];
  /** Where the focus goes after the next drawing. */
  private focusNext: "row" | "field" | "plan" | null = null;

  constructor() {
    super();
    this.listen("keydown", this.onWindowKey);
    this.watch(() => {
      const id = openedDraft.value?.id ?? null;
      if (id === this.shownId) return;
      this.shownId = id;
      this.fields = NO_FIELDS;
      this.active = Math.max(0, nextLeft(shownLines.peek(), -1));
      this.focusNext = "row";
    });
    this.watch(() => (this.fields = new Map([...untracked(() => this.fields), ...returnedTexts.value])));
    this.watch(() => this.onRead(shownLines.value));
  }

  private endFollowing: (() => void) | null = null;

  override connectedCallback(): void {
    super.connectedCallback();
    this.endFollowing = followOthers();
  }

  override disconnectedCallback(): void {
    this.endFollowing?.();
    super.disconnectedCallback();
  }

  override updated(): void {
    const dialog = this.renderRoot.querySelector("dialog");
    if (dialog?.open === false) dialog.showModal();
    if (!isShown()) return;
    const goal = this.focusNext;
    this.focusNext = null;
    if (goal === "row") this.focusRow();
    if (goal === "plan") this.planButton?.focus();
    if (goal === "field") {
      const field = this.renderRoot.querySelector<HTMLInputElement>(`#line-${this.active} form input`);
      field?.focus();
      const line = shownLines.value[this.active];
      if (line && !isRefused(line)) field?.select(); // what a person wrote is to be corrected, not replaced
    }
  }

  private focusRow(): void {
    const row = this.renderRoot.querySelector<HTMLElement>(`#line-${this.active}`);
    row?.focus({ preventScroll: true });
    row?.scrollIntoView({ block: "nearest" });
  }

  override render() {
    const draft = openedDraft.value;
    if (draft === null || !isShown()) return nothing;
    const texts = t().draft;
    const may = mayPlan();
    const lines = shownLines.value;
    const notes = notesByLine.value;
    const spoken = language.value;
    return html`<main class="page">
      ${this.head(draft, may)} ${this.areas(draft, may)} ${this.messages(draft)}
      <div
        role="grid"
        aria-label=${texts.lines}
        aria-rowcount=${lines.length + 1}
        aria-colcount="2"
        @keydown=${this.onKey}
        @focusin=${this.onFocus}
        @click=${this.onClick}
      >
        <div role="row" class="columns" aria-rowindex="1">
          <span role="columnheader">${texts.script}</span>
          <span role="columnheader">${texts.becomes}</span>
        </div>
        ${repeat(
          lines,
          (line) => line.label,
          (line, index) => {
            const active = index === this.active;
            const editing = this.fieldText(line);
            const told = notes.get(line.label) ?? NONE;
            return guard([line, index, active, editing, may, told.length, spoken], () =>
              draftRow(line, { index, active, editing, may, notes: told }, this.handlers),
            );
          },
        )}
      </div>
      <p class="unseen" role="status" aria-live="polite">${this.announced}</p>
      ${this.idleDialog()}
    </main>`;
  }

  private head(draft: DraftState, may: boolean) {
    const texts = t().draft;
    const [confirming, answering] = [toConfirm.value, toAnswer.value];
    const left = confirming + answering;
    return html`<div class="head">
      <div class="row">
        <h1 class="grow">${texts.title(draft.source_name)}</h1>
      </div>
      <p class="dim lead">${!may ? texts.mayNot : left > 0 ? texts.explained : draft.is_complete || !actsSaved.value ? texts.complete : texts.nearlyComplete}</p>
      </div>
      <div class="bar">
        <span id="left" class="count">
          ${left === 0
            ? texts.nothingLeft
            : [confirming > 0 ? texts.toConfirm(confirming) : "", answering > 0 ? texts.toAnswer(answering) : ""]
                .filter(Boolean)
                .join(", ")}
        </span>
        <span class="dim" id="saved">${actsSaved.value ? texts.saved : texts.saving}</span>
        ${may && confirming > 1
          ? html`<button id="confirm-all" title="Shift+C" @click=${this.confirmAll}>
              ${icon("check", 16)} ${texts.confirmAll(confirming)}
            </button>`
          : nothing}
        ${may && namingNothing.value.length > 1
          ? html`<button id="set-aside-idle" title="Shift+X" @click=${this.listIdle}>
              ${icon("minus", 16)} ${texts.setAsideIdle(namingNothing.value.length)}
            </button>`
          : nothing}
        ${left > 0
          ? html`<button id="next" title="n" @click=${() => this.goToLeft(1)}>${icon("down", 16)} <span class="long">${texts.next}</span></button>`
          : nothing}
        ${may
          ? html`<button id="undo-last" title="Ctrl+Z" ?disabled=${!canUndo.value} @click=${this.undoLast}>
              ${icon("undo", 16)} <span class="long">${texts.undoLast}</span>
            </button>`
          : nothing}
        <button
          id="plan"
          class="main"
          title="Ctrl+Enter"
          ?disabled=${!may || left > 0 || this.completing || (actsSaved.value && !draft.is_complete)}
          @click=${this.complete}
        >
          ${icon("flag", 16)} ${this.completing ? texts.planning : texts.plan}
        </button>
      </div>`;
  }

  /** List the lines that name nothing, before they are set aside. */
  private idleDialog() {
    const lines = this.listed;
    if (lines === null) return nothing;
    const texts = t().draft;
    return html`<dialog aria-labelledby="idle-title" @close=${this.closeIdle}>
      <form @submit=${this.setAsideIdle}>
        <h2 id="idle-title">${texts.idleTitle(lines.length)}</h2>
        <p>${texts.idleExplained}</p>
        <ul tabindex="0" aria-label=${texts.lines}>
          ${lines.map((line) => html`<li><span class="dim">${spokenPlace(line.place) || texts.line(line.label)}:</span> ${line.text}</li>`)}
        </ul>
        <div class="row">
          <button class="main" autofocus>${texts.idleApply(lines.length)}</button>
          <button type="button" @click=${this.closeIdle}>${texts.cancel}</button>
        </div>
      </form>
    </dialog>`;
  }

  private readonly listIdle = (): void => {
    if (mayPlan() && namingNothing.value.length > 0) this.listed = namingNothing.value;
  };

  private readonly closeIdle = (): void => {
    if (this.listed === null) return;
    this.listed = null;
    this.focusNext = "row";
  };

  /** Set aside the lines that were listed, as far as they are still open. */
  private readonly setAsideIdle = (event: SubmitEvent): void => {
    event.preventDefault();
    const shown = new Set(this.listed?.map((line) => line.label));
    const lines = namingNothing.value.filter((line) => shown.has(line.label));
    this.listed = null;
    this.actOnMany(lines, "set_aside", t().draft.manySetAside(lines.length));
  };

  /** Render the choice of areas that the script leaves open. */
  private areas(draft: DraftState, may: boolean) {
    const texts = t().draft;
    const [start, end] = [draft.start_area ?? null, draft.end_area ?? null];
    const asks = { start: draft.areas_to_choose.includes("start"), end: draft.areas_to_choose.includes("end") };
    if (!asks.start && !asks.end && start === null && end === null) return nothing;
    const all = [["", texts.leftOpen] as const, ...(world.value?.docks ?? []).map(({ area }) => [String(area), area] as const)];
    const numberOf = (text: string) => (text === "" ? null : Number(text));
    const choice = (id: string, label: string, value: number | null | undefined, choose: (text: string) => void) =>
      html`<label>
        ${label}
        <select id=${id} ?disabled=${!may || sendingActs.value} @change=${(event: Event) => choose(valueOf(event))}>
          ${options(all, typeof value === "number" ? String(value) : "")}
        </select>
      </label>`;
    return html`<section class="told" aria-label=${texts.areas}>
      <p>${texts.areas}</p>
      <div class="areas">
        ${asks.start || start !== null
          ? choice("start-area", texts.startArea, start, (text) => void chooseAreas(numberOf(text), end))
          : nothing}
        ${asks.end || end !== null
          ? choice("end-area", texts.endArea, end, (text) => void chooseAreas(start, numberOf(text)))
          : nothing}
      </div>
    </section>`;
  }

  /** Render the errors of the mission as a whole. */
  private messages(draft: DraftState) {
    const errors = draft.diagnostics.filter((one) => one.severity === "error" && one.code !== "script.area-choice");
    if (errors.length === 0) return nothing;
    return html`<section class="told bad" role="alert" aria-label=${t().draft.messages}>
      <ul>
        ${errors.slice(0, 20).map(
          (one) =>
            html`<li>${placeBefore(one)}${messageText(one.message)}${one.hint ? html`<br /><span class="dim">${messageText(one.hint)}</span>` : nothing}</li>`,
        )}
      </ul>
    </section>`;
  }

  // ---- acts

  private readonly handlers: RowHandlers = {
    confirm: (line) => {
      if (line.state !== "proposed") return;
      this.decideOn(line, { kind: "confirm", label: line.label, sentences: line.sentences }, t().draft.confirmed(line.label));
    },
    setAside: (line) => {
      if (line.state === "set aside") return;
      this.decideOn(line, { kind: "set_aside", label: line.label, sentences: [] }, t().draft.wasSetAside(line.label));
    },
    choose: (line, number) => {
      const sentences = line.choices[number - 1];
      if (sentences === undefined || !isLeft(line)) return;
      const told = sentences.length > 0 ? t().draft.wasChosen(line.label, sentences.join(" ")) : t().draft.wasSetAside(line.label);
      this.decideOn(line, { kind: "choose", label: line.label, sentences, number }, told);
    },
    edit: (line) => {
      this.setActive(line);
      this.setField(line, this.fieldText(line) ?? (line.sentences.join(" ") || line.text));
      this.focusNext = "field";
      this.requestUpdate();
    },
    undo: (line) => {
      if (line.act === null || line.act === undefined) return;
      decide([{ kind: "undo", label: line.label, sentences: [] }]);
      this.announced = t().draft.undone(line.label);
      this.setActive(line);
      this.focusNext = "row";
    },
    say: (line, text) => {
      this.decideOn(line, { kind: "say", label: line.label, sentences: [text] }, t().draft.isRead(line.label));
    },
    cancel: (line) => {
      this.setField(line, null);
      this.setActive(line);
      this.focusNext = "row";
    },
  };

  /** Return the text at the beginning of the field for other words of a line; null: it has no field. The field of a
   * text that is not understood stays open. */
  private fieldText(line: ShownLine): string | null {
    const text = this.fields.get(line.label);
    return text === undefined && isRefused(line) ? line.sentences.join(" ") : (text ?? null);
  }

  /** Open the field of a line with a text, or close it (null). */
  private setField(line: ShownLine, text: string | null): void {
    this.fields = new Map([...this.fields, [line.label, text]]);
  }

  /** Announce which texts are not understood, once they have been read. If the person waits for one of them, go to its
   * field, or on to the next line that is left. */
  private onRead(lines: readonly ShownLine[]): void {
    const done = lines.filter((line) => !line.reading && this.reading.includes(line.label));
    this.reading = pendingActs.value.filter((act) => act.kind === "say").map((act) => act.label);
    for (const line of done) {
      const waits = lines[this.active]?.label === line.label && this.shadowRoot?.activeElement?.id === `line-${this.active}`;
      if (isRefused(line)) this.announced = t().draft.notRead(line.label);
      if (waits && isRefused(line)) this.focusNext = "field";
      else if (waits) this.goOn();
    }
  }

  /** Carry out an act on a line, and go on to the next one that is left. */
  private decideOn(line: ShownLine, act: LineAct, told: string): void {
    if (!mayPlan() || (line.reading && act.kind !== "say")) return;
    this.fields = new Map([...this.fields].filter(([label]) => label !== line.label));
    decide([act]);
    this.announce(told);
    this.setActive(line);
    this.goOn();
  }

  /** Go to the next line that is left after the active one, or to the button that plans the mission. */
  private goOn(from = this.active): void {
    const next = nextLeft(shownLines.peek(), from);
    if (next >= 0) this.active = next;
    this.focusNext = next >= 0 ? "row" : "plan";
  }

  private announce(told: string): void {
    this.announced = `${told} ${t().draft.left(toConfirm.value + toAnswer.value)}`;
  }

  private readonly confirmAll = (): void => {
    const proposed = shownLines.value.filter((line) => line.state === "proposed");
    this.actOnMany(proposed, "confirm", t().draft.allConfirmed(proposed.length));
  };

  /** Carry out one kind of act on several lines, and go to the next line that is left. */
  private actOnMany(lines: readonly ShownLine[], kind: "confirm" | "set_aside", told: string): void {
    if (!mayPlan() || lines.length === 0) return;
    decide(lines.map(({ label, sentences }) => ({ kind, label, sentences: kind === "confirm" ? sentences : [] })));
    this.announce(told);
    this.goOn(this.active - 1);
  }

  private readonly undoLast = (): void => {
    const label = mayPlan() ? undoLast() : null;
    if (label === null) return;
    this.announced = t().draft.undone(label);
    this.active = Math.max(0, shownLines.value.findIndex((line) => line.label === label));
    this.focusNext = "row";
  };

  private readonly complete = async (): Promise<void> => {
    if (this.completing || this.planButton?.disabled !== false) return;
    this.completing = true;
    try {
      const id = await completeDraft();
      if (id !== null) location.hash = `#/missions/${id}`;
    } finally {
      this.completing = false;
    }
  };

  private goToLeft(step: 1 | -1): void {
    const next = nextLeft(shownLines.value, this.active, step);
    if (next < 0) return;
    this.active = next;
    this.focusNext = "row";
    this.requestUpdate();
  }

  private setActive(line: ShownLine): void {
    const at = shownLines.value.findIndex((one) => one.label === line.label);
    if (at >= 0) this.active = at;
  }

  // ---- keys

  private onFocus(event: FocusEvent): void {
    const index = indexOf(event);
    if (index !== null) this.active = index;
  }

  /** Give a line that is clicked beside its buttons the focus. */
  private onClick(event: MouseEvent): void {
    const index = indexOf(event);
    if (index === null || (event.target as HTMLElement).closest("button, input")) return;
    if (!getSelection()?.isCollapsed) return; // words are being selected
    this.active = index;
    this.focusNext = "row";
    this.requestUpdate();
  }

  private onKey(event: KeyboardEvent): void {
    const line = shownLines.value[this.active];
    if (event.key === "Escape" && line && this.fieldText(line) !== null) this.handlers.cancel(line);
    else if (isTyping(event) || event.ctrlKey || event.metaKey || event.altKey || !this.onPlainKey(event)) return;
    event.preventDefault();
  }

  private onPlainKey(event: KeyboardEvent): boolean {
    const line = shownLines.value[this.active];
    const last = shownLines.value.length - 1;
    const moves: Record<string, number> = {
      ArrowUp: this.active - 1,
      ArrowDown: this.active + 1,
      PageUp: this.active - 10,
      PageDown: this.active + 10,
      Home: 0,
      End: last,
    };
    const to = moves[event.key];
    if (to !== undefined) {
      this.active = Math.min(last, Math.max(0, to));
      this.focusNext = "row";
      this.requestUpdate();
    } else if (event.key === "n" || event.key === "N") this.goToLeft(event.key === "n" ? 1 : -1);
    else if (line === undefined || !mayPlan()) return false;
    else if (event.key === "C") this.confirmAll();
    else if (event.key === "X") this.listIdle();
    else if (event.key === "c") this.handlers.confirm(line);
    else if (event.key === "x" || event.key === "Delete") this.handlers.setAside(line);
    else if (event.key === "e" || event.key === "F2") this.handlers.edit(line);
    else if (event.key === "u") this.handlers.undo(line);
    else if (/^[1-9]$/.test(event.key)) this.handlers.choose(line, Number(event.key));
    else return false;
    return true;
  }

  /** Handle the keys that work outside of the lines, too. */
  private readonly onWindowKey = (event: KeyboardEvent): void => {
    if (event.defaultPrevented || !(event.ctrlKey || event.metaKey)) return;
    if (event.key === "Enter") void this.complete();
    else if (event.key.toLowerCase() === "z" && !isTyping(event)) this.undoLast();
    else return;
    event.preventDefault();
  };
}

const NONE: readonly Diagnostic[] = [];
const NO_FIELDS: ReadonlyMap<string, string | null> = new Map();

/** Return whether the draft is shown: keys would have no effect before it is known what the person may do. */
function isShown(): boolean {
  return openedDraft.value !== null && service.value !== null;
}

/** Return the index of the line that an event comes from; null: none. */
function indexOf(event: Event): number | null {
  const row = (event.target as HTMLElement).closest<HTMLElement>(".line");
  return row === null ? null : Number(row.dataset["index"]);
}

/** The warnings and notes about each line, by its label. */
const notesByLine = computed(() => {
  const draft = openedDraft.value;
  const notes = draft?.diagnostics.filter((one) => one.severity !== "error") ?? [];
  return messagesByLine(draft?.lines ?? [], notes);
});
