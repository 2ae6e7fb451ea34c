/** The requests to a run as a whole. */

import type { RequestState } from "../api/types";
import { isOver, isUnderWay, shownRequests } from "../model/run-mode";
import { planId, revision } from "../state/plan";
import { sendRequest, pendingRequests, giveBackEdited } from "../state/requests";
import { run, shownTime } from "../state/run";
import { chooseFollowing, followChoices } from "../scene/following";
import { mayOperate } from "../state/session";
import { following } from "../state/view";
import { t } from "../texts";
import { said } from "../texts/messages";
import { options, valueOf } from "../ui/controls";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { icon, type Icon } from "../ui/icons";
import { requestText } from "./labels";
import { parts, readSpeed, SPEEDS, speedName } from "./parts";

const PAST_REQUESTS = 3;
type Simple = "pause" | "go_on" | "stop" | "cancel" | "take_over" | "give_back";
const SIGNS: Record<Simple, Icon> = {
  pause: "pause",
  go_on: "play",
  stop: "stop",
  cancel: "close",
  take_over: "hand",
  give_back: "play",
};

@customElement("argo-run-controls")
export class RunControls extends PageElement {
  static override styles = [
    parts,
    css`
      .buttons {
        display: grid;
        grid-template-columns: 1fr 1fr;
        gap: var(--gap);
      }
      .buttons button {
        min-height: 40px;
      }
      .wide {
        grid-column: 1 / 3;
      }
      button.main {
        font-weight: 600;
      }
      button[aria-busy="true"] {
        border-style: dashed;
      }
      .asked {
        margin-top: 8px;
        font-size: 12px;
      }
      .asked li {
        display: flex;
        gap: 6px;
        padding: 1px 0;
      }
      .asked .how {
        font-weight: 600;
      }
      .how.refused,
      .how.failed {
        color: var(--bad);
      }
      .how.confirmed {
        color: var(--good);
      }
      .how.accepted,
      .how.under {
        color: var(--warn);
      }
    `,
  ];

  override render() {
    const state = run.value;
    if (state === null || state.status === "ended") return nothing;
    return html`${shownTime.value === null ? nothing : html`<p class="reason">${t().run.actsNow}</p>`}
      ${state.status === "preparing"
        ? nothing
        : html`<div class="buttons">${this.buttons()} ${this.follow()}</div>`}
      ${mayOperate() ? nothing : html`<p class="reason">${t().run.mayNotOperate}</p>`} ${this.asked()}`;
  }

  private buttons() {
    const state = run.value;
    if (state === null) return nothing;
    if (state.status === "interrupted") return [this.simple("go_on", "main"), this.simple("stop", "danger")];
    const rest = [this.simple("cancel", "danger"), this.simple("stop", "danger"), this.speed()];
    switch (state.mode) {
      case "supervised":
        // With edits, the main button gives the robot back with them; the other one states that it ignores
        // them.
        return this.isEdited()
          ? [this.giveBackEdited(), this.simple("give_back", "", t().run.giveBackUnedited), ...rest]
          : [this.simple("give_back", "main"), ...rest];
      case "paused":
        return [this.simple("go_on", "main"), this.simple("take_over"), ...rest];
      default:
        return [this.simple("pause", "main"), this.simple("take_over"), ...rest];
    }
  }

  private simple(kind: Simple, look = "", label = t().run.requests[kind]) {
    const state = run.value;
    const busy = state !== null && (isUnderWay(state, kind) || pendingRequests.value.includes(kind));
    return html`<button
      id=${kind}
      class=${look}
      aria-busy=${busy}
      title=${{ cancel: t().run.cancelMeans, stop: t().run.stopMeans }[kind as string] ?? nothing}
      ?disabled=${!mayOperate() || busy}
      @click=${() => sendRequest({ kind })}
    >
      ${icon(SIGNS[kind])} ${label}
    </button>`;
  }

  /** Return whether the mission has a newer revision than the run. */
  private isEdited(): boolean {
    const state = run.value;
    return state !== null && state.plan === planId.value && state.revision !== revision.value;
  }

  private giveBackEdited() {
    return html`<button
      id="give_back_edited"
      class="main"
      ?disabled=${!mayOperate()}
      title=${t().run.edited}
      @click=${() => giveBackEdited()}
    >
      ${icon("script")} ${t().run.requests["go_on_edited"]}
    </button>`;
  }

  private speed() {
    const now = run.value?.speed ?? null;
    const known = SPEEDS.includes(now) ? SPEEDS : [...SPEEDS, now];
    return html`<label class="wide">
      <span class="unseen">${t().run.speed}</span>
      <select
        id="speed"
        ?disabled=${!mayOperate()}
        @change=${(event: Event) => sendRequest({ kind: "speed", speed: readSpeed(valueOf(event)) })}
      >
        ${options(known.map((speed) => [speed, `${t().run.speed}: ${speedName(speed)}`]), now)}
      </select>
    </label>`;
  }

  /** Render the choice of how the camera follows the robot. */
  private follow() {
    const texts = t().scene;
    return html`<label class="wide">
      <span class="unseen">${texts.follow}</span>
      <select id="follow" @change=${chooseFollowing}>
        ${options(followChoices(`${texts.follow}: `), following.value)}
      </select>
    </label>`;
  }

  /** Render the last requests and their progress. */
  private asked() {
    const all = (run.value?.requests ?? []).filter((one) => !isStep(one));
    const shown = shownRequests(all, PAST_REQUESTS);
    const texts = t().run;
    if (shown.length === 0) return nothing;
    return html`<ul class="asked" aria-label=${texts.asked}>
      ${shown.map(
        (one) =>
          html`<li>
            <span class="how ${one.progress}">
              ${icon(isOver(one) ? (one.progress === "confirmed" ? "check" : "warning") : "clock", 13)}
              ${texts.progress[one.progress]}
            </span>
            <span class="grow">
              ${requestText(one)}
              <span class="dim">${texts.byWhom(one.by)}</span>
              ${one.reason ? html`<br /><span>${said(one.reason, one.reason_wording)}</span>` : nothing}
            </span>
          </li>`,
      )}
    </ul>`;
  }
}

/** Return whether a request is a step of driving by keys; there are many, and the robot itself shows that
 * they are done. */
function isStep(request: RequestState): boolean {
  return isOver(request) && (request.kind === "drive_to" || request.kind === "stop_by_hand");
}
