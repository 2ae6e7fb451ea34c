/** The events of the run, the newest first. A click goes back to that time. */

import { computed } from "@preact/signals-core";

import { runEvents, type RunEvent, type TimedEvent } from "../model/run-events";
import { shownEntries, shownRun, shownTime } from "../state/run";
import { t } from "../texts";
import { faultText } from "../texts/fault-names";
import { said, saidIfAny } from "../texts/messages";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { icon, type Icon } from "../ui/icons";
import { figure, unitText } from "../ui/figures";
import { runTaskLabel } from "./labels";
import { parts } from "./parts";

const MOST = 100;
const SIGNS: Record<TimedEvent["tone"], Icon> = { plain: "right", good: "check", warn: "hand", bad: "warning" };

/** Describe an event of a run. */
export function eventText(what: RunEvent): string {
  const texts = t().run.happened;
  switch (what.kind) {
    case "done":
      return texts.done(runTaskLabel(what.task));
    case "by hand":
      return texts.byHand(runTaskLabel(what.task));
    case "failed":
      return texts.failed(runTaskLabel(what.task), saidIfAny(what.why, what.wording));
    case "stopped":
      return texts.stopped(runTaskLabel(what.task), saidIfAny(what.why, what.wording));
    case "read":
      return texts.read(what.checkpoint, `${figure(what.value)} ${unitText(what.unit)}`);
    case "given":
      return texts.given(what.checkpoint, figure(what.value));
    case "found": {
      const name = t().words.event[what.event as keyof ReturnType<typeof t>["words"]["event"]];
      return what.detail === "" ? name : `${name}: ${said(what.detail, what.wording)}`;
    }
    case "steered":
      return texts[what.how];
    case "fault":
      return texts.fault(faultText(what.fault));
    case "mishap": {
      const name = t().run.trouble[what.trouble];
      return what.detail === "" ? name : `${name}: ${said(what.detail, what.wording)}`;
    }
    case "contact":
      return texts.contact(what.link, what.element);
    case "resumed":
    case "edited":
      return texts[what.kind];
    case "ended":
      return what.stopped === null ? texts.ended : texts.stoppedRun(t().verdict.verdict([what.stopped]));
  }
}

const count = computed(() => shownRun.value?.entries ?? 0);
const eventsNow = computed(() => runEvents(shownEntries.value, 0, count.value));

@customElement("argo-run-events")
export class RunEvents extends PageElement {
  static override styles = [
    parts,
    css`
      li button {
        display: grid;
        grid-template-columns: auto auto minmax(0, 1fr);
        align-items: baseline;
        gap: 6px;
        width: 100%;
        min-height: 26px;
        padding: 2px 4px;
        text-align: left;
        overflow-wrap: anywhere;
      }
      svg {
        align-self: center;
      }
      time {
        color: var(--dim);
        font-size: 12px;
        font-variant-numeric: tabular-nums;
      }
      .good svg {
        color: var(--good);
      }
      .warn svg {
        color: var(--warn);
      }
      .bad {
        color: var(--bad);
      }
    `,
  ];

  override render() {
    if (count.value === 0) return nothing;
    const texts = t().run;
    const shown = eventsNow.value;
    return html`<section aria-label=${texts.events}>
      <h2>${texts.events}</h2>
      ${shown.length === 0
        ? html`<p class="reason">${texts.noEvents}</p>`
        : html`<ol reversed>
            ${shown
              .slice(-MOST)
              .reverse()
              .map(
                (one) =>
                  html`<li class=${one.tone}>
                    <button class="bare" title=${texts.backInTime} @click=${() => (shownTime.value = one.t)}>
                      ${icon(SIGNS[one.tone], 14)} <time>${t().words.seconds(one.t)}</time>
                      <span>${eventText(one.what)}</span>
                    </button>
                  </li>`,
              )}
          </ol>`}
    </section>`;
  }
}
