/** How a run ended: a word in the colour of its tone. */

import type { RunSummary } from "../api/types";
import { t } from "../texts";
import { css, html } from "../ui/element";
import { icon, type Icon } from "../ui/icons";

const SIGNS: Readonly<Record<NonNullable<RunSummary["tone"]>, Icon>> = {
  good: "check",
  notice: "warning",
  bad: "close",
};

export const endingStyles = css`
  .ending {
    display: inline-flex;
    align-items: baseline;
    gap: 4px;
    white-space: nowrap;
  }
  .ending svg {
    align-self: center;
  }
  .ending.good {
    color: var(--good);
  }
  .ending.notice {
    color: var(--warn);
  }
  .ending.bad {
    color: var(--bad);
  }
`;

/** Render how a run ended, or its status. */
export function endingMark(run: RunSummary) {
  if (!run.ending || !run.tone) return html`<span class="ending">${t().home.status[run.status]}</span>`;
  return html`<span class="ending ${run.tone}">${icon(SIGNS[run.tone], 14)} ${t().verdict.ending(run.ending)}</span>`;
}
