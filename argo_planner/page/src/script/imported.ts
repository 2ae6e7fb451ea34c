/** The text that the mission was imported from. The words of a task are lit while it is selected or pointed to, and
 * the other way round. */

import { effect, signal } from "@preact/signals-core";

import { client, Refusal, responseData, Unreached } from "../api/client";
import { groupKey, nameOfKey, taskKey } from "../model/outline";
import { type LineWords, linesWithWords } from "../model/script-words";
import { lastRevision, planId, select, selection, tasksByName } from "../state/plan";
import { missionSentences } from "../state/sentences";
import { pointedName } from "../state/view";
import { t } from "../texts";
import { css, customElement, html, nothing, PageElement } from "../ui/element";

/** The imported text; empty: there is none, or the mission has become another one since. */
export const importedText = signal("");

let plan: string | null = null;

effect(() => {
  const id = planId.value;
  const last = lastRevision.value?.kind;
  if (id === plan && (last === undefined || last === "edit")) return;
  if (id !== plan) importedText.value = "";
  plan = id;
  if (id !== null) void readImported(id);
});

async function readImported(id: string): Promise<void> {
  try {
    const found = await responseData(
      client.GET("/api/missions/{id}/imported-script", { params: { path: { id } } }),
    );
    if (planId.value === id) importedText.value = found.text;
  } catch (error) {
    if (!(error instanceof Refusal || error instanceof Unreached)) throw error;
  }
}

@customElement("argo-imported-script")
export class ImportedScript extends PageElement {
  static override styles = css`
    :host {
      flex: 1;
      min-height: 160px;
      overflow: auto;
      border: 1px solid var(--line);
      border-radius: var(--round);
      background: var(--surface);
    }
    .text {
      padding: 6px 8px 6px 0;
      font: 13px/1.6 ui-monospace, "DejaVu Sans Mono", monospace;
      overflow-wrap: anywhere;
      outline-offset: -2px;
    }
    .line {
      display: grid;
      grid-template-columns: 34px minmax(0, 1fr);
      gap: 8px;
    }
    .line > span:last-child {
      white-space: pre-wrap;
    }
    .line > span:first-child {
      color: var(--dim);
      font-size: 11px;
      text-align: right;
      user-select: none;
    }
    [role="option"] {
      border-radius: 3px;
      border-bottom: 1px dotted var(--accent);
      cursor: pointer;
    }
    .chosen {
      background: var(--chosen);
    }
    .lit {
      outline: 2px solid var(--accent);
      background: var(--chosen);
    }
  `;

  private lines: readonly (readonly LineWords[])[] = [];

  constructor() {
    super();
    this.watch(() => {
      const key = selection.value.at(-1);
      if (key !== undefined) void this.updateComplete.then(() => this.reveal(nameOfKey(key)));
    });
  }

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    pointedName.value = null;
  }

  override render() {
    const entries = missionSentences.value?.reading.entries ?? [];
    this.lines = linesWithWords(importedText.value.trimEnd(), entries);
    const chosen = new Set(selection.value.map(nameOfKey));
    const active = nameOfKey(selection.value.at(-1) ?? "");
    const hasActive = this.names().includes(active);
    return html`<div
      class="text"
      role="listbox"
      tabindex="0"
      aria-label=${t().script.importedWords}
      aria-activedescendant=${hasActive ? idOf(active) : nothing}
      @keydown=${this.onKey}
      @click=${this.onClick}
      @mouseover=${this.onPoint}
      @mouseleave=${() => (pointedName.value = null)}
    >
      ${this.lines.map(
        (parts, at) =>
          html`<div class="line" role="presentation"><span aria-hidden="true">${at + 1}</span><span role="presentation"
            >${parts.map(({ text, name }) =>
              name === null
                ? text
                : html`<span
                    role="option"
                    id=${idOf(name)}
                    data-name=${name}
                    class="${chosen.has(name) ? "chosen" : ""} ${pointedName.value === name ? "lit" : ""}"
                    aria-selected=${chosen.has(name)}
                    title=${name}
                    >${text}</span
                  >`,
            )}</span></div>`,
      )}
    </div>`;
  }

  private names(): readonly string[] {
    return this.lines.flat().flatMap(({ name }) => (name === null ? [] : [name]));
  }

  private onPoint(event: MouseEvent): void {
    pointedName.value = nameAt(event);
  }

  private onClick(event: MouseEvent): void {
    const name = nameAt(event);
    if (name !== null) choose(name);
  }

  private onKey(event: KeyboardEvent): void {
    const names = this.names();
    const last = names.length - 1;
    const at = names.indexOf(nameOfKey(selection.value.at(-1) ?? ""));
    const to = { ArrowDown: Math.min(last, at + 1), ArrowUp: Math.max(0, at - 1), Home: 0, End: last }[event.key];
    const name = to === undefined ? undefined : names[to];
    if (name === undefined) return;
    choose(name);
    event.preventDefault();
  }

  private reveal(name: string): void {
    this.renderRoot.querySelector(`#${idOf(name)}`)?.scrollIntoView({ block: "nearest" });
  }
}

function nameAt(event: Event): string | null {
  return (event.target as HTMLElement).closest<HTMLElement>("[role=option]")?.dataset["name"] ?? null;
}

function choose(name: string): void {
  select([tasksByName.value.has(name) ? taskKey(name) : groupKey(name)]);
}

/** Return the id of a task's words, for names of any characters. */
function idOf(name: string): string {
  return `words-${Array.from(name, (one) => (/[\w-]/.test(one) ? one : `_${one.codePointAt(0) ?? 0}_`)).join("")}`;
}
