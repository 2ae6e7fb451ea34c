/** The readings: each on the scale of its instrument, with the camera picture that it was read from. */

import { computed } from "@preact/signals-core";
import { svg } from "lit";

import type { Reading } from "../model/replay";
import { drawnScale, shareOfScale } from "../model/scale";
import { pastRun, shownRun, shownRunState } from "../state/run";
import { look as lookAt } from "../state/view";
import { world } from "../state/world";
import { t } from "../texts";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { icon } from "../ui/icons";
import { figure, percent, unitText } from "../ui/figures";
import { parts } from "./parts";

const WIDTH = 100;
const HEIGHT = 10;

const readingsNow = computed(() => shownRun.value?.readings ?? null);

@customElement("argo-run-readings")
export class RunReadings extends PageElement {
  static override styles = [
    parts,
    css`
      li {
        display: grid;
        grid-template-columns: minmax(0, 1fr) auto;
        gap: 1px 8px;
        padding: 6px 0;
        border-top: 1px solid var(--line);
      }
      .name {
        justify-content: start;
        min-height: 0;
        padding: 0;
        text-align: left;
      }
      .value {
        font-weight: 600;
        font-variant-numeric: tabular-nums;
      }
      .off {
        color: var(--bad);
      }
      svg.scale {
        grid-column: 1 / 3;
        display: block;
        width: 100%;
        height: 14px;
      }
      .range {
        fill: var(--sunken);
      }
      .band {
        fill: var(--good);
        opacity: 0.45;
      }
      .mark {
        fill: var(--text);
      }
      .mark.off {
        fill: var(--bad);
      }
      .ends {
        grid-column: 1 / 3;
        display: flex;
        justify-content: space-between;
        font-size: 11px;
        color: var(--dim);
        font-variant-numeric: tabular-nums;
      }
      .picture {
        grid-column: 1 / 3;
      }
      .picture summary {
        font-size: 12px;
        color: var(--dim);
      }
      img {
        display: block;
        width: 100%;
        max-width: 320px;
        border-radius: var(--round);
        image-rendering: auto;
      }
    `,
  ];

  override render() {
    const readings = readingsNow.value;
    if (readings === null) return nothing;
    const texts = t().run;
    const latest = [...readings].sort((a, b) => b.t - a.t);
    return html`<section aria-label=${texts.readings}>
      <h2>${texts.readings}</h2>
      ${latest.length === 0
        ? html`<p class="reason">${texts.noReadings}</p>`
        : html`<ul>
            ${latest.map((reading) => this.reading(reading))}
          </ul>`}
    </section>`;
  }

  private reading(reading: Reading) {
    const texts = t().run;
    const { checkpoint, name, value, normal, nominal } = reading;
    const unit = unitText(reading.unit);
    const known = world.value?.checkpoints.find((one) => one.id === checkpoint);
    const scale = drawnScale(known?.range ?? null, nominal, value);
    const [from, to] = [shareOfScale(scale, nominal.low), shareOfScale(scale, nominal.high)];
    const at = shareOfScale(scale, value);
    const sure = reading.confidence < 1 ? texts.confidence(percent(reading.confidence)) : "";
    const wording = texts.nominal(figure(nominal.low), figure(nominal.high), unit);
    return html`<li data-checkpoint=${checkpoint}>
      <button
        class="bare name"
        @click=${() => (lookAt.value = { kind: "checkpoint", id: String(checkpoint) })}
      >
        #${checkpoint} ${name}
      </button>
      <span class="value ${normal ? "" : "off"}">
        ${normal ? nothing : icon("warning", 14)} ${figure(value)} ${unit}
      </span>
      <svg
        class="scale"
        viewBox="0 0 ${WIDTH} ${HEIGHT}"
        preserveAspectRatio="none"
        role="img"
        aria-label=${`${figure(value)} ${unit}, ${normal ? texts.normal : texts.abnormal}: ${wording}`}
      >
        ${svg`<rect class="range" x="0" y="3" width=${WIDTH} height="4" rx="1" />
          <rect class="band" x=${WIDTH * from} y="3" width=${WIDTH * Math.max(0.005, to - from)} height="4" />
          <rect class="mark ${normal ? "" : "off"}" x=${WIDTH * at * 0.99} y="0" width="1" height=${HEIGHT} />`}
      </svg>
      <span class="ends">
        <span>${figure(scale.low)}</span>
        <span>${[normal ? texts.normal : texts.abnormal, sure, t().words.seconds(reading.t)].filter(Boolean).join(" · ")}</span>
        <span>${figure(scale.high)}</span>
      </span>
      ${this.picture(reading)}
    </li>`;
  }

  /** Render the picture of a reading. Only the camera takes pictures, and repeated runs have none. */
  private picture(reading: Reading) {
    const run = shownRunState.value;
    if (run?.sensor !== "camera" || pastRun.value?.evaluated) return nothing;
    const wording = t().run.picture(reading.name);
    const at = `/api/runs/${run.id}/pictures/${reading.checkpoint}/${Math.round(1000 * reading.t)}`;
    return html`<details class="picture">
      <summary>${icon("camera", 14)} ${wording}</summary>
      <img src=${at} alt=${wording} loading="lazy" width="320" height="320" />
    </details>`;
  }
}
