/** All missions: open, make, import, copy from the bin, delete. */

import { answered, client, Refusal } from "../api/client";
import type { PlanSummary } from "../api/types";
import { tell, tellError } from "../state/notices";
import { mayPlan, service } from "../state/session";
import { world } from "../state/world";
import { language, t } from "../texts";
import { css, customElement, html, look, nothing, PageElement, state } from "../ui/element";
import { icon } from "../ui/icons";

interface AreaChoice {
  readonly file: File;
  readonly start: boolean;
  readonly end: boolean;
}

@customElement("argo-home")
export class PageHome extends PageElement {
  static override styles = [
    look,
    css`
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
      .drop {
        padding: 18px;
        border: 2px dashed var(--line);
        border-radius: var(--round);
        text-align: center;
      }
      .drop.over {
        border-color: var(--accent);
        background: var(--chosen);
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
        color: var(--accent);
        font-weight: 600;
      }
      dialog {
        max-width: min(560px, calc(100vw - 24px));
        border: 1px solid var(--line);
        border-radius: 10px;
        background: var(--raised);
        color: var(--text);
      }
      label {
        display: grid;
        gap: 2px;
        margin: 10px 0;
      }
      summary {
        margin-top: 20px;
        cursor: pointer;
      }
      @media (max-width: 560px) {
        .wide {
          display: none;
        }
      }
    `,
  ];

  @state() private missions: readonly PlanSummary[] | null = null;
  @state() private bin: readonly PlanSummary[] = [];
  @state() private over = false;
  @state() private choice: AreaChoice | null = null;

  override connectedCallback(): void {
    super.connectedCallback();
    void this.read();
    addEventListener("focus", this.refresh);
  }

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    removeEventListener("focus", this.refresh);
  }

  private readonly refresh = (): void => void this.read();

  private async read(): Promise<void> {
    try {
      const [all, deleted] = await Promise.all([
        answered(client.GET("/api/missions")),
        answered(client.GET("/api/bin")),
      ]);
      this.missions = all.missions;
      this.bin = deleted.missions;
    } catch (error) {
      tellError(error);
    }
  }

  private focused = false;

  override updated(): void {
    if (!this.focused && mayPlan()) {
      this.focused = true;
      this.renderRoot.querySelector<HTMLElement>("button.main")?.focus();
    }
    this.renderRoot.querySelector("dialog")?.showModal();
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
      <div
        class=${this.over ? "drop over" : "drop"}
        @dragover=${this.onDragOver}
        @dragleave=${() => (this.over = false)}
        @drop=${this.onDrop}
      >
        <p>${texts.dropHere}</p>
        <p class="dim">${texts.whatCanBeImported}</p>
        <input
          id="file"
          class="unseen"
          type="file"
          aria-label=${texts.chooseFile}
          ?disabled=${!may}
          @change=${this.onFile}
        />
        <p>
          <button
            ?disabled=${!may}
            @click=${() => this.renderRoot.querySelector<HTMLElement>("#file")?.click()}
          >
            ${texts.chooseFile}
          </button>
        </p>
      </div>
      ${this.table()} ${this.deleted()} ${this.areas()}
    </div>`;
  }

  private table() {
    const texts = t().frame;
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
              <td class="number wide">${when(one.changed)}</td>
              <td>
                <button
                  class="bare icon"
                  aria-label=${texts.deleteOne(one.name)}
                  title=${texts.delete}
                  ?disabled=${!mayPlan()}
                  @click=${() => this.delete(one)}
                >
                  ${icon("bin")}
                </button>
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

  /** Asks where a mission begins and ends whose script leaves that open. */
  private areas() {
    const choice = this.choice;
    const texts = t().frame;
    if (choice === null) return nothing;
    const field = (name: string, label: string) =>
      html`<label>
        ${label}<select name=${name}>
          ${(world.value?.docks ?? []).map((dock) => html`<option>${dock.area}</option>`)}
        </select>
      </label>`;
    return html`<dialog aria-labelledby="areas" @close=${() => (this.choice = null)}>
      <form @submit=${this.onAreas}>
        <h2 id="areas">${choice.file.name}</h2>
        <p>${texts.areasLeftOpen}</p>
        ${choice.start ? field("start_area", texts.startArea) : nothing}
        ${choice.end ? field("end_area", texts.endArea) : nothing}
        <div class="bar">
          <button class="main">${texts.import}</button>
          <button type="button" @click=${() => (this.choice = null)}>${texts.cancel}</button>
        </div>
      </form>
    </dialog>`;
  }

  private async create(): Promise<void> {
    try {
      const name = free(t().frame.untitled, this.missions ?? []);
      const made = await answered(client.POST("/api/missions", { body: { name } }));
      location.hash = `#/missions/${made.id}`;
    } catch (error) {
      tellError(error);
    }
  }

  private onFile(event: Event): void {
    const field = event.target as HTMLInputElement;
    const file = field.files?.[0];
    if (file) void this.import(file, {});
    field.value = "";
  }

  private onDragOver(event: DragEvent): void {
    event.preventDefault();
    this.over = mayPlan();
  }

  private onDrop(event: DragEvent): void {
    event.preventDefault();
    this.over = false;
    const file = event.dataTransfer?.files[0];
    if (file && mayPlan()) void this.import(file, {});
  }

  private onAreas(event: SubmitEvent): void {
    event.preventDefault();
    const choice = this.choice;
    const given = new FormData(event.target as HTMLFormElement);
    const areas = Object.fromEntries([...given].map(([name, value]) => [name, Number(value)]));
    this.choice = null;
    if (choice !== null) void this.import(choice.file, areas);
  }

  private async import(
    file: File,
    areas: { start_area?: number; end_area?: number },
  ): Promise<void> {
    try {
      const content = await file.arrayBuffer();
      const made = await answered(
        client.POST("/api/imports", {
          params: { query: { filename: file.name.slice(-200), ...areas } },
          body: content as never,
          bodySerializer: (body) => body,
          headers: { "Content-Type": "application/octet-stream" },
        }),
      );
      location.hash = `#/missions/${made.id}`;
    } catch (error) {
      const open = error instanceof Refusal ? openAreas(error) : null;
      if (open === null) this.tellImport(file.name, error);
      else this.choice = { file, ...open };
    }
  }

  /** What is wrong with a file, with the lines where it is. */
  private tellImport(name: string, error: unknown): void {
    if (!(error instanceof Refusal)) return tellError(error);
    const found = error.problem.diagnostics.filter((one) => one.severity === "error");
    const details = found.map((one) => {
      const place = one.span ? `${t().frame.line(one.span.line)}: ` : "";
      return `${place}${one.message}${one.hint ? ` – ${one.hint}` : ""}`;
    });
    const said = found.length > 0 ? t().frame.cantImport(name) : error.message;
    tell("bad", said, { details: details.slice(0, 6) });
  }

  private async delete(one: PlanSummary): Promise<void> {
    try {
      await answered(
        client.DELETE("/api/missions/{id}", { params: { path: { id: one.id } } }) as never,
      );
      const back = { label: t().frame.undo, act: () => void this.restore(one) };
      tell("info", t().frame.deletedOne(one.name), { actions: [back] });
    } catch (error) {
      tellError(error);
    }
    await this.read();
  }

  private async restore(one: PlanSummary): Promise<void> {
    try {
      await answered(
        client.POST("/api/bin/{id}/restore", { params: { path: { id: one.id } } }),
      );
    } catch (error) {
      tellError(error);
    }
    await this.read();
  }
}

/** Whether all that is wrong with a script is that it leaves open where it begins or ends. */
function openAreas(error: Refusal): { start: boolean; end: boolean } | null {
  const errors = error.problem.diagnostics.filter((one) => one.severity === "error");
  if (errors.length === 0 || errors.some((one) => one.code !== "script.area-choice")) return null;
  const open = error.problem.remedies;
  return { start: open.includes("choose-start"), end: open.includes("choose-end") };
}

function free(name: string, known: readonly PlanSummary[]): string {
  const taken = new Set(known.map((one) => one.name));
  let tried = name;
  for (let number = 2; taken.has(tried); number++) tried = `${name} ${number}`;
  return tried;
}

function when(time: string | null | undefined): string {
  if (!time) return "";
  const form = new Intl.DateTimeFormat(language.value, { dateStyle: "medium", timeStyle: "short" });
  return form.format(new Date(time));
}
