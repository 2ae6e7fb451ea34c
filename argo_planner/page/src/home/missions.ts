/** The missions with their last runs: search, folders, copies. */

import type { PlanSummary } from "../api/types";
import { foldersOf, foundMissions, type ListedMission } from "../model/mission-search";
import { mayPlan } from "../state/session";
import { language, t } from "../texts";
import { said } from "../texts/messages";
import { iconButton, valueOf } from "../ui/controls";
import { css, customElement, html, nothing, PageElement, query, state } from "../ui/element";
import { dateAndTime, seconds, timeBounds } from "../ui/figures";
import { icon } from "../ui/icons";
import { binMission, copyMission } from "./actions";
import { endingMark, endingStyles } from "./ending";
import "./folder-dialog";
import type { FolderDialog } from "./folder-dialog";
import { listed, missions, pointedMission } from "./state";

/** Number of rows that are shown at first, and that a click adds. */
const ROWS = 50;

@customElement("argo-missions")
export class MissionList extends PageElement {
  static override styles = [
    endingStyles,
    css`
      .search {
        position: relative;
        flex: 1 1 220px;
      }
      .search input {
        width: 100%;
        padding-left: 32px;
      }
      .search svg {
        position: absolute;
        top: 7px;
        left: 9px;
        color: var(--dim);
        pointer-events: none;
      }
      .folders {
        display: flex;
        flex-wrap: wrap;
        gap: 6px;
        max-height: 124px; /* shows that there are more rows */
        margin-top: 10px;
        overflow: auto;
      }
      .folders button {
        max-width: 100%;
        font-size: 13px;
      }
      .folders .name {
        overflow: hidden;
        text-overflow: ellipsis;
        white-space: nowrap;
        max-width: 220px;
      }
      table {
        width: 100%;
        margin-top: 12px;
        border-collapse: collapse;
      }
      th {
        text-align: left;
        font-weight: 500;
        color: var(--dim);
      }
      td,
      th {
        padding: 7px 8px;
        border-bottom: 1px solid var(--line);
        vertical-align: top;
      }
      tbody tr:hover {
        background: color-mix(in srgb, var(--sunken) 55%, transparent);
      }
      td:first-child {
        overflow-wrap: anywhere;
      }
      a {
        font-weight: 600;
      }
      .more {
        color: var(--dim);
        font-size: 12px;
      }
      .number {
        white-space: nowrap;
      }
      .acts {
        white-space: nowrap;
        padding: 3px 0 3px 8px;
        text-align: right;
      }
      .foot {
        margin-top: 10px;
      }
      @media (max-width: 720px) {
        .wide {
          display: none;
        }
      }
      @media (max-width: 520px) {
        .middle {
          display: none;
        }
      }
    `,
  ];

  @state() private searched = "";
  /** null: all folders */
  @state() private folder: string | null = null;
  @state() private most = ROWS;
  @query("argo-folder-dialog") private readonly dialog!: FolderDialog;

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    pointedMission.value = null;
  }

  override render() {
    const texts = t().home;
    if (missions.value === null) return html`<p class="dim">…</p>`;
    const all = listed.value;
    if (all.length === 0) return html`<p class="dim">${t().frame.noMissions}</p>`;
    const folders = foldersOf(all, language.value);
    // The last mission may have left the folder that is shown.
    const folder = folders.some((one) => one.name === this.folder) ? this.folder : null;
    const found = foundMissions(all, this.searched, folder);
    const shown = found.slice(0, this.most);
    return html`<div class="row">
        <div class="search">
          ${icon("search", 16)}
          <input
            type="search"
            id="search"
            maxlength="200"
            aria-label=${texts.search}
            placeholder=${texts.searchHint}
            .value=${this.searched}
            @input=${this.onSearch}
          />
        </div>
        <span class="dim" role="status">${this.count(found.length, all.length)}</span>
      </div>
      ${folders.length > 0 ? this.folders(folders, folder, all.length) : nothing}
      ${shown.length > 0 ? this.table(shown, folder === null) : html`<p class="dim foot">${texts.nothingFound}</p>`}
      ${found.length > shown.length
        ? html`<p class="foot">
            <button id="more" @click=${() => (this.most += ROWS)}>${texts.showMore(found.length - shown.length)}</button>
          </p>`
        : nothing}
      <argo-folder-dialog .folders=${folders.map((one) => one.name).filter(Boolean)}></argo-folder-dialog>`;
  }

  private count(found: number, all: number): string {
    return found === all ? t().home.count(all) : t().home.countOf(found, all);
  }

  private folders(folders: readonly { name: string; count: number }[], chosen: string | null, all: number) {
    const texts = t().home;
    const button = (name: string | null, label: string, count: number) =>
      html`<button aria-pressed=${chosen === name} title=${label} @click=${() => this.showFolder(name)}>
        ${name === null ? nothing : icon("folder", 15)} <span class="name">${label}</span>
        <span class="dim">${count.toLocaleString(language.value)}</span>
      </button>`;
    return html`<div class="folders" role="group" aria-label=${texts.folders}>
      ${button(null, texts.allFolders, all)}
      ${folders.map(({ name, count }) => button(name, name === "" ? texts.noFolder : name, count))}
    </div>`;
  }

  private table(shown: readonly ListedMission[], withFolder: boolean) {
    const texts = t().home;
    return html`<table>
      <thead>
        <tr>
          <th>${t().frame.mission}</th>
          <th class="middle">${texts.lastRun}</th>
          <th class="wide">${texts.expected}</th>
          <th class="wide">${t().frame.changed}</th>
          <th><span class="unseen">${texts.acts}</span></th>
        </tr>
      </thead>
      <tbody @mouseleave=${() => (pointedMission.value = null)}>
        ${shown.map((one) => this.row(one, withFolder))}
      </tbody>
    </table>`;
  }

  private row({ summary: one, lastRun }: ListedMission, withFolder: boolean) {
    const texts = t().home;
    const may = mayPlan();
    const point = () => (pointedMission.value = one);
    return html`<tr @mouseenter=${point} @focusin=${point}>
      <td>
        ${one.problem
          ? html`${one.name}<br /><span class="more">${said(one.problem, one.problem_wording)}</span>`
          : html`<a href=${`#/missions/${one.id}`}>${one.name}</a>
              <div class="more">
                ${t().list.count(one.tasks)}${withFolder && one.folder !== "" ? html` · ${icon("folder", 12)} ${one.folder}` : nothing}
              </div>`}
      </td>
      <td class="middle number">
        ${lastRun === null
          ? html`<span class="dim">${texts.neverRun}</span>`
          : html`${endingMark(lastRun)} · ${seconds(lastRun.t)}
              <div class="more">
                <a class="more" href=${`#/missions/${one.id}/runs/${lastRun.id}`}>${dateAndTime(lastRun.begun)}</a>
              </div>`}
      </td>
      <td class="number wide">${expectedTime(one)}</td>
      <td class="number wide">${one.changed ? dateAndTime(one.changed) : ""}</td>
      <td class="acts">
        ${one.problem
          ? nothing
          : html`${iconButton("copy", texts.copyOne(one.name), () => copyMission(one), {
              title: texts.copy,
              disabled: !may,
            })}${iconButton("folder", texts.fileOne(one.name), () => this.dialog.open(one), {
              title: texts.file,
              disabled: !may,
            })}`}${iconButton("bin", t().frame.deleteOne(one.name), () => binMission(one), {
          title: t().frame.delete,
          disabled: !may,
        })}
      </td>
    </tr>`;
  }

  private showFolder(name: string | null): void {
    this.folder = name;
    this.most = ROWS;
  }

  private onSearch(event: Event): void {
    this.searched = valueOf(event);
    this.most = ROWS;
  }
}

/** Return the bounds of a mission's duration, if they are known. */
function expectedTime({ least_time: least, most_time: most }: PlanSummary): string {
  return typeof least === "number" ? timeBounds(least, most ?? null) : "–";
}
