/** The list of missions with a picture of the site: open, create, import, find and delete missions. */

import { responseData, client, retryUntilReached } from "../api/client";
import type { DraftSummary } from "../api/types";
import { createMission, restoreMission } from "../home/actions";
import "../home/examples";
import "../home/missions";
import "../home/runs";
import "../home/site-picture";
import { bin, drafts, missions, readHome, runTurn } from "../home/state";
import { dependOn } from "../state/depend-on";
import { showNotice, showError, withErrorNotice } from "../state/notices";
import { wasDeleted } from "../state/plan";
import { mayPlan, service } from "../state/session";
import { t } from "../texts";
import { iconButton } from "../ui/controls";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { dateAndTime } from "../ui/figures";
import { icon } from "../ui/icons";
import "./import";

const RETRY_MS = 1_000;
/** Interval at which changes of other people appear. */
const EVERY_MS = 10_000;

@customElement("argo-home")
export class PageHome extends PageElement {
  static override styles = css`
    :host {
      overflow: auto;
    }
    .page {
      display: grid;
      grid-template-columns: minmax(0, 1fr) 330px;
      grid-template-rows: auto 1fr;
      gap: 0 36px;
      max-width: 1320px;
      margin: 22px auto;
      padding: 0 20px;
    }
    .bar {
      display: flex;
      flex-wrap: wrap;
      gap: 8px;
      margin-bottom: 16px;
    }
    aside {
      grid-row: 1 / 3;
      grid-column: 2;
      display: grid;
      align-content: start;
      gap: 24px;
    }
    table {
      width: 100%;
      margin-top: 18px;
      border-collapse: collapse;
    }
    th {
      text-align: left;
      font-weight: 500;
      color: var(--dim);
    }
    td,
    th {
      padding: 6px 8px;
      border-bottom: 1px solid var(--line);
    }
    td:first-child {
      overflow-wrap: anywhere;
    }
    td.number {
      white-space: nowrap;
    }
    a {
      font-weight: 600;
    }
    summary,
    argo-import,
    argo-examples {
      margin-top: 20px;
    }
    @media (max-width: 1050px) {
      .page {
        grid-template-columns: minmax(0, 1fr);
      }
      .bar,
      aside {
        order: -1;
      }
      aside {
        grid-row: auto;
        grid-column: 1;
        grid-template-columns: minmax(0, 5fr) minmax(0, 4fr);
        margin-bottom: 22px;
      }
    }
    @media (max-width: 560px) {
      .wide {
        display: none;
      }
      aside {
        grid-template-columns: minmax(0, 1fr);
      }
    }
  `;

  private reading = false;
  private timer: ReturnType<typeof setInterval> | undefined;

  constructor() {
    super();
    this.listen("focus", () => void this.read());
    this.watch(() => {
      dependOn(runTurn);
      void this.read();
    });
  }

  override connectedCallback(): void {
    super.connectedCallback();
    this.timer = setInterval(() => document.hidden || void this.read(), EVERY_MS);
  }

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    clearInterval(this.timer);
  }

  private async read(): Promise<void> {
    const goesOn = () => {
      if (this.isConnected) showNotice("warn", t().frame.readAgain);
      return this.isConnected;
    };
    if (this.reading) return;
    this.reading = true;
    try {
      await retryUntilReached(readHome, goesOn, RETRY_MS);
    } catch (error) {
      if (this.isConnected) showError(error);
    } finally {
      this.reading = false;
    }
  }

  private focused = false;

  override updated(): void {
    if (!this.focused && mayPlan()) {
      this.focused = true;
      // After a mission was deleted by others, the next key must not create a new one.
      if (!wasDeleted.value) this.renderRoot.querySelector<HTMLElement>("button.main")?.focus();
    }
  }

  override render() {
    const texts = t().frame;
    const none = missions.value?.length === 0;
    return html`<div class="page">
      <div class="bar">
        <h1 class="grow">${texts.missionsOf(service.value?.site ?? "…")}</h1>
        <button class="main" ?disabled=${!mayPlan()} @click=${createMission}>
          ${icon("add")} ${texts.newMission}
        </button>
      </div>
      <div>
        <argo-missions></argo-missions>
        ${none ? html`<argo-examples></argo-examples>` : nothing} ${this.begun()}
        <argo-import></argo-import>
        ${none ? nothing : html`<argo-examples></argo-examples>`} ${this.deleted()}
      </div>
      <aside>
        <argo-site-picture></argo-site-picture>
        <argo-latest-runs></argo-latest-runs>
      </aside>
    </div>`;
  }

  /** Render the drafts of scripts that people still have to decide on. */
  private begun() {
    const texts = t().draft;
    if (drafts.value.length === 0) return nothing;
    return html`<table id="drafts">
      <thead>
        <tr>
          <th>${texts.drafts}</th>
          <th>${texts.leftOf}</th>
          <th class="wide">${texts.begun}</th>
          <th><span class="unseen">${t().frame.delete}</span></th>
        </tr>
      </thead>
      <tbody>
        ${drafts.value.map(
          (one) =>
            html`<tr>
              <td><a href=${`#/drafts/${one.id}`}>${one.name}</a></td>
              <td class="number">${one.to_confirm + one.to_answer}</td>
              <td class="number wide">${dateAndTime(one.changed)}</td>
              <td>
                ${iconButton("bin", texts.deleteDraft(one.name), () => this.deleteDraft(one), {
                  title: t().frame.delete,
                  disabled: !mayPlan(),
                })}
              </td>
            </tr>`,
        )}
      </tbody>
    </table>`;
  }

  private deleted() {
    const texts = t().frame;
    if (bin.value.length === 0) return nothing;
    return html`<details>
      <summary>${texts.bin(bin.value.length)}</summary>
      <table>
        <tbody>
          ${bin.value.map(
            (one) =>
              html`<tr>
                <td>${one.name}</td>
                <td>
                  <button ?disabled=${!mayPlan()} @click=${() => restoreMission(one)}>${texts.restore}</button>
                </td>
              </tr>`,
          )}
        </tbody>
      </table>
    </details>`;
  }

  private async deleteDraft(one: DraftSummary): Promise<void> {
    await withErrorNotice(async () => {
      await responseData(client.DELETE("/api/drafts/{id}", { params: { path: { id: one.id } } }));
      showNotice("info", t().draft.deleted(one.name));
    });
    await this.read();
  }
}
