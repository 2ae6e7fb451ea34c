/** The panel of the evaluation: success rate in many worlds, its interval, and the failed runs. */

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
    // The result comes first: below the form nobody would see it.
    return html`<div class="all">
      ${evaluation.value === null ? nothing : html`<argo-evaluate-result></argo-evaluate-result>`}
      <argo-evaluate-start></argo-evaluate-start>
    </div>`;
  }
}
