/** Lines beside the list from each task to where its branches lead. The row's detail states them in words. */

import { computed } from "@preact/signals-core";
import { svg } from "lit";

import { branchesOf, type Branch } from "../model/branches";
import { mission } from "../state/plan";
import { css, html, nothing } from "../ui/element";
import { styled } from "../ui/styled";
import { ROW_HEIGHT } from "./row";
import { shownRows } from "./rows";

/** px between two lines, and from the rows to the first one */
const LANE = 7;
const TIP = 4;

export const branchStyles = css`
  .branches {
    position: absolute;
    top: 0;
    right: 0;
    z-index: 1;
    pointer-events: none;
  }
  .branches path {
    fill: none;
    stroke: var(--dim);
    stroke-width: 1.5;
  }
  .branches .condition {
    stroke-dasharray: 4 3;
  }
  .branches .failure {
    stroke: var(--bad);
    stroke-dasharray: 1 3;
    stroke-linecap: round;
  }
  .branches .chosen path {
    stroke: var(--accent);
    stroke-width: 2.5;
  }
  .branches .tip {
    stroke-dasharray: none;
  }
`;

export const branches = computed<readonly Branch[]>(() =>
  mission.value === null ? [] : branchesOf(mission.value, shownRows.value),
);

/** px that the lines take at the right of the rows */
export const branchWidth = computed(() => {
  const lanes = Math.max(0, ...branches.value.map(({ lane }) => lane + 1));
  return lanes === 0 ? 0 : (lanes + 1) * LANE;
});

/** Render the lines that cross the rows from `first` to `last`; those of the row `chosen` are highlighted. */
export function branchLines(all: readonly Branch[], first: number, last: number, chosen: number) {
  const width = branchWidth.value;
  if (width === 0) return nothing;
  const shown = all.filter(({ from, to }) => Math.min(from, to) <= last && Math.max(from, to) >= first);
  const size = { width: `${width}px`, height: `${ROW_HEIGHT * (last + 1)}px` };
  return html`<svg class="branches" aria-hidden="true" ${styled(size)}>${shown.map((one) => line(one, chosen))}</svg>`;
}

/** Render a line that leaves the lower part of a row and enters the upper part of another. */
function line({ from, to, kind, lane }: Branch, chosen: number) {
  const y = { from: ROW_HEIGHT * (from + 0.65), to: ROW_HEIGHT * (to + 0.35) };
  const side = (lane + 1) * LANE + 2;
  const bend = Math.sign(y.to - y.from) * LANE * 0.6;
  const path =
    `M2 ${y.from}H${side - LANE * 0.6}Q${side} ${y.from} ${side} ${y.from + bend}` +
    `V${y.to - bend}Q${side} ${y.to} ${side - LANE * 0.6} ${y.to}H3`;
  const tip = `M${2 + TIP} ${y.to - TIP}L2 ${y.to}L${2 + TIP} ${y.to + TIP}`;
  return svg`<g class=${from === chosen ? "chosen" : ""} data-from=${from} data-to=${to}>
    <path class=${kind} d=${path}></path><path class=${`${kind} tip`} d=${tip}></path></g>`;
}
