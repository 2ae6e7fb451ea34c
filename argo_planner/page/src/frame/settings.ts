/** Who works here and in which language. */

import { author, service } from "../state/session";
import { language, t } from "../texts";
import { css, customElement, html, PageElement } from "../ui/element";
import { icon } from "../ui/icons";
import { closed, closeLeft } from "../ui/popover";

@customElement("argo-settings")
export class PageSettings extends PageElement {
  static override styles = css`
    [popover] {
      position: fixed;
      inset: 48px 8px auto auto;
      width: 260px;
      margin: 0;
      padding: 12px;
      border: 1px solid var(--line);
      border-radius: var(--round);
      background: var(--raised);
      color: var(--text);
      box-shadow: var(--shadow);
    }
    label {
      display: grid;
      gap: 2px;
      margin-bottom: 8px;
    }
  `;

  override render() {
    const texts = t().frame;
    return html`<button
        class="bare icon"
        aria-label=${texts.settings}
        title=${texts.settings}
        popovertarget="settings"
      >
        ${icon("settings")}
      </button>
      <div id="settings" popover @focusout=${closeLeft} @toggle=${closed}>
        <label>
          ${texts.yourName}
          <input
            maxlength="100"
            .value=${author.value}
            placeholder=${texts.somebody}
            @change=${(event: Event) => (author.value = (event.target as HTMLInputElement).value.trim())}
          />
        </label>
        <label>
          ${texts.language}
          <select
            .value=${language.value}
            @change=${(event: Event) =>
              (language.value = (event.target as HTMLSelectElement).value === "de" ? "de" : "en")}
          >
            <option value="en" ?selected=${language.value === "en"}>English</option>
            <option value="de" ?selected=${language.value === "de"}>Deutsch</option>
          </select>
        </label>
        <p class="dim">
          ${service.value ? texts.version(service.value.argo, texts.roles[service.value.role]) : ""}
        </p>
      </div>`;
  }
}
