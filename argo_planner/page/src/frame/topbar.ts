/** The top bar: name of the mission, undo and redo, other people, the robot's state, settings. */

import { responseData, client } from "../api/client";
import { openedDraft } from "../draft/state";
import { withErrorNotice } from "../state/notices";
import { redo, undo, waiting } from "../state/commands";
import { connected, others, planId, planName, redoable, undoable } from "../state/plan";
import { mayPlan, service, theme } from "../state/session";
import { listShown } from "../state/view";
import { t } from "../texts";
import { iconButton, valueOf } from "../ui/controls";
import { css, customElement, html, nothing, PageElement, state } from "../ui/element";
import { keysShown } from "./keys";
import "./mission-menu";
import "./run-badge";
import "./settings";

@customElement("argo-topbar")
export class PageTopbar extends PageElement {
  static override styles = css`
    header {
      display: flex;
      flex-wrap: wrap;
      align-items: center;
      gap: 6px;
      min-height: 46px;
      padding: 4px 10px;
      border-bottom: 1px solid var(--line);
      background: var(--surface);
    }
    .name {
      max-width: 36vw;
      overflow: hidden;
      text-overflow: ellipsis;
      white-space: nowrap;
      font-size: 16px;
      font-weight: 600;
    }
    input.name {
      width: 320px;
    }
    .people {
      display: flex;
      gap: 3px;
    }
    .people li {
      display: grid;
      place-content: center;
      width: 28px;
      height: 28px;
      border-radius: 50%;
      background: var(--person-ground);
      color: var(--person);
      font-weight: 600;
      font-size: 12px;
    }
    .state {
      padding: 2px 8px;
      border-radius: 10px;
      font-size: 12px;
    }
    .state.away {
      background: var(--warn-ground);
      color: var(--warn);
    }
    button.name {
      min-width: 0;
    }
    .list {
      display: none;
    }
    @media (max-width: 719px) {
      header {
        gap: 2px;
        padding: 4px;
      }
      .list {
        display: inline-flex;
      }
      .name {
        flex: 1 1 90px;
        max-width: none;
        text-align: left;
      }
    }
  `;

  @state() private renaming = false;

  override render() {
    const texts = t().frame;
    const open = planId.value !== null;
    return html`<header>
      ${open
        ? html`${iconButton("back", texts.allMissions, () => (location.hash = ""))}
            ${iconButton("group", t().list.tasks, toggleList, { look: "bare list", expanded: listShown.value })}
            ${this.name()}
            <span class="row">
              ${iconButton("undo", texts.undo, undo, {
                title: `${texts.undo} (Ctrl+Z)`,
                disabled: undoable.value.length === 0 || !mayPlan(),
              })}
              ${iconButton("redo", texts.redo, redo, {
                title: `${texts.redo} (Ctrl+Y)`,
                disabled: redoable.value.length === 0 || !mayPlan(),
              })}
              <argo-mission-menu></argo-mission-menu>
            </span>
            ${this.saved()}`
        : openedDraft.value !== null
          ? html`${iconButton("back", texts.allMissions, () => (location.hash = ""))}
              <span class="name">${openedDraft.value.name}</span>`
          : html`<h1>Argo</h1>
            <span class="dim">${service.value?.site ?? ""}</span>
            ${waiting.value > 0 ? this.saved() : nothing}`}
      <span class="grow"></span>
      <argo-run-badge></argo-run-badge>
      ${others.value.length > 0 ? this.people() : nothing}
      <span class="row">${iconButton("keys", texts.keysTitle, () => (keysShown.value = true), {
        title: `${texts.keysTitle} (?)`,
      })}
      ${iconButton(
        theme.value === "dark" ? "sun" : "moon",
        texts.otherTheme[theme.value],
        () => (theme.value = theme.value === "dark" ? "light" : "dark"),
      )}
      <argo-settings></argo-settings></span>
    </header>`;
  }

  /** Render whether all edits are stored by the service. */
  private saved() {
    const texts = t().frame;
    const away = !connected.value;
    const text = away ? texts.away(waiting.value) : waiting.value > 0 ? texts.saving : texts.saved;
    return html`<span class=${away ? "state away" : "state dim"} role="status">${text}</span>`;
  }

  private name() {
    const texts = t().frame;
    if (!this.renaming)
      return html`<button
        class="bare name"
        title=${`${planName.value} – ${texts.rename}`}
        ?disabled=${!mayPlan()}
        @click=${this.beginRenaming}
      >
        ${planName.value}
      </button>`;
    return html`<input
      class="name"
      aria-label=${texts.rename}
      maxlength="200"
      .value=${planName.value}
      @keydown=${this.onNameKey}
      @blur=${this.rename}
    />`;
  }

  private async beginRenaming(): Promise<void> {
    this.renaming = true;
    await this.updateComplete;
    this.renderRoot.querySelector("input")?.select();
  }

  private onNameKey(event: KeyboardEvent): void {
    const field = event.target as HTMLInputElement;
    if (event.key === "Escape") field.value = planName.value;
    if (event.key !== "Enter" && event.key !== "Escape") return;
    event.preventDefault(); // otherwise Enter presses the button that gets the focus
    field.blur();
    void this.updateComplete.then(() => this.renderRoot.querySelector<HTMLElement>("button.name")?.focus());
  }

  private async rename(event: Event): Promise<void> {
    this.renaming = false;
    const name = valueOf(event).trim();
    const id = planId.value;
    if (id === null || name === "" || name === planName.value) return;
    await withErrorNotice(async () => {
      await responseData(
        client.PUT("/api/missions/{id}/name", { params: { path: { id } }, body: { name } }),
      );
      if (planId.value === id) planName.value = name;
    });
  }

  private people() {
    const names = [...new Set(others.value.map((member) => member.author))];
    return html`<ul class="people" aria-label=${t().frame.alsoThere}>
      ${names
        .slice(0, 6)
        .map(
          (name) =>
            html`<li title=${name}>
              <span aria-hidden="true">${initials(name)}</span><span class="unseen">${name}</span>
            </li>`,
        )}
      ${names.length > 6 ? html`<li>+${names.length - 6}</li>` : nothing}
    </ul>`;
  }
}

/** Open or close the list, where it is a drawer. */
function toggleList(): void {
  listShown.value = !listShown.value;
  // The list becomes visible with the next rendering.
  if (listShown.value) setTimeout(() => dispatchEvent(new CustomEvent("focus-list")));
}

function initials(name: string): string {
  const words = name.trim().split(/\s+/);
  return words
    .slice(0, 2)
    .map((word) => String.fromCodePoint(word.codePointAt(0) ?? 32).toUpperCase())
    .join("");
}
