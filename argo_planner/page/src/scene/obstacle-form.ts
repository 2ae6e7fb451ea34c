/** The form of a new obstacle: name and height. */

import { tool } from "../state/view";
import { t } from "../texts";
import { css, customElement, html, nothing, PageElement, query, state } from "../ui/element";
import { height, hideCorners, addSpannedBox, spannedBox, corners } from "./obstacle-tool";
import { figure } from "../ui/figures";
import { floating } from "./style";

@customElement("argo-obstacle-form")
export class ObstacleForm extends PageElement {
  static override styles = [
    floating,
    css`
      :host {
        inset: 56px 8px auto auto;
        z-index: 4;
      }
      form {
        display: grid;
        gap: 8px;
        width: 230px;
        padding: 10px 12px;
      }
    `,
  ];

  @state() private busy = false;
  @query("#name") private readonly field!: HTMLInputElement | null;
  private asked = false;

  override updated(): void {
    const ready = corners.value?.second ? true : false;
    if (ready && !this.asked) this.field?.focus();
    this.asked = ready;
  }

  override render() {
    const texts = t().scene;
    const box = spannedBox.value;
    if (!corners.value?.second || box === null) return nothing;
    const [x, y, z] = box.size;
    return html`<form class="panel" @submit=${this.submit} @keydown=${this.onKey}>
      <label>
        ${texts.obstacleName}
        <input id="name" maxlength="200" autocomplete="off" />
      </label>
      <label>
        ${texts.obstacleHeight}
        <input
          id="height"
          type="number"
          min="0.05"
          max="5"
          step="any"
          required
          .value=${String(height.value)}
          @input=${(event: Event) => {
            const value = (event.target as HTMLInputElement).valueAsNumber;
            if (value > 0 && value <= 20) height.value = value;
          }}
        />
      </label>
      <p class="dim">${texts.size(figure(x), figure(y), figure(z))}</p>
      <div class="row">
        <button class="main grow" ?disabled=${this.busy}>${texts.putUp}</button>
        <button type="button" @click=${hideCorners}>${texts.cancel}</button>
      </div>
    </form>`;
  }

  private submit(event: Event): void {
    event.preventDefault();
    this.busy = true;
    void addSpannedBox(this.field?.value.trim() ?? "").finally(() => (this.busy = false));
  }

  private onKey(event: KeyboardEvent): void {
    if (event.key !== "Escape") return;
    tool.value = "select";
    event.stopPropagation();
    event.preventDefault();
  }
}
