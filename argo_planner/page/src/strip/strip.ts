/** Times, distances, climbs and battery of the way, leg by leg and altogether, against the limits. */

import { legsOf, type Leg } from "../model/legs";
import { broken, mission } from "../state/plan";
import { hoveredLeg, preview, previewRefused } from "../state/preview";
import { t } from "../texts";
import { css, customElement, html, nothing, PageElement, state } from "../ui/element";
import { barStyles, barView, legWords } from "./bar";
import { legTable, tableStyles } from "./table";
import "./totals";

@customElement("argo-strip")
export class StripPanel extends PageElement {
  static override styles = [
    barStyles,
    tableStyles,
    css`
      :host {
        max-height: 42vh;
        overflow: auto;
        padding: 8px 12px;
        font-variant-numeric: tabular-nums;
      }
      .said {
        min-height: 20px;
        font-size: 12px;
      }
      summary {
        font-size: 12px;
        color: var(--dim);
        cursor: pointer;
      }
      @media (max-width: 800px) {
        :host {
          padding: 4px 8px;
        }
        details,
        .said {
          display: none;
        }
      }
    `,
  ];

  @state() private open = false;

  override render() {
    const texts = t().strip;
    const found = preview.value;
    const there = mission.value;
    if (there === null) return nothing;
    if (found === null || found.ways.length === 0) {
      const reckoned = previewRefused.value ?? (broken.value ? texts.broken : texts.outdated);
      return html`<p class="dim said">${there.tasks.length === 0 ? texts.empty : reckoned}</p>`;
    }
    const legs = legsOf(found, there);
    const limit = there.max_duration ?? null;
    return html`<section aria-label=${texts.title}>
      <argo-totals .found=${found}></argo-totals>
      ${barView(legs, limit)}
      <p class="said" aria-live="off">${pointedAt(legs)}</p>
      <details @toggle=${(event: Event) => (this.open = (event.target as HTMLDetailsElement).open)}>
        <summary>${texts.table}</summary>
        ${this.open ? legTable(legs, limit) : nothing}
      </details>
    </section>`;
  }
}

/** The leg at which somebody points. */
function pointedAt(legs: readonly Leg[]) {
  const leg = legs.find((one) => one.way === hoveredLeg.value);
  return leg === undefined ? nothing : (leg.problem ?? legWords(leg));
}
