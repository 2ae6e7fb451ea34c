/** A slider that goes back in time, with a mark for each event. */

import { computed } from "@preact/signals-core";
import { svg } from "lit";

import { runEvents } from "../model/run-events";
import { pastRun, shownEntries, shownRunState, shownTime } from "../state/run";
import { t } from "../texts";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { parts } from "./parts";

const STEP = 0.5; // s, the interval at which a run stores the robot's pose
const MOST_MARKS = 300;

const all = computed(() => runEvents(shownEntries.value));

@customElement("argo-run-time")
export class RunTime extends PageElement {
  static override styles = [
    parts,
    css`
      .line {
        display: grid;
        grid-template-columns: minmax(0, 1fr) auto;
        align-items: end;
        gap: 8px;
      }
      .slider {
        display: grid;
      }
      svg {
        width: calc(100% - 16px);
        height: 8px;
        margin: 0 8px;
      }
      input {
        width: 100%;
        margin: 0;
      }
      rect {
        fill: var(--dim);
      }
      .good {
        fill: var(--good);
      }
      .warn {
        fill: var(--warn);
      }
      .bad {
        fill: var(--bad);
      }
    `,
  ];

  override render() {
    const entries = shownEntries.value;
    const end = Math.max(shownRunState.value?.t ?? 0, entries.at(-1)?.t ?? 0);
    if (end <= 0) return nothing;
    const texts = t().run;
    const now = shownTime.value;
    const marks = all.value.slice(-MOST_MARKS);
    return html`<div class="line">
      <label class="slider">
        <span>${texts.backInTime}: ${t().words.seconds(now ?? end)}</span>
        <svg viewBox="0 0 1000 8" preserveAspectRatio="none" aria-hidden="true">
          ${marks.map(
            (one) => svg`<rect class=${one.tone} x=${(1000 * one.t) / end} y="0" width="4" height="8" />`,
          )}
        </svg>
        <input
          id="back"
          type="range"
          min="0"
          max=${end}
          step=${STEP}
          .value=${String(now ?? end)}
          aria-valuetext=${t().words.seconds(now ?? end)}
          @input=${this.go}
        />
      </label>
      <button
        id="live"
        aria-pressed=${now === null}
        title=${texts.toLive}
        @click=${() => (shownTime.value = null)}
      >
        ${pastRun.value === null && shownRunState.value?.status !== "ended" ? texts.live : texts.end}
      </button>
    </div>`;
  }

  private go(event: Event): void {
    const field = event.target as HTMLInputElement;
    const last = Number(field.max) - field.valueAsNumber < STEP;
    shownTime.value = last ? null : field.valueAsNumber;
  }
}
