/** The list of missions: open, create, delete, restore. */

import { responseData, client, retryUntilReached } from "../api/client";
import type { DraftSummary, PlanSummary } from "../api/types";
import { freeName } from "../model/naming";
import { showNotice, showError, withErrorNotice } from "../state/notices";
import { wasDeleted } from "../state/plan";
import { mayPlan, service } from "../state/session";
import { t } from "../texts";
import { iconButton } from "../ui/controls";
import { css, customElement, html, nothing, PageElement, state } from "../ui/element";
import { dateAndTime } from "../ui/figures";
import { icon } from "../ui/icons";
import "./import";

const RETRY_MS = 1_000;

@customElement("argo-home")
export class PageHome extends PageElement {
  static override styles = css`
    :host {
      overflow: auto;
    }
    .page {
      max-width: 860px;
      margin: 24px auto;
      padding: 0 16px;
    }
    .bar {
      display: flex;
      flex-wrap: wrap;
      gap: 8px;
      margin-bottom: 16px;
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
    summary {
      margin-top: 20px;
    }
    @media (max-width: 560px) {
      .wide {
        display: none;
      }
    }
  `;

  @state() private missions: readonly PlanSummary[] | null = null;
  @state() private bin: readonly PlanSummary[] = [];
  @state() private drafts: readonly DraftSummary[] = [];
  private reading = false;

  constructor() {
    super();
    this.listen("focus", () => void this.read());
  }

  override connectedCallback(): void {
    super.connectedCallback();
    void this.read();
  }

  private async read(): Promise<void> {
    const both = () =>
      Promise.all([
        responseData(client.GET("/api/missions")),
        responseData(client.GET("/api/bin")),
        responseData(client.GET("/api/drafts")),
      ]);
    const goesOn = () => {
      if (this.isConnected) showNotice("warn", t().frame.readAgain);
      return this.isConnected;
    };
    if (this.reading) return;
    this.reading = true;
    try {
      const [all, deleted, drafts] = await retryUntilReached(both, goesOn, RETRY_MS);
      this.missions = all.missions;
      this.bin = deleted.missions;
      this.drafts = drafts.drafts;
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
    const may = mayPlan();
    return html`<div class="page">
      <div class="bar">
        <h1 class="grow">${texts.missionsOf(service.value?.site ?? "…")}</h1>
        <button class="main" ?disabled=${!may} @click=${this.create}>
          ${icon("add")} ${texts.newMission}
        </button>
      </div>
      <argo-import></argo-import>
      ${this.begun()} ${this.table()} ${this.deleted()}
    </div>`;
  }

  /** Render the drafts of scripts that people still have to decide on. */
  private begun() {
    const texts = t().draft;
    if (this.drafts.length === 0) return nothing;
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
        ${this.drafts.map(
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

  private table() {
    const texts = t().frame;
    const may = mayPlan();
    if (this.missions === null) return html`<p class="dim">…</p>`;
    if (this.missions.length === 0) return html`<p class="dim">${texts.noMissions}</p>`;
    return html`<table>
      <thead>
        <tr>
          <th>${texts.mission}</th>
          <th>${texts.tasks}</th>
          <th class="wide">${texts.changed}</th>
          <th><span class="unseen">${texts.delete}</span></th>
        </tr>
      </thead>
      <tbody>
        ${this.missions.map(
          (one) =>
            html`<tr>
              <td>
                ${one.problem
                  ? html`${one.name}<br /><span class="dim">${one.problem}</span>`
                  : html`<a href=${`#/missions/${one.id}`}>${one.name}</a>`}
              </td>
              <td class="number">${one.problem ? "" : one.tasks}</td>
              <td class="number wide">${one.changed ? dateAndTime(one.changed) : ""}</td>
              <td>
                ${iconButton("bin", texts.deleteOne(one.name), () => this.delete(one), {
                  title: texts.delete,
                  disabled: !may,
                })}
              </td>
            </tr>`,
        )}
      </tbody>
    </table>`;
  }

  private deleted() {
    const texts = t().frame;
    if (this.bin.length === 0) return nothing;
    return html`<details>
      <summary>${texts.bin(this.bin.length)}</summary>
      <table>
        <tbody>
          ${this.bin.map(
            (one) =>
              html`<tr>
                <td>${one.name}</td>
                <td>
                  <button ?disabled=${!mayPlan()} @click=${() => this.restore(one)}>
                    ${texts.restore}
                  </button>
                </td>
              </tr>`,
          )}
        </tbody>
      </table>
    </details>`;
  }

  private async create(): Promise<void> {
    const taken = new Set((this.missions ?? []).map((one) => one.name));
    const { untitled } = t().frame;
    const name = freeName(untitled, taken, (number) => `${untitled} ${number}`);
    await withErrorNotice(async () => {
      const made = await responseData(client.POST("/api/missions", { body: { name } }));
      location.hash = `#/missions/${made.id}`;
    });
  }

  private async deleteDraft(one: DraftSummary): Promise<void> {
    await withErrorNotice(async () => {
      await responseData(client.DELETE("/api/drafts/{id}", { params: { path: { id: one.id } } }));
      showNotice("info", t().draft.deleted(one.name));
    });
    await this.read();
  }

  private async delete(one: PlanSummary): Promise<void> {
    await withErrorNotice(async () => {
      await responseData(
        client.DELETE("/api/missions/{id}", { params: { path: { id: one.id } } }) as never,
      );
      const back = { label: t().frame.undo, act: () => void this.restore(one) };
      showNotice("info", t().frame.deletedOne(one.name), { actions: [back] });
    });
    await this.read();
  }

  private async restore(one: PlanSummary): Promise<void> {
    await withErrorNotice(() => responseData(client.POST("/api/bin/{id}/restore", { params: { path: { id: one.id } } })));
    await this.read();
  }
}
