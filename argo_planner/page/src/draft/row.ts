/** A line of a draft: the words of the script, and what they become. */

import type { Diagnostic } from "../api/types";
import { isLeft, isRefused, type ShownLine, splitUnused } from "../model/draft-lines";
import { t } from "../texts";
import { spokenPlace } from "../texts/place";
import { spoken } from "../texts/reasons";
import { css, html, nothing } from "../ui/element";
import { icon, type Icon } from "../ui/icons";

const SIGNS: Record<ShownLine["state"], Icon> = {
  understood: "check",
  proposed: "wand",
  "set aside": "minus",
  open: "question",
};

export const draftRowStyles = css`
  [role="row"].line {
    display: grid;
    grid-template-columns: minmax(0, 2fr) minmax(0, 3fr);
    border-bottom: 1px solid var(--line);
    content-visibility: auto;
    contain-intrinsic-size: auto 56px;
    scroll-margin: 96px 0 40px;
  }
  [role="row"].line:focus-visible,
  [role="row"].line.active {
    outline: 2px solid var(--accent);
    outline-offset: -2px;
  }
  [role="row"].line:not(:focus-visible).active:not(:focus-within) {
    outline-color: var(--line);
  }
  [role="row"].line:hover {
    background: var(--sunken);
  }
  [role="row"].line.chosen {
    background: var(--chosen);
  }
  [role="gridcell"] {
    min-width: 0;
    padding: 8px 12px;
    overflow-wrap: anywhere;
  }
  .line {
    border-left: 4px solid transparent;
  }
  .line.proposed {
    border-left-color: var(--warn);
  }
  .line.open {
    border-left-color: var(--bad);
  }
  .words {
    display: grid;
    grid-template-columns: 44px minmax(0, 1fr);
  }
  .number {
    color: var(--dim);
    font-variant-numeric: tabular-nums;
  }
  .source {
    font: 13px/1.5 ui-monospace, "DejaVu Sans Mono", monospace;
    white-space: pre-wrap;
  }
  .place {
    display: block;
    font-size: 12px;
    color: var(--dim);
  }
  .line.aside .source {
    color: var(--dim);
  }
  .source mark {
    color: inherit;
    background: var(--warn-ground);
    text-decoration: line-through 2px var(--warn);
  }
  .becomes {
    display: grid;
    gap: 6px;
    align-content: start;
    border-left: 1px solid var(--line);
  }
  .settled {
    display: flex;
    flex-wrap: wrap;
    align-items: baseline;
    gap: 4px 10px;
  }
  .badge {
    display: inline-flex;
    align-items: center;
    gap: 4px;
    justify-self: start;
    padding: 1px 8px 1px 5px;
    border-radius: 10px;
    font-size: 12px;
    color: var(--dim);
    background: var(--sunken);
  }
  .badge.proposed {
    color: var(--warn);
    background: var(--warn-ground);
  }
  .badge.open {
    color: var(--bad);
    background: var(--bad-ground);
  }
  .badge.understood {
    color: var(--good);
  }
  .sentence {
    font-weight: 600;
  }
  .line.aside .sentence,
  .plainly {
    font-weight: 400;
    color: var(--dim);
  }
  .buttons,
  .choices {
    display: flex;
    flex-wrap: wrap;
    gap: 6px;
  }
  .choices {
    flex-direction: column;
    align-items: start;
  }
  .choices button {
    text-align: left;
    justify-content: start;
  }
  kbd {
    padding: 0 4px;
    border: 1px solid currentColor;
    border-radius: 4px;
    font: inherit;
    font-size: 11px;
  }
  form {
    display: grid;
    gap: 6px;
  }
  form input {
    width: 100%;
  }
  .reason {
    color: var(--bad);
  }
  .small {
    font-size: 13px;
  }
  @media (hover: none) {
    .buttons kbd {
      display: none;
    }
  }
  @media (max-width: 700px) {
    [role="row"].line {
      grid-template-columns: minmax(0, 1fr);
    }
    .words {
      grid-template-columns: 36px minmax(0, 1fr);
      padding: 8px 8px 4px;
    }
    .becomes {
      border-left: 0;
      padding: 0 8px 10px 44px;
    }
  }
`;

export interface RowHandlers {
  readonly confirm: (line: ShownLine) => void;
  readonly setAside: (line: ShownLine) => void;
  readonly choose: (line: ShownLine, number: number) => void;
  readonly edit: (line: ShownLine) => void;
  readonly undo: (line: ShownLine) => void;
  readonly say: (line: ShownLine, text: string) => void;
  readonly cancel: (line: ShownLine) => void;
}

export interface RowState {
  readonly index: number;
  readonly active: boolean;
  /** Initial text of the field for other words; null: there is no field. */
  readonly editing: string | null;
  readonly may: boolean;
  /** Warnings and notes about the line. */
  readonly notes: readonly Diagnostic[];
}

export function draftRow(line: ShownLine, shown: RowState, on: RowHandlers) {
  const texts = t().draft;
  const aside = line.state === "set aside";
  return html`<div
    role="row"
    id=${`line-${shown.index}`}
    class="line ${aside ? "aside" : line.state} ${shown.active ? "active" : ""}"
    data-index=${shown.index}
    data-label=${line.label}
    data-state=${line.state}
    aria-rowindex=${shown.index + 2}
    aria-label=${rowLabel(line)}
    aria-busy=${line.sending ? "true" : nothing}
    tabindex=${shown.active ? 0 : -1}
  >
    <div role="gridcell" class="words">
      <span class="number" aria-hidden="true">${line.label}</span>
      <div>
        ${line.place ? html`<span class="place">${spokenPlace(line.place)}</span>` : nothing}
        <span class="source"
          >${splitUnused(line.text, aside || line.act === "said" ? [] : line.unused).map((part) =>
            part.unused ? html`<mark title=${texts.unusedMark}>${part.text}</mark>` : part.text,
          )}</span
        >
      </div>
    </div>
    <div role="gridcell" class="becomes">
      <div class=${isLeft(line) ? "" : "settled"}>${badge(line)} ${isLeft(line) ? nothing : meaning(line)}</div>
      ${line.reading ? html`<p class="plainly">${texts.reading}</p>` : nothing}
      ${isLeft(line) && !(shown.editing !== null && isRefused(line)) ? meaning(line) : nothing}
      ${doubts(line, shown.notes)} ${shown.editing !== null && shown.may ? sayForm(line, shown.editing, shown, on) : nothing}
      ${shown.may && (shown.editing === null || isRefused(line)) ? buttons(line, shown, on) : nothing}
    </div>
  </div>`;
}

/** Return what a screen reader says of a row: number, state, and what the line becomes. */
function rowLabel(line: ShownLine): string {
  const texts = t().draft;
  const parts = [texts.line(line.label), ...(line.place ? [spokenPlace(line.place)] : []), texts.state[line.state], line.text];
  if (line.sentences.length > 0) parts.push(`${texts.becomes}: ${line.sentences.join(" ")}`);
  if (line.unused.length > 0 && line.state === "proposed") parts.push(texts.unused(line.unused));
  if (line.reason) parts.push(spoken(line.reason).text);
  return parts.join(". ");
}

function badge(line: ShownLine) {
  const texts = t().draft;
  const by = line.act && !isLeft(line) ? `, ${texts.act[line.act]}` : "";
  return html`<span class="badge ${line.state === "set aside" ? "aside" : line.state}">
    ${icon(SIGNS[line.state], 14)} ${texts.state[line.state]}${by}
    ${line.sending ? html`<span title=${texts.sending}>…</span>` : nothing}
  </span>`;
}

function meaning(line: ShownLine) {
  const texts = t().draft;
  if (line.sentences.length > 0)
    return line.sentences.map((sentence) => html`<p class="sentence" lang="en">${sentence}</p>`);
  if (line.state === "understood")
    return line.steps.length > 0
      ? line.steps.map((step) => html`<p class="plainly" lang="en">${step}.</p>`)
      : html`<p class="plainly">${texts.asWritten}</p>`;
  if (line.state === "set aside") {
    const reason = line.act === null || line.act === undefined ? line.reason : "";
    return html`<p class="plainly">${texts.noEffect}${reason ? html`: ${messageText(reason)}` : nothing}</p>`;
  }
  return nothing;
}

function doubts(line: ShownLine, notes: readonly Diagnostic[]) {
  const texts = t().draft;
  return html`${line.unused.length > 0 && line.state === "proposed"
      ? html`<p class="small">${texts.unused(line.unused)}</p>`
      : nothing}
    ${line.state === "open" && line.reason ? html`<p class="small reason">${messageText(line.reason)}</p>` : nothing}
    ${isLeft(line) && line.hint ? html`<p class="small dim">${messageText(line.hint)}</p>` : nothing}
    ${notes.map((note) => html`<p class="small dim">${icon("warning", 13)} ${messageText(note.message)}</p>`)}`;
}

/** Render a message of the service, in German if it is translated. */
export function messageText(message: string) {
  const { text, lang } = spoken(message);
  return html`<span lang=${lang}>${text}</span>`;
}

/** Render the buttons of a line. Those of the active line only can be reached by Tab. */
function buttons(line: ShownLine, shown: RowState, on: RowHandlers) {
  const texts = t().draft;
  const tab = shown.active ? 0 : -1;
  const open = isLeft(line) && !line.reading;
  const decided = line.act !== null && line.act !== undefined;
  if (!open && !shown.active && !decided) return nothing;
  return html`${open && line.choices.length > 0
      ? html`<div class="choices" role="group" aria-label=${texts.choices}>
          ${line.choices.map((sentences, at) => {
            const said = sentences.length > 0 ? html`<span lang="en">${sentences.join(" ")}</span>` : texts.chooseAside;
            return html`<button tabindex=${tab} @click=${() => on.choose(line, at + 1)}>
              ${at < 9 ? html`<kbd aria-hidden="true">${at + 1}</kbd>` : nothing} ${said}
            </button>`;
          })}
        </div>`
      : nothing}
    <div class="buttons">
      ${line.state === "proposed"
        ? html`<button class="main confirm" tabindex=${tab} @click=${() => on.confirm(line)}>
            ${icon("check", 16)} ${texts.confirm} <kbd aria-hidden="true">c</kbd>
          </button>`
        : nothing}
      ${(open || shown.active) && shown.editing === null
        ? html`<button tabindex=${tab} class="say" @click=${() => on.edit(line)}>
            ${texts.say} <kbd aria-hidden="true">e</kbd>
          </button>`
        : nothing}
      ${(open || shown.active) && line.state !== "set aside" && !offersAside(line)
        ? html`<button tabindex=${tab} class="set-aside" @click=${() => on.setAside(line)}>
            ${texts.setAside} <kbd aria-hidden="true">x</kbd>
          </button>`
        : nothing}
      ${decided
        ? html`<button tabindex=${tab} class="undo" @click=${() => on.undo(line)}>
            ${icon("undo", 16)} ${texts.undo} <kbd aria-hidden="true">u</kbd>
          </button>`
        : nothing}
    </div>`;
}

/** Return whether one of the choices of a line is to set it aside. */
function offersAside(line: ShownLine): boolean {
  return isLeft(line) && line.choices.some((sentences) => sentences.length === 0);
}

function sayForm(line: ShownLine, text: string, shown: RowState, on: RowHandlers) {
  const texts = t().draft;
  const tab = shown.active ? 0 : -1;
  const send = (event: SubmitEvent) => {
    event.preventDefault();
    const field = (event.target as HTMLFormElement).elements.namedItem("words") as HTMLInputElement;
    const said = field.value.trim();
    field.setCustomValidity(said === "" ? texts.emptyText : "");
    if (field.reportValidity()) on.say(line, said);
  };
  return html`<form novalidate @submit=${send}>
    <input
      name="words"
      maxlength="1000"
      autocomplete="off"
      tabindex=${tab}
      aria-label=${texts.inOtherWords(line.label)}
      .value=${text}
      @input=${(event: Event) => (event.target as HTMLInputElement).setCustomValidity("")}
    />
    <div class="buttons">
      <button class="main" tabindex=${tab}>${texts.apply} <kbd aria-hidden="true">Enter</kbd></button>
      <button type="button" tabindex=${tab} @click=${() => on.cancel(line)}>${texts.cancel} <kbd aria-hidden="true">Esc</kbd></button>
    </div>
  </form>`;
}
