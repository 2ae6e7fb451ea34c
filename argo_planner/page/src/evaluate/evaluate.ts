/** The evaluation of the mission: in how many worlds it is a success, how sure that is, and what breaks it. */

import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { evaluation } from "./evaluation";
import "./result";
import "./start";

@customElement("argo-evaluate")
export class EvaluatePanel extends PageElement {
  static override styles = css`
    :host {
      padding: 12px;
    }
    .all {
      display: grid;
      grid-template-columns: minmax(0, 1fr);
      gap: 14px;
    }
  `;

  override render() {
    // What came of one comes first: below the form nobody would see it.
    return html`<div class="all">
      ${evaluation.value === null ? nothing : html`<argo-evaluate-result></argo-evaluate-result>`}
      <argo-evaluate-start></argo-evaluate-start>
    </div>`;
  }
}
