/** The reactions of the mission, below its tasks. */

import { reactionKey } from "../model/outline";
import { mission, select, selection } from "../state/plan";
import { panel } from "../state/view";
import { t } from "../texts";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { icon } from "../ui/icons";

@customElement("argo-reactions")
export class MissionReactions extends PageElement {
  static override styles = css`
    section {
      max-height: 26vh;
      overflow: auto;
      border-top: 1px solid var(--line);
    }
    h2 {
      padding: 6px 10px 2px;
    }
    button {
      justify-content: start;
      width: 100%;
      text-align: left;
    }
  `;

  override render() {
    const found = mission.value?.reactions ?? [];
    if (found.length === 0) return nothing;
    const chosen = selection.value.at(-1);
    return html`<section>
      <h2>${t().list.reactions}</h2>
      ${found.map(({ event, response }) => {
        const key = reactionKey(event);
        return html`<button class="bare" aria-pressed=${chosen === key} @click=${() => show(key)}>
          ${icon("reaction", 16)}
          <span class="grow"
            >${t().list.when(t().words.event[event])} <span class="dim">${t().words.response[response]}</span></span
          >
        </button>`;
      })}
    </section>`;
  }
}

function show(key: string): void {
  select([key]);
  panel.value = "properties";
}
