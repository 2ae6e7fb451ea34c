/** The panel of the script. */

import { missionHasErrors } from "../state/plan";
import { mayPlan } from "../state/session";
import { t } from "../texts";
import { said } from "../texts/messages";
import { css, customElement, html, nothing, PageElement, query, state } from "../ui/element";
import { icon } from "../ui/icons";
import {
  applyDraft,
  applying,
  discardedDraft,
  baseScript,
  decideLineByLine,
  draftIsChanged,
  draftIsOutdated,
  refusedDraft,
  restoreDraft,
  discardDraft,
  noScriptReason,
} from "./draft";
import { importedText } from "./imported";
import { confirmNotes, openNotes } from "./notes";
import "./sheet";
import type { ScriptSheet } from "./sheet";

@customElement("argo-script")
export class ScriptPanel extends PageElement {
  static override styles = css`
    :host {
      display: flex;
      flex-direction: column;
      gap: 8px;
      height: 100%;
      padding: 10px;
    }
    .told {
      flex: none;
      max-height: max(34%, 110px);
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
      margin-top: 4px;
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
    .texts button[aria-pressed="true"] {
      border-color: var(--accent);
      background: var(--chosen);
    }
  `;

  /** Whether the imported text is shown, and not the script of the mission. */
  @state() private imported = false;
  @query("argo-script-sheet") private readonly sheet!: ScriptSheet | null;

  override render() {
    const texts = t().script;
    if (baseScript.value === null) {
      const said = noScriptReason.value ?? (missionHasErrors.value ? texts.hasErrors : texts.loading);
      return html`<p class="dim">${said}</p>`;
    }
    if (this.imported && importedText.value !== "")
      return html`${this.notes()} ${this.texts()}<argo-imported-script></argo-imported-script>`;
    return html`${this.notes()} ${this.texts()} ${draftIsOutdated.value ? this.meanwhile() : nothing}
      <argo-script-sheet></argo-script-sheet>
      ${this.problems()} ${noScriptReason.value === null ? nothing : html`<p class="told warn">${noScriptReason.value}</p>`}
      <div class="row">
        <button
          class="main"
          id="apply"
          title="Ctrl+Enter"
          ?disabled=${!mayPlan() || !draftIsChanged.value || applying.value || draftIsOutdated.value}
          @click=${() => applyDraft()}
        >
          ${icon("check")} ${applying.value ? texts.applying : texts.apply}
        </button>
        ${draftIsChanged.value ? html`<button @click=${discardDraft}>${texts.revert}</button>` : nothing}
        ${discardedDraft.value === null || draftIsChanged.value
          ? nothing
          : html`<button @click=${restoreDraft}>${icon("undo", 16)} ${texts.back}</button>`}
        <span class="dim state grow" role="status">
          ${!mayPlan() ? texts.mayNotPlan : draftIsChanged.value ? texts.changed : texts.unchanged}
        </span>
      </div>`;
  }

  /** Render the choice between the script of the mission and the text that it was imported from. */
  private texts() {
    const texts = t().script;
    if (importedText.value === "") return nothing;
    const choice = (imported: boolean, label: string) =>
      html`<button aria-pressed=${this.imported === imported} @click=${() => (this.imported = imported)}>${label}</button>`;
    return html`<div class="row texts" role="group" aria-label=${texts.which}>
      ${choice(false, texts.asScript)} ${choice(true, texts.asImported)}
    </div>`;
  }

  private meanwhile() {
    const texts = t().script;
    return html`<section class="told warn" role="alert">
      <p>${icon("warning", 14)} ${texts.overtaken}</p>
      <div class="row">
        <button @click=${discardDraft}>${texts.theirs}</button>
        <button ?disabled=${!mayPlan() || applying.value} @click=${() => applyDraft(true)}>${texts.anyway}</button>
      </div>
    </section>`;
  }

  private problems() {
    const rejected = refusedDraft.value;
    if (rejected === null || !draftIsChanged.value) return nothing;
    const texts = t().script;
    return html`<section class="told bad" aria-label=${texts.problems} role="alert">
      <p>${rejected.incomplete ? t().draft.incomplete : texts.refused}</p>
      <ul>
        ${rejected.found.map(
          (one) =>
            html`<li>
              ${one.span
                ? html`<button @click=${() => this.sheet?.goTo(one)}>${texts.line(one.span.line)}</button>`
                : nothing}
              <span class=${one.severity === "error" ? "error-said" : ""}>${said(one.message, one.message_wording)}</span>
              ${one.hint ? html`<br /><span class="dim">${texts.hint(said(one.hint, one.hint_wording))}</span>` : nothing}
            </li>`,
        )}
      </ul>
      ${rejected.incomplete
        ? html`<button title=${t().draft.lineByLineHint} @click=${decideLineByLine}>${t().draft.lineByLine}</button>`
        : nothing}
    </section>`;
  }

  private notes() {
    const open = openNotes.value;
    if (open.length === 0) return nothing;
    const texts = t().script;
    return html`<section class="told warn" aria-label=${texts.notes}>
      <div class="row">
        <h3 class="grow">${texts.notes}</h3>
        ${open.length > 1
          ? html`<button id="confirm-all" @click=${() => confirmNotes(open)}>${icon("check", 14)} ${texts.confirmAll}</button>`
          : nothing}
      </div>
      <ul>
        ${open.map(
          (note) =>
            html`<li class="row">
              <span class="grow">
                ${note.said.span ? html`<span class="dim">${texts.line(note.said.span.line)}:</span>` : nothing}
                ${said(note.said.message, note.said.message_wording)}
                ${note.said.excerpt ? html`<br /><span class="dim">${note.said.excerpt}</span>` : nothing}
              </span>
              <button @click=${() => confirmNotes([note])}>${icon("check", 14)} ${texts.confirm}</button>
            </li>`,
        )}
      </ul>
    </section>`;
  }
}
