/** A field of a form. It keeps invalid input and shows the reason beside it; edits of other people don't
 * overwrite it. */

import { showNotice } from "../state/notices";
import { t } from "../texts";
import { options, valueOf } from "../ui/controls";
import { css, customElement, html, nothing, PageElement, property, state } from "../ui/element";

export interface Option {
  readonly value: string;
  readonly label: string;
}

/** A question about a text that can be read in several ways. Each answer is a text without doubt. */
export interface Question {
  readonly text: string;
  readonly answers: readonly string[];
}

/** Saves the typed or chosen value. Returns the reason of a refusal, a question, or null if it was saved. */
export type Commit = (value: string) => Promise<string | Question | null> | string | Question | null;

/** A longer choice gets its options when it may be opened. */
const MOST_OPTIONS = 40;
let count = 0;

@customElement("argo-field")
export class FormField extends PageElement {
  static override styles = css`
    :host {
      margin-bottom: 8px;
    }
    label {
      display: block;
      margin-bottom: 2px;
      color: var(--dim);
      font-size: 12px;
    }
    .line {
      display: flex;
      align-items: center;
      gap: 6px;
    }
    input,
    select,
    textarea {
      width: 100%;
      min-width: 0;
    }
    textarea {
      min-height: 52px;
      resize: vertical;
    }
    :host([kind="check"]) .line {
      justify-content: start;
    }
    :host([kind="check"]) input {
      width: auto;
    }
    :host([kind="check"]) label {
      margin: 0;
      color: inherit;
      font-size: inherit;
    }
    .wrong {
      margin-top: 2px;
      color: var(--bad);
      font-size: 12px;
    }
    .answers {
      display: flex;
      flex-wrap: wrap;
      gap: 4px;
      margin-top: 4px;
    }
    .answers button {
      color: var(--text);
    }
    .note {
      flex: none;
      color: var(--dim);
      font-size: 12px;
    }
  `;

  @property() label = "";
  @property({ reflect: true }) kind: "text" | "long" | "select" | "check" = "text";
  /** The saved value; `true` or `false` for a check box. */
  @property() value = "";
  /** A unit or a normal range, shown beside the field. */
  @property() note = "";
  @property() placeholder = "";
  @property({ attribute: false }) options: readonly Option[] = [];
  @property({ attribute: false }) commit: Commit = () => null;
  @property({ type: Boolean }) disabled = false;
  @state() private typed: string | null = null;
  @state() private wrong: string | Question | null = null;
  @state() private overtaken = false;
  /** Whether all options of a long choice are in the page; until it may be opened, the chosen one suffices. */
  @state() private complete = false;
  /** The saving of the typed value that goes on. */
  private saving: Promise<void> | null = null;
  private readonly id_ = `field-${++count}`;

  override willUpdate(changes: Map<string, unknown>): void {
    if (changes.has("value") && this.typed !== null && changes.get("value") !== undefined) {
      this.overtaken = this.typed !== this.value;
      if (!this.overtaken) this.forget();
    }
  }

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    // Leaving a field saves it: this one is gone because what it belonged to is gone.
    if (this.typed !== null && this.wrong === null && this.saving === null)
      showNotice("warn", t().forms.notSaved(this.label), { details: [this.typed] });
  }

  override render() {
    const shown = this.typed ?? this.value;
    const label = html`<label for=${this.id_}>${this.label}</label>`;
    const described = this.wrong || this.overtaken ? `${this.id_}-wrong` : nothing;
    let field;
    if (this.kind === "check")
      field = html`<input
        id=${this.id_}
        type="checkbox"
        .checked=${shown === "true"}
        ?disabled=${this.disabled}
        @change=${(event: Event) => this.take(String((event.target as HTMLInputElement).checked))}
      />`;
    else if (this.kind === "select")
      field = html`<select
        id=${this.id_}
        aria-describedby=${described}
        ?disabled=${this.disabled}
        @change=${this.onChange}
        @pointerenter=${this.fill}
        @pointerdown=${this.fill}
        @focus=${this.fill}
      >
        ${options(this.shownOptions(shown), shown)}
      </select>`;
    else if (this.kind === "long")
      field = html`<textarea
        id=${this.id_}
        aria-describedby=${described}
        .value=${shown}
        ?disabled=${this.disabled}
        @input=${this.onInput}
        @change=${this.onChange}
        @keydown=${this.onKey}
      ></textarea>`;
    else
      field = html`<input
        id=${this.id_}
        autocomplete="off"
        aria-describedby=${described}
        aria-invalid=${this.wrong !== null}
        placeholder=${this.placeholder}
        .value=${shown}
        ?disabled=${this.disabled}
        @input=${this.onInput}
        @change=${this.onChange}
        @keydown=${this.onKey}
      />`;
    return html`${this.kind === "check" ? nothing : label}
      <div class="line">
        ${field}${this.kind === "check" ? label : nothing}
        ${this.note ? html`<span class="note">${this.note}</span>` : nothing}
      </div>
      ${this.wrong !== null || this.overtaken
        ? html`<div class="wrong" role="alert" id=${`${this.id_}-wrong`}>${this.complaint()}</div>`
        : nothing}`;
  }

  private readonly fill = (): void => {
    this.complete = true;
  };

  private shownOptions(shown: string) {
    const long = this.options.length > MOST_OPTIONS && !this.complete;
    const all = long ? this.options.filter(({ value }) => value === shown) : this.options;
    return all.map(({ value, label }) => [value, label] as const);
  }

  private complaint() {
    if (this.wrong === null)
      return html`${t().forms.overtaken(this.value)} <button @click=${this.forget}>${t().forms.takeTheirs}</button>`;
    if (!isQuestion(this.wrong)) return this.wrong;
    const { text, answers } = this.wrong;
    return html`${text}
      <div class="answers">
        ${answers.map((answer) => html`<button @click=${() => this.answer(answer)}>${answer}</button>`)}
      </div>`;
  }

  private answer(text: string): void {
    void this.take(text);
    this.focus();
  }

  override focus(): void {
    this.renderRoot.querySelector<HTMLElement>("input, select, textarea")?.focus();
  }

  /** Save what is typed. Returns whether nothing is left unsaved; otherwise the field gets the focus. */
  async settle(): Promise<boolean> {
    if (this.typed !== null && !isQuestion(this.wrong)) await this.take(this.typed);
    if (this.typed === null) return true;
    this.focus();
    return false;
  }

  private onInput(event: Event): void {
    this.typed = valueOf(event);
    if (isQuestion(this.wrong)) this.wrong = null;
  }

  private onChange(event: Event): void {
    void this.take(valueOf(event));
  }

  private onKey(event: KeyboardEvent): void {
    if (event.key === "Enter" && this.kind !== "long") void this.take(valueOf(event));
    else if (event.key === "Escape" && this.typed !== null && this.saving === null) this.forget();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  private readonly forget = (): void => {
    this.typed = null;
    this.wrong = null;
    this.overtaken = false;
  };

  /** Save a text. A text that is being saved is not saved twice: Enter saves it, and then the loss of focus. */
  private take(typed: string): Promise<void> {
    if (typed === this.value) this.forget();
    else if (this.saving === null || typed !== this.typed) {
      const saving = this.save(typed).finally(() => {
        if (this.saving === saving) this.saving = null;
      });
      this.saving = saving;
    }
    return this.saving ?? Promise.resolve();
  }

  private async save(typed: string): Promise<void> {
    this.typed = typed;
    this.overtaken = false;
    const wrong = await this.commit(typed);
    if (wrong !== null && !this.isConnected)
      showNotice("bad", `${this.label}: ${isQuestion(wrong) ? wrong.text : wrong}`, { details: [typed] });
    if (this.typed !== typed) return;
    if (wrong === null) this.forget();
    else this.wrong = wrong;
  }
}

function isQuestion(wrong: string | Question | null): wrong is Question {
  return wrong !== null && typeof wrong !== "string";
}
