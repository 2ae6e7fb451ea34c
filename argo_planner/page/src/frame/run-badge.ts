/** The robot's state in the top bar, with a button that pauses it. */

import { isUnderWay } from "../model/run-mode";
import { modeWords } from "../run/mode-words";
import { sendRequest, pendingRequests } from "../state/requests";
import { planId } from "../state/plan";
import { presentMode, run, runIsOn } from "../state/run";
import { mayOperate } from "../state/session";
import { panel } from "../state/view";
import { t } from "../texts";
import { iconButton } from "../ui/controls";
import { css, customElement, html, nothing, PageElement } from "../ui/element";

@customElement("argo-run-badge")
export class RunBadge extends PageElement {
  static override styles = css`
    .run {
      gap: 0;
      border: 1px solid var(--line);
      border-left: 4px solid var(--accent);
      border-radius: 6px;
      font-size: 13px;
    }
    .run.unknown {
      border-style: dashed;
      border-left-color: var(--dim);
      background: var(--sunken);
    }
    .run.supervised {
      border-left-color: var(--person);
    }
  `;

  override render() {
    const state = run.value;
    if (state === null || !runIsOn.value) return nothing;
    const mode = presentMode(state);
    const texts = t().run;
    const show = () => {
      if (planId.value === null) location.hash = `#/missions/${state.plan}`;
      panel.value = "run";
    };
    const drives = state.status === "running" && state.mode !== "paused" && state.mode !== "supervised";
    return html`<span class="row run ${mode}">
      <button class="bare" title=${state.name} @click=${show}>${modeWords(state)}</button>
      ${drives && mayOperate()
        ? iconButton("pause", texts.pauseRobot, () => sendRequest({ kind: "pause" }), {
            disabled: pendingRequests.value.includes("pause") || isUnderWay(state, "pause"),
          })
        : nothing}
    </span>`;
  }
}
