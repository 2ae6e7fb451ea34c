/** The whole page: it opens the mission that the address names, and lays out the panels. */

import { signal } from "@preact/signals-core";
import { keyed } from "lit/directives/keyed.js";

import { delay, retryUntilReached } from "../api/client";
import "../draft/draft";
import { actsSaved, closeDraft, openDraft, openedDraft } from "../draft/state";
import "../evaluate/evaluate";
import { plansShown } from "../floorplan/state";
import "../forms/properties";
import "../list/list";
import "../route/route";
import "../run/run";
import "../script/script";
import "../strip/strip";
import { allAnswered, waiting } from "../state/commands";
import { closePlan, openPlan, planId, planName } from "../state/plan";
import { followRobot, showRun } from "../state/run";
import { beginSession, readService } from "../state/session";
import { dismiss, showNotice, showError } from "../state/notices";
import { listShown, panel, type Panel } from "../state/view";
import { readWorld } from "../state/world";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { icon, type Icon } from "../ui/icons";
import { t } from "../texts";
import "./home";
import "./keys";
import "./notices";
import "./topbar";

const RETRY_MS = 1_000;
const SENT_WITHIN_MS = 2_000;
const PANELS: readonly (readonly [Panel, Icon])[] = [
  ["properties", "settings"],
  ["script", "script"],
  ["route", "route"],
  ["evaluate", "gauge"],
  ["run", "play"],
];

const PANEL_VIEWS: Readonly<Record<Panel, () => unknown>> = {
  properties: () => html`<argo-properties></argo-properties>`,
  script: () => html`<argo-script></argo-script>`,
  route: () => html`<argo-route></argo-route>`,
  evaluate: () => html`<argo-evaluate></argo-evaluate>`,
  run: () => html`<argo-run></argo-run>`,
};

@customElement("argo-app")
export class ArgoApp extends PageElement {
  static override styles = css`
    :host {
      display: grid;
      grid-template-rows: auto 1fr;
      height: 100%;
    }
    main,
    argo-floor-plans {
      grid-row: 2;
      grid-column: 1;
    }
    main.behind {
      visibility: hidden;
    }
    @media print {
      :host([plans]) {
        display: block;
        height: auto;
      }
      :host([plans]) :not(argo-floor-plans) {
        display: none;
      }
    }
    main {
      display: grid;
      grid-template-columns: minmax(260px, 340px) minmax(0, 1fr) minmax(300px, 380px);
      grid-template-rows: minmax(0, 1fr) auto;
      position: relative;
      min-height: 0;
    }
    .work {
      display: contents;
    }
    argo-list {
      grid-row: 1 / 3;
      min-height: 0;
      border-right: 1px solid var(--line);
      background: var(--surface);
    }
    argo-scene {
      min-height: 0;
      min-width: 0;
    }
    .loading {
      padding: 16px; /* shown until the scene is there, which is the largest part of the page */
    }
    argo-strip {
      grid-column: 2;
      min-height: 136px; /* as with tasks in it, so that the site does not move under the pointer */
      min-width: 0;
      border-top: 1px solid var(--line);
      background: var(--surface);
    }
    aside {
      grid-column: 3;
      grid-row: 1 / 3;
      display: grid;
      grid-template-columns: minmax(0, 1fr);
      grid-template-rows: auto minmax(0, 1fr);
      container-type: inline-size;
      min-height: 0;
      border-left: 1px solid var(--line);
      background: var(--surface);
    }
    [role="tablist"] {
      display: flex;
      gap: 2px;
      padding: 6px 6px 0;
      border-bottom: 1px solid var(--line);
    }
    [role="tab"] {
      flex: auto;
      min-width: 0;
      gap: 4px;
      padding: 3px 4px;
      font-size: 13px;
      border: 0;
      border-bottom: 3px solid transparent;
      border-radius: 6px 6px 0 0;
      background: none;
    }
    [role="tab"][aria-selected="true"] {
      border-bottom-color: var(--accent);
      color: var(--accent);
      font-weight: 600;
    }
    @container (max-width: 350px) {
      [role="tab"] svg {
        display: none;
      }
    }
    [role="tabpanel"] {
      min-height: 0;
      overflow: auto;
    }
    /* The list beside the site, and the panel below it. */
    @media (max-width: 1179px) {
      main {
        grid-template-columns: minmax(230px, 32%) minmax(0, 1fr);
        grid-template-rows: minmax(0, 1fr);
      }
      .work {
        display: grid;
        grid-template-columns: minmax(0, 1fr);
        grid-template-rows: minmax(200px, 46%) max-content minmax(240px, 1fr);
        min-height: 0;
        overflow-y: auto;
      }
      argo-list,
      argo-strip,
      aside {
        grid-column: auto;
        grid-row: auto;
      }
      argo-strip {
        min-height: 0;
        max-height: none;
      }
      aside {
        border-left: 0;
        border-top: 1px solid var(--line);
      }
    }
    /* No room for a panel that scrolls by itself. */
    @media (max-width: 719px), (max-width: 1179px) and (max-height: 560px) {
      .work {
        grid-template-rows: minmax(200px, 46%) max-content max-content;
      }
      aside {
        min-height: 100%;
        grid-template-rows: auto auto;
      }
      [role="tabpanel"] {
        overflow: visible;
      }
      [role="tablist"] {
        flex-wrap: wrap;
      }
    }
    /* The list is a drawer. */
    @media (max-width: 719px) {
      main {
        grid-template-columns: minmax(0, 1fr);
      }
      argo-list {
        position: absolute;
        inset: 0 auto 0 0;
        z-index: 20;
        width: min(340px, 100% - 24px);
        box-shadow: var(--shadow);
      }
      main:not(.list-shown) argo-list {
        visibility: hidden;
      }
    }
  `;

  /** Address of the mission or draft that is being read; null: none is. */
  private readonly opening = signal<string | null>(null);
  /** Id of the run to show in the mission that is being opened; null: none. */
  private namedRun: string | null = null;

  constructor() {
    super();
    this.listen("open-details", () => (listShown.value = false));
    this.listen("hashchange", () => void this.followAddress());
    // The browser asks for confirmation if edits have not been sent.
    this.listen("beforeunload", (event) => waiting.value > 0 && event.preventDefault());
    this.watch(() => {
      const name = planName.value || openedDraft.value?.name;
      document.title = name ? `${name} – Argo` : "Argo";
    });
  }

  override connectedCallback(): void {
    super.connectedCallback();
    beginSession();
    void this.begin();
  }

  /** Read all that does not depend on the mission; repeat this until the service answers. */
  private async begin(): Promise<void> {
    void this.followAddress().then(readScene);
    followRobot();
    const isWanted = () => {
      showNotice("warn", t().frame.readAgain);
      return true;
    };
    await retryUntilReached(() => Promise.all([readService(), readWorld()]), isWanted, RETRY_MS).catch(showError);
  }

  /** Open the mission or list that the address names. A later change of the address has precedence. */
  private async followAddress(): Promise<void> {
    const address = namedAddress();
    this.takeRunOfAddress();
    if (address === (this.opening.value ?? openedAddress())) this.showNamedRun();
    if (address === (this.opening.value ?? openedAddress())) return;
    if (planId.value !== null && !(await allSent())) {
      this.stayFor(address);
      return;
    }
    if (openedDraft.value !== null) await Promise.race([decisionsSaved(), delay(SENT_WITHIN_MS)]);
    if (namedAddress() !== address) return;
    this.opening.value = address;
    if (address === "#" || draftIn(address) !== null) closePlan();
    if (address === "#" || missionIn(address) !== null) closeDraft();
    if (address === "#") {
      this.opening.value = null;
      return;
    }
    const isMeant = () => this.opening.value === address;
    const [mission, draft] = [missionIn(address), draftIn(address)];
    try {
      if (draft !== null) await retryUntilReached(() => openDraft(draft, isMeant), isMeant, RETRY_MS);
      else if (mission !== null) await retryUntilReached(() => openPlan(mission, isMeant), isMeant, RETRY_MS);
      this.showNamedRun();
      await this.updateComplete;
      // The element with the focus is gone. Keys are to work at once.
      setTimeout(() => {
        if (document.activeElement === document.body) dispatchEvent(new CustomEvent("focus-list"));
      });
    } catch (error) {
      if (!isMeant()) return;
      location.hash = "";
      showError(error);
    } finally {
      if (isMeant()) this.opening.value = null;
    }
  }

  /** Take the run out of an address such as `#/missions/…/runs/…`; it is shown once the mission is open. */
  private takeRunOfAddress(): void {
    const found = /^(#\/missions\/[0-9a-f]+)\/runs\/([0-9a-f-]+)$/.exec(location.hash);
    if (found === null) return;
    [, , this.namedRun = null] = found;
    history.replaceState(null, "", found[1]);
  }

  /** Show the run that the address has named. */
  private showNamedRun(): void {
    if (this.namedRun === null || planId.value === null) return;
    panel.value = "run";
    showRun(this.namedRun).catch(showError);
    this.namedRun = null;
  }

  /** Keep a mission open whose edits have not all been sent, until they are or the person leaves it. */
  private stayFor(address: string): void {
    const leave = () => {
      closePlan();
      location.hash = address;
      void this.followAddress();
    };
    history.replaceState(null, "", openedAddress());
    const texts = t().frame;
    const notice = showNotice("bad", texts.unsent(waiting.value), { actions: [{ label: texts.leaveAnyway, act: leave }] });
    void allAnswered().then(() => dismiss(notice)); // the message would no longer be true
  }

  override render() {
    const open = planId.value !== null;
    const plans = open && plansShown.value !== "off";
    this.toggleAttribute("plans", plans);
    document.documentElement.toggleAttribute("data-plans", plans);
    return html`
      <argo-topbar></argo-topbar>
      ${open
        ? html`${this.planning(plans)} ${plans ? html`<argo-floor-plans></argo-floor-plans>` : nothing}`
        : openedDraft.value !== null
          ? html`<argo-draft></argo-draft>`
          : this.opening.value !== null
            ? html`<main></main>`
            : html`<argo-home></argo-home>`}
      <argo-notices></argo-notices>
      <argo-keys></argo-keys>
    `;
  }

  /** Render the list, the scene and the panels; they stay while the floor plans are shown in their place. */
  private planning(behind: boolean) {
    const shown = panel.value;
    // What a person has typed or folded in one mission is not shown in the next one. The scene, which takes long to
    // load, stays and resets itself.
    const ofMission = (part: unknown) => keyed(planId.value, part);
    const looks = `${behind ? "behind" : ""} ${listShown.value ? "list-shown" : ""}`;
    return html`<main class=${looks} ?inert=${behind}>
      ${ofMission(html`<argo-list></argo-list>`)}
      <div class="work" @pointerdown=${() => (listShown.value = false)}>
      <argo-scene><p class="dim loading">${t().scene.loading}</p></argo-scene>
      ${ofMission(html`<argo-strip></argo-strip>`)}
      <aside>
        <div role="tablist" @keydown=${this.onTabKey}>
          ${PANELS.map(
            ([name, sign]) =>
              html`<button
                role="tab"
                id=${`tab-${name}`}
                aria-selected=${shown === name}
                aria-controls="panel"
                tabindex=${shown === name ? 0 : -1}
                @click=${() => (panel.value = name)}
              >
                ${icon(sign, 16)} ${t().frame.panels[name]}
              </button>`,
          )}
        </div>
        <div role="tabpanel" id="panel" aria-labelledby=${`tab-${shown}`} tabindex="-1">
          ${ofMission(PANEL_VIEWS[shown]())}
        </div>
      </aside>
      </div>
    </main>`;
  }

  private onTabKey(event: KeyboardEvent): void {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (step === undefined) return;
    const names = PANELS.map(([name]) => name);
    const next = names[(names.indexOf(panel.value) + step + names.length) % names.length];
    if (next === undefined) return;
    panel.value = next;
    this.renderRoot.querySelector<HTMLElement>(`#tab-${next}`)?.focus();
    event.preventDefault();
  }
}

/** Return the mission or draft that the address names, as `#/missions/…` or `#/drafts/…`; `#`: the list. */
function namedAddress(): string {
  const mission = missionIn(location.hash);
  if (mission !== null) return `#/missions/${mission}`;
  return draftIn(location.hash) !== null ? location.hash : "#";
}

/** Return the address of what is open. */
function openedAddress(): string {
  if (planId.value !== null) return `#/missions/${planId.value}`;
  return openedDraft.value === null ? "#" : `#/drafts/${openedDraft.value.id}`;
}

function missionIn(address: string): string | null {
  return /^#\/missions\/([0-9a-f]+)(?:\/runs\/[0-9a-f-]+)?$/.exec(address)?.[1] ?? null;
}

function draftIn(address: string): string | null {
  return /^#\/drafts\/([0-9a-f]+)$/.exec(address)?.[1] ?? null;
}

/** Wait until all decisions on the open draft are stored by the service. */
async function decisionsSaved(): Promise<void> {
  while (!actsSaved.value) await delay(20);
}

/** Return whether all edits are sent, now or within a moment. */
async function allSent(): Promise<boolean> {
  if (waiting.value > 0) await Promise.race([allAnswered(), delay(SENT_WITHIN_MS)]);
  return waiting.value === 0;
}

/** Load the scene, the largest part of the page by far, when the browser is idle. */
async function readScene(): Promise<void> {
  while (!customElements.get("argo-scene")) {
    await browserIdle();
    try {
      await import("../scene/scene");
    } catch {
      showNotice("warn", t().frame.readAgain);
      await delay(RETRY_MS);
    }
  }
}

/** Wait until the browser is idle, if it can tell. */
function browserIdle(): Promise<void> {
  if (!("requestIdleCallback" in window)) return delay(0);
  return new Promise((resolve) => requestIdleCallback(() => resolve(), { timeout: RETRY_MS }));
}
