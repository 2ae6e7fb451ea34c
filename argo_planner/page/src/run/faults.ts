/** The choice of faults, one by one. */

import type { FaultKind } from "../api/types";
import { t } from "../texts";
import { run } from "../texts/run";
import { iconButton, options } from "../ui/controls";
import { css, customElement, html, PageElement, property } from "../ui/element";
import { parts } from "./parts";

/** All kinds of faults, in the order of the texts. */
export const FAULTS = Object.keys(run.en.fault) as readonly FaultKind[];

/** Fires `chosen` with all chosen faults when they change. */
@customElement("argo-faults")
export class FaultChoice extends PageElement {
  static override styles = [
    parts,
    css`
      select {
        width: 100%;
      }
    `,
  ];

  @property({ attribute: false }) chosen: readonly FaultKind[] = [];

  override render() {
    const texts = t().run;
    return html`<h2>${texts.faults}</h2>
      <ul>
        ${this.chosen.map((kind, at) => {
          const drop = () => this.tell(this.chosen.filter((_, other) => other !== at));
          return html`<li class="row">
            <span class="grow">${texts.fault[kind]}</span>
            ${iconButton("close", texts.remove(texts.fault[kind]), drop, { size: 16 })}
          </li>`;
        })}
      </ul>
      <select aria-label=${texts.addFault} @change=${this.add}>
        <option value="">${texts.addFault}…</option>
        ${options(FAULTS.map((kind) => [kind, texts.fault[kind]]))}
      </select>`;
  }

  private add(event: Event): void {
    const field = event.target as HTMLSelectElement;
    const kind = FAULTS.find((one) => one === field.value);
    field.value = "";
    if (kind !== undefined) this.tell([...this.chosen, kind]);
  }

  private tell(chosen: readonly FaultKind[]): void {
    this.dispatchEvent(new CustomEvent("chosen", { detail: chosen }));
  }
}
