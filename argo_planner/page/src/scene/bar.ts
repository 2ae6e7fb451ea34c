/** Tools, the camera's buttons, and what of the site is shown. */

import { runIsOn, shownRun } from "../state/run";
import { mayPlan } from "../state/session";
import { following, shownFloor, tool, type Tool } from "../state/view";
import { t } from "../texts";
import { css, customElement, html, nothing, PageElement, property, state } from "../ui/element";
import { icon, type Icon } from "../ui/icons";
import { floating } from "./panel";
import { edgesMove, hidden, hide, labelsShown, pathsShown } from "./settings";
import { HIDEABLE } from "./site";
import type { SceneView } from "./view";
import type { Signal } from "@preact/signals-core";

const TURN = 0.6;
const SIGNS: Readonly<Record<"hand" | "home" | "above" | "plus" | "minus" | "left" | "right", string>> = {
  hand: "M6 3l12 9-6 1-3 6z",
  home: "M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5",
  above: "M12 4v12M7 11l5 5 5-5M5 20h14",
  plus: "M12 5v14M5 12h14",
  minus: "M5 12h14",
  left: "M5 12a7 7 0 1 0 3-6M8 2v4h4",
  right: "M19 12a7 7 0 1 1-3-6M16 2v4h-4",
};

@customElement("argo-scene-bar")
export class SceneBar extends PageElement {
  static override styles = [
    floating,
    css`
      :host {
        inset: 8px 8px auto auto;
        display: flex;
        gap: 8px;
        align-items: start;
      }
      .panel {
        display: flex;
        padding: 2px;
      }
      @media (max-width: 800px) {
        .tools {
          display: none; /* a phone is for watching */
        }
      }
      .settings {
        position: absolute;
        top: 42px;
        right: 0;
        display: grid;
        gap: 6px;
        width: 250px;
        padding: 10px 12px;
      }
      .settings label {
        display: flex;
        align-items: center;
        gap: 8px;
      }
      select {
        flex: 1;
      }
    `,
  ];

  @property({ attribute: false }) view: SceneView | null = null;
  @state() private open = false;

  override connectedCallback(): void {
    super.connectedCallback();
    addEventListener("pointerdown", this.onOutside);
  }

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    removeEventListener("pointerdown", this.onOutside);
  }

  private readonly onOutside = (event: Event): void => {
    if (!event.composedPath().includes(this)) this.open = false;
  };

  override render() {
    const texts = t().scene;
    const { view } = this;
    if (view === null) return nothing;
    const { camera } = view;
    return html`
      <div class="panel tools" role="toolbar" aria-label=${texts.tools}>
        ${this.tool("select", "hand", texts.toolSelect, "Esc")}
        ${this.tool("navigate", "drive", texts.toolNavigate, "n")}
        ${this.tool("obstacle", "obstacle", texts.toolObstacle, "o")}
      </div>
      <div class="panel" role="toolbar" aria-label=${texts.view}>
        ${this.button("home", texts.showAll, () => void camera.showAll(shownFloor.value))}
        ${this.button("above", texts.fromAbove, () => camera.topView())}
        ${this.button("left", texts.turnLeft, () => camera.turn(-TURN))}
        ${this.button("right", texts.turnRight, () => camera.turn(TURN))}
        ${this.button("plus", texts.nearer, () => camera.zoom(1))}
        ${this.button("minus", texts.farther, () => camera.zoom(-1))}
        <button
          class="bare icon"
          aria-label=${texts.settings}
          title=${texts.settings}
          aria-expanded=${this.open}
          @click=${() => (this.open = !this.open)}
        >
          ${icon("settings")}
        </button>
      </div>
      ${this.open ? this.settings() : nothing}
    `;
  }

  private tool(which: Tool, sign: Icon | "hand", label: string, key: string) {
    const may = which === "select" || mayPlan();
    return html`<button
      class="bare icon"
      aria-label=${label}
      title=${may ? `${label} (${key})` : t().scene.mayNot}
      aria-pressed=${tool.value === which}
      ?disabled=${!may}
      @click=${() => (tool.value = which)}
    >
      ${sign === "hand" ? lines(SIGNS.hand) : icon(sign)}
    </button>`;
  }

  private button(sign: keyof typeof SIGNS, label: string, act: () => void) {
    return html`<button class="bare icon" aria-label=${label} title=${label} @click=${act}>
      ${lines(SIGNS[sign])}
    </button>`;
  }

  private settings() {
    const texts = t().scene;
    const box = (label: string, value: boolean, set: (on: boolean) => void) =>
      html`<label>
        <input type="checkbox" .checked=${value} @change=${(event: Event) => set((event.target as HTMLInputElement).checked)} />
        ${label}
      </label>`;
    const kept = (one: Signal<boolean>) => (on: boolean) => (one.value = on);
    const canFollow = shownRun.value !== null || runIsOn.value;
    return html`<div
      class="panel settings"
      @keydown=${(event: KeyboardEvent) => {
        if (event.key !== "Escape") return;
        this.open = false;
        this.renderRoot.querySelector<HTMLElement>("[aria-expanded]")?.focus();
        event.stopPropagation();
      }}
      @focusout=${(event: FocusEvent) => {
        const to = event.relatedTarget as Element | null;
        if (to !== null && to.closest(".settings, [aria-expanded]") === null) this.open = false;
      }}
    >
      ${HIDEABLE.map((one) => box(texts.hide[one], !hidden.value.has(one), (on) => hide(one, !on)))}
      ${box(texts.labels, labelsShown.value, kept(labelsShown))} ${box(texts.paths, pathsShown.value, kept(pathsShown))}
      ${box(texts.edges, edgesMove.value, kept(edgesMove))}
      <label>
        ${texts.follow}
        <select
          ?disabled=${!canFollow}
          @change=${(event: Event) =>
            (following.value = (event.target as HTMLSelectElement).value as typeof following.value)}
        >
          <option value="off" .selected=${following.value === "off"}>${texts.followOff}</option>
          <option value="behind" .selected=${following.value === "behind"}>${texts.followBehind}</option>
          <option value="above" .selected=${following.value === "above"}>${texts.followAbove}</option>
        </select>
      </label>
    </div>`;
  }
}

function lines(path: string) {
  return html`<svg
    viewBox="0 0 24 24"
    width="18"
    height="18"
    fill="none"
    stroke="currentColor"
    stroke-width="2"
    stroke-linecap="round"
    stroke-linejoin="round"
    aria-hidden="true"
  >
    <path d=${path} />
  </svg>`;
}
