/** Settings: name and language. */

import { author, service } from "../state/session";
import { language, t } from "../texts";
import { iconButton, options, valueOf } from "../ui/controls";
import { css, customElement, html, PageElement } from "../ui/element";
import { returnFocus, closeOnFocusLoss } from "../ui/popover";

@customElement("argo-settings")
export class PageSettings extends PageElement {
  static override styles = css`
    [popover] {
      inset: 48px 8px auto auto;
      width: 260px;
    }
    label {
      margin-bottom: 8px;
    }
  `;

  override render() {
    const texts = t().frame;
    return html`${iconButton("settings", texts.settings, null, { opens: "settings" })}
      <div id="settings" popover @focusout=${closeOnFocusLoss} @toggle=${returnFocus}>
        <label>
          ${texts.yourName}
          <input
            maxlength="100"
            .value=${author.value}
            placeholder=${texts.somebody}
            @change=${(event: Event) => (author.value = valueOf(event).trim())}
          />
        </label>
        <label>
          ${texts.language}
          <select @change=${(event: Event) => (language.value = valueOf(event) === "de" ? "de" : "en")}>
            ${options([["en", "English"], ["de", "Deutsch"]], language.value)}
          </select>
        </label>
        <p class="dim">
          ${service.value ? texts.version(service.value.argo, texts.roles[service.value.role]) : ""}
        </p>
      </div>`;
  }
}
