/** The legs of the way as bars, as wide as they take long. */

import { gathered, isTooLate, type Leg } from "../model/legs";
import { isTaskKey, nameOfKey, taskKey } from "../model/outline";
import { select, selection } from "../state/plan";
import { hoveredLeg } from "../state/preview";
import { world } from "../state/world";
import { t } from "../texts";
import { css, html, nothing } from "../ui/element";
import { metres, seconds, share } from "../ui/figures";
import { styled } from "../ui/styled";

const MOST_BARS = 250;

export const barStyles = css`
  .bar {
    position: relative;
    display: flex;
    gap: 1px;
    height: 28px;
    margin: 6px 0 2px;
    border-radius: 6px;
    background: var(--sunken);
  }
  .bar button {
    display: block;
    flex: none;
    min-width: 3px;
    min-height: 0;
    height: 28px;
    padding: 0 4px;
    overflow: hidden;
    border: 0;
    border-radius: 3px;
    background: color-mix(in srgb, var(--accent) 24%, var(--surface));
    font-size: 12px;
    line-height: 28px;
    text-overflow: ellipsis;
    white-space: nowrap;
  }
  .bar button.thin {
    padding: 0;
  }
  .bar button.late {
    background: var(--bad-ground);
    color: var(--bad);
  }
  .bar button.broken {
    background: repeating-linear-gradient(45deg, var(--bad-ground) 0 4px, var(--surface) 4px 8px);
  }
  .bar button.hovered {
    background: color-mix(in srgb, var(--accent) 50%, var(--surface));
  }
  .bar button[aria-pressed="true"] {
    background: var(--accent);
    color: var(--on-accent);
  }
  .limit {
    position: absolute;
    top: -3px;
    bottom: -3px;
    width: 2px;
    background: var(--bad);
    pointer-events: none;
  }
`;

/** The legs as bars. */
export function barView(legs: readonly Leg[], limit: number | null) {
  const last = legs.at(-1);
  const end = last === undefined ? 0 : last.start + last.time;
  const whole = Math.max(end, limit !== null && limit < 3 * end ? limit : 0, 1e-9);
  const chosen = new Set(selection.value.filter(isTaskKey).map(nameOfKey));
  return html`<div class="bar" @pointerleave=${() => (hoveredLeg.value = null)}>
    ${gathered(legs, MOST_BARS).map((leg) => {
      const part = (100 * leg.time) / whole;
      const marks = [
        leg.problem !== null ? "broken" : isTooLate(leg, limit) ? "late" : "",
        hoveredLeg.value === leg.way ? "hovered" : "",
        part < 4 ? "thin" : "",
      ];
      return html`<button
        class=${marks.join(" ")}
        data-task=${leg.task}
        aria-label=${legWords(leg)}
        aria-pressed=${chosen.has(leg.task)}
        ${styled({ width: `calc(${part}% - 1px)` })}
        @pointerenter=${() => (hoveredLeg.value = leg.way)}
        @focus=${() => (hoveredLeg.value = leg.way)}
        @blur=${() => (hoveredLeg.value = null)}
        @click=${() => select([taskKey(leg.task)])}
      >
        ${part < 4 ? nothing : leg.task}
      </button>`;
    })}
    ${limit !== null && limit <= whole
      ? html`<span class="limit" ${styled({ left: `${(100 * limit) / whole}%` })}></span>`
      : nothing}
  </div>`;
}

/** A leg in words. */
export function legWords({ task, time, distance, climb, energy }: Leg): string {
  const used = share(energy, world.value?.robot.battery ?? 0);
  return t().strip.leg(task, seconds(time), metres(distance), metres(climb), used);
}
