/** Notices above the strip, the newest last. */

import { dismiss, notices, type Notice } from "../state/notices";
import { t } from "../texts";
import { iconButton } from "../ui/controls";
import { css, customElement, html, nothing, PageElement } from "../ui/element";

@customElement("argo-notices")
export class PageNotices extends PageElement {
  static override styles = css`
    :host {
      position: fixed;
      z-index: 30;
      bottom: 130px;
      left: 50%;
      width: min(560px, calc(100vw - 24px));
      translate: -50% 0;
      pointer-events: none;
    }
    article {
      display: flex;
      gap: 10px;
      align-items: flex-start;
      margin-top: 8px;
      padding: 10px 8px 10px 12px;
      border: 1px solid var(--line);
      border-left: 4px solid var(--accent);
      border-radius: var(--round);
      background: var(--raised);
      box-shadow: var(--shadow);
      overflow-wrap: anywhere;
      pointer-events: auto;
    }
    article.warn {
      border-left-color: var(--warn);
    }
    article.bad {
      border-left-color: var(--bad);
    }
    /* On a narrow page the tab bar is at the bottom. */
    @media (max-width: 800px) {
      :host {
        top: 52px;
        bottom: auto;
      }
    }
    ul {
      margin-top: 4px;
      padding-left: 18px;
      list-style: disc;
      color: var(--dim);
    }
    .actions {
      display: flex;
      gap: 6px;
      margin-top: 6px;
    }
  `;

  override render() {
    return html`<div role="log" aria-live="polite" aria-label=${t().frame.messages}>
      ${notices.value.map((notice) => this.notice(notice))}
    </div>`;
  }

  private notice(notice: Notice) {
    const act = (action: Notice["actions"][number]) => () => {
      dismiss(notice.id);
      action.act();
    };
    return html`<article class=${notice.tone}>
      <div class="grow">
        <p>${notice.text}</p>
        ${notice.details.length > 0
          ? html`<ul>
              ${notice.details.map((detail) => html`<li>${detail}</li>`)}
            </ul>`
          : nothing}
        ${notice.actions.length > 0
          ? html`<div class="actions">
              ${notice.actions.map(
                (action) => html`<button @click=${act(action)}>${action.label}</button>`,
              )}
            </div>`
          : nothing}
      </div>
      ${iconButton("close", t().frame.dismiss, () => dismiss(notice.id), { title: nothing, size: 16 })}
    </article>`;
  }
}
