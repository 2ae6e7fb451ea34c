/** The legs of the way as a table. */

import { isTooLate, type Leg } from "../model/legs";
import { taskKey } from "../model/outline";
import { select } from "../state/plan";
import { hoveredLeg } from "../state/preview";
import { world } from "../state/world";
import { t } from "../texts";
import { css, html, nothing } from "../ui/element";
import { metres, seconds, share } from "../ui/figures";

const MOST_ROWS = 1_000;

export const tableStyles = css`
  table {
    width: 100%;
    border-collapse: collapse;
    font-size: 12px;
  }
  th {
    position: sticky;
    top: 0;
    background: var(--surface);
    color: var(--dim);
    font-weight: normal;
  }
  th,
  td {
    padding: 1px 6px;
    text-align: right;
  }
  th:first-child,
  td:first-child {
    text-align: left;
  }
  tr.hovered td {
    background: var(--chosen);
  }
  tbody tr {
    cursor: pointer;
  }
  .bad {
    color: var(--bad);
  }
`;

/** The legs as rows. */
export function legTable(legs: readonly Leg[], limit: number | null) {
  const texts = t().strip;
  return html`<table>
      <thead>
        <tr>
          <th scope="col">${texts.task}</th>
          <th scope="col">${texts.time}</th>
          <th scope="col">${texts.distance}</th>
          <th scope="col">${texts.climb}</th>
          <th scope="col">${texts.battery}</th>
        </tr>
      </thead>
      <tbody>
        ${legs.slice(0, MOST_ROWS).map(
          (leg) =>
            html`<tr
              class=${hoveredLeg.value === leg.way ? "hovered" : ""}
              title=${leg.problem ?? nothing}
              @pointerenter=${() => (hoveredLeg.value = leg.way)}
              @pointerleave=${() => (hoveredLeg.value = null)}
              @click=${() => select([taskKey(leg.task)])}
            >
              <td>${leg.task}</td>
              <td class=${isTooLate(leg, limit) ? "bad" : ""}>${seconds(leg.time)}</td>
              <td>${metres(leg.distance)}</td>
              <td>${metres(leg.climb)}</td>
              <td>${share(leg.energy, world.value?.robot.battery ?? 0)}</td>
            </tr>`,
        )}
      </tbody>
    </table>`;
}
