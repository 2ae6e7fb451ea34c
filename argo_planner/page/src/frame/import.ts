/** The import of a mission from a file. */

import { responseData, Refusal } from "../api/client";
import { uploadFile } from "../api/upload";
import { messageOf, showNotice, showError } from "../state/notices";
import { mayPlan } from "../state/session";
import { world } from "../state/world";
import { t } from "../texts";
import { said } from "../texts/messages";
import { placeBefore } from "../texts/place";
import { choice } from "../ui/controls";
import { css, customElement, html, nothing, PageElement, state } from "../ui/element";

interface AreaChoice {
  readonly file: File;
  readonly start: boolean;
  readonly end: boolean;
}

@customElement("argo-import")
export class MissionImport extends PageElement {
  static override styles = css`
    .drop {
      display: grid;
      justify-items: center;
      gap: 6px;
      padding: 18px;
      border: 2px dashed var(--line);
      border-radius: var(--round);
      text-align: center;
    }
    .drop.over {
      border-color: var(--accent);
      background: var(--chosen);
    }
    dialog {
      max-width: min(560px, calc(100vw - 24px));
      border: 1px solid var(--line);
      border-radius: 10px;
      background: var(--raised);
      color: var(--text);
    }
    label {
      margin: 10px 0;
    }
  `;

  @state() private over = false;
  @state() private choice: AreaChoice | null = null;

  override updated(): void {
    const dialog = this.renderRoot.querySelector("dialog");
    if (dialog?.open === false) dialog.showModal();
  }

  override render() {
    const texts = t().frame;
    const may = mayPlan();
    return html`<div
        class=${this.over ? "drop over" : "drop"}
        @dragover=${this.onDragOver}
        @dragleave=${() => (this.over = false)}
        @drop=${this.onDrop}
      >
        <p class="row">
          ${texts.dropHere}
          <button
            ?disabled=${!may}
            @click=${() => this.renderRoot.querySelector<HTMLElement>("#file")?.click()}
          >
            ${texts.chooseFile}
          </button>
        </p>
        <p class="dim">${texts.whatCanBeImported}</p>
        <input
          id="file"
          hidden
          type="file"
          aria-label=${texts.chooseFile}
          ?disabled=${!may}
          @change=${this.onFile}
        />
      </div>
      ${this.areas()}`;
  }

  /** Ask for the start and end area if the script does not name them. */
  private areas() {
    const open = this.choice;
    const texts = t().frame;
    if (open === null) return nothing;
    const areas = (world.value?.docks ?? []).map(({ area }) => [area, area] as const);
    return html`<dialog aria-labelledby="areas" @close=${() => (this.choice = null)}>
      <form @submit=${this.onAreas}>
        <h2 id="areas">${open.file.name}</h2>
        <p>${texts.areasLeftOpen}</p>
        ${open.start ? choice(texts.startArea, "start_area", areas) : nothing}
        ${open.end ? choice(texts.endArea, "end_area", areas) : nothing}
        <div class="row">
          <button class="main">${texts.import}</button>
          <button type="button" @click=${() => (this.choice = null)}>${texts.cancel}</button>
        </div>
      </form>
    </dialog>`;
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
      const made = await responseData(uploadFile(file.name, content, areas));
      location.hash = "lines" in made ? `#/drafts/${made.id}` : `#/missions/${made.id}`;
    } catch (error) {
      const open = error instanceof Refusal ? openAreas(error) : null;
      if (open === null) this.tellImport(file.name, error);
      else this.choice = { file, ...open };
    }
  }

  /** Show the errors of a file with their lines. */
  private tellImport(name: string, error: unknown): void {
    if (!(error instanceof Refusal)) return showError(error);
    const found = error.problem.diagnostics.filter((one) => one.severity === "error");
    const details = found.map((one) => `${placeBefore(one)}${said(one.message, one.message_wording)}${one.hint ? ` – ${said(one.hint, one.hint_wording)}` : ""}`);
    const text = found.length > 0 ? t().frame.cantImport(name) : messageOf(error);
    showNotice("bad", text, { details: details.slice(0, 6) });
  }
}

/** Return which areas the script leaves open; null: it has other errors. */
function openAreas(error: Refusal): { start: boolean; end: boolean } | null {
  const errors = error.problem.diagnostics.filter((one) => one.severity === "error");
  if (errors.length === 0 || errors.some((one) => one.code !== "script.area-choice")) return null;
  const open = error.problem.remedies;
  return { start: open.includes("choose-start"), end: open.includes("choose-end") };
}
