/** All diagnostics at the top of the list. Each selects its task, and has a button if there is a simple fix. */

import type { Diagnostic } from "../api/types";
import { editInTurn } from "../state/commands";
import { select } from "../state/plan";
import { mayPlan } from "../state/session";
import { panel } from "../state/view";
import { t } from "../texts";
import { said } from "../texts/messages";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { icon } from "../ui/icons";
import { fixOf } from "./fixes";
import { keyOfSubject, problems } from "./marks";

const MOST = 50;

@customElement("argo-problems")
export class MissionProblems extends PageElement {
  static override styles = css`
    details {
      border-bottom: 1px solid var(--line);
    }
    summary {
      padding: 5px 10px;
    }
    summary.error {
      background: var(--bad-ground);
      color: var(--bad);
    }
    summary.warning {
      background: var(--warn-ground);
      color: var(--warn);
    }
    ul {
      max-height: 32vh;
      padding: 0 6px 6px;
      overflow: auto;
    }
    li {
      display: grid;
      grid-template-columns: 20px 1fr;
      gap: 4px;
      padding: 5px 2px;
      border-top: 1px solid var(--sunken);
    }
    .error {
      color: var(--bad);
    }
    .warning {
      color: var(--warn);
    }
    .to {
      display: inline;
      min-height: 0;
      padding: 0;
      border: 0;
      background: none;
      text-align: left;
    }
    .to:hover {
      text-decoration: underline;
    }
  `;

  override render() {
    const found = problems.value;
    const real = found.filter((one) => one.severity !== "note").length;
    if (found.length === 0) return nothing;
    const worst = found[0]?.severity ?? "note";
    const texts = t().list;
    return html`<details ?open=${worst === "error"}>
      <summary class=${worst}>
        ${real > 0 ? texts.problems(real) : texts.hints(found.length)}
      </summary>
      <ul>
        ${found.slice(0, MOST).map((one) => this.problem(one))}
        ${found.length > MOST ? html`<li>${texts.more(found.length - MOST)}</li>` : nothing}
      </ul>
    </details>`;
  }

  private problem(one: Diagnostic) {
    const key = keyOfSubject(one.subject);
    const fix = mayPlan() ? fixOf(one) : null;
    const show = () => {
      select(key === null ? [] : [key]);
      panel.value = "properties";
    };
    return html`<li>
      <span class=${one.severity}>${icon("warning", 16)}</span>
      <div>
        <button class="to" @click=${show}>${said(one.message, one.message_wording)}</button>
        ${one.hint ? html`<p class="dim">${said(one.hint, one.hint_wording)}</p>` : nothing}
        ${fix ? html`<button @click=${() => editInTurn((make) => make(...fix.edits()))}>${fix.label}</button>` : nothing}
      </div>
    </li>`;
  }
}
