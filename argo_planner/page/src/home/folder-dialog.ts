/** The dialog that moves a mission to a folder, an existing or a new one. */

import type { PlanSummary } from "../api/types";
import { t } from "../texts";
import { css, customElement, html, nothing, PageElement, property, query, state } from "../ui/element";
import { fileMission } from "./actions";

@customElement("argo-folder-dialog")
export class FolderDialog extends PageElement {
  static override styles = css`
    dialog {
      width: min(440px, calc(100vw - 24px));
      padding: 16px 20px 20px;
      border: 1px solid var(--line);
      border-radius: 10px;
      background: var(--raised);
      color: var(--text);
      box-shadow: var(--shadow);
    }
    dialog::backdrop {
      background: rgb(0 0 0 / 40%);
    }
    h2 {
      overflow-wrap: anywhere;
    }
    label {
      margin: 12px 0;
    }
    .row {
      flex-wrap: wrap;
    }
  `;

  @property({ attribute: false }) folders: readonly string[] = [];
  @state() private mission: PlanSummary | null = null;
  @query("dialog") private readonly dialog!: HTMLDialogElement;
  @query("input") private readonly field!: HTMLInputElement;

  /** Ask for the folder of a mission. */
  async open(mission: PlanSummary): Promise<void> {
    this.mission = mission;
    await this.updateComplete;
    this.dialog.showModal();
    this.field.value = mission.folder;
    this.field.select();
  }

  override render() {
    const { mission } = this;
    const texts = t().home;
    return html`<dialog aria-labelledby="title" @close=${() => (this.mission = null)}>
      ${mission === null
        ? nothing
        : html`<form method="dialog" @submit=${this.onSubmit}>
            <h2 id="title">${texts.fileOne(mission.name)}</h2>
            <label>
              ${texts.folder}
              <input name="folder" list="folders" maxlength="200" autocomplete="off" placeholder=${texts.folderHint} />
            </label>
            <datalist id="folders">${this.folders.map((name) => html`<option value=${name}></option>`)}</datalist>
            <div class="row">
              <button class="main">${texts.file}</button>
              ${mission.folder === ""
                ? nothing
                : html`<button type="button" @click=${() => this.choose(mission, "")}>${texts.takeOut}</button>`}
              <button type="button" @click=${() => this.dialog.close()}>${t().frame.cancel}</button>
            </div>
          </form>`}
    </dialog>`;
  }

  private onSubmit(event: SubmitEvent): void {
    event.preventDefault();
    if (this.mission !== null) this.choose(this.mission, this.field.value.trim());
  }

  private choose(mission: PlanSummary, folder: string): void {
    this.dialog.close();
    if (folder !== mission.folder) void fileMission(mission, folder);
  }
}
