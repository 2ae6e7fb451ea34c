/** The choice of faults, one by one. */

import { extensionsOf } from "../state/session";
import { t } from "../texts";
import { run } from "../texts/run";
import { iconButton, options } from "../ui/controls";
import { css, customElement, html, PageElement, property } from "../ui/element";
import { parts } from "./parts";

/** Return all kinds of faults: those of the texts, in their order, and those of installed packages. */
export function faultKinds(): readonly string[] {
  return [...Object.keys(run.en.fault), ...extensionsOf("fault")];
}

/** Return the name of a kind of fault; one of a package has no other name than its kind. */
export function faultText(kind: string): string {
  return (t().run.fault as Readonly<Record<string, string>>)[kind] ?? kind;
}

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

  @property({ attribute: false }) chosen: readonly string[] = [];

  override render() {
    const texts = t().run;
    return html`<h2>${texts.faults}</h2>
      <ul>
        ${this.chosen.map((kind, at) => {
          const drop = () => this.tell(this.chosen.filter((_, other) => other !== at));
          return html`<li class="row">
            <span class="grow">${faultText(kind)}</span>
            ${iconButton("close", texts.remove(faultText(kind)), drop, { size: 16 })}
          </li>`;
        })}
      </ul>
      <select aria-label=${texts.addFault} @change=${this.add}>
        <option value="">${texts.addFault}…</option>
        ${options(faultKinds().map((kind) => [kind, faultText(kind)]))}
      </select>`;
  }

  private add(event: Event): void {
    const field = event.target as HTMLSelectElement;
    const kind = field.value;
    field.value = "";
    if (kind !== "") this.tell([...this.chosen, kind]);
  }

  private tell(chosen: readonly string[]): void {
    this.dispatchEvent(new CustomEvent("chosen", { detail: chosen }));
  }
}
