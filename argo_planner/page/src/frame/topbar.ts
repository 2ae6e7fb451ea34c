/** The bar at the top: the mission's name, undo and redo, whoever else is there, settings. */

import { answered, client } from "../api/client";
import { isUnderWay, shownMode } from "../model/run-mode";
import { tellError } from "../state/notices";
import { redo, undo, waiting } from "../state/commands";
import { connected, others, planId, planName, redoable, undoable } from "../state/plan";
import { ask, asking } from "../state/asking";
import { run, runIsOn } from "../state/run";
import { author, mayOperate, mayPlan, service, theme } from "../state/session";
import { panel } from "../state/view";
import { modeWords } from "../run/mode-words";
import { language, t } from "../texts";
import { css, customElement, html, look, nothing, PageElement, state } from "../ui/element";
import { icon } from "../ui/icons";
import { closed, closeLeft } from "../ui/popover";
import { keysShown } from "./keys";
import "./mission-menu";

@customElement("argo-topbar")
export class PageTopbar extends PageElement {
  static override styles = [
    look,
    css`
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
        margin: 0;
        padding: 0;
        list-style: none;
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
      .run {
        gap: 0;
        border: 1px solid var(--line);
        border-left: 4px solid var(--accent);
        border-radius: 6px;
        font-size: 13px;
      }
      .run.supervised {
        border-left-color: var(--person);
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
      [popover] {
        position: fixed;
        inset: 48px 8px auto auto;
        width: 260px;
        margin: 0;
        padding: 12px;
        border: 1px solid var(--line);
        border-radius: var(--round);
        background: var(--raised);
        color: var(--text);
        box-shadow: var(--shadow);
      }
      label {
        display: grid;
        gap: 2px;
        margin-bottom: 8px;
      }
      @media (max-width: 800px) {
        .planning {
          display: none;
        }
      }
    `,
  ];

  @state() private renaming = false;

  override render() {
    const texts = t().frame;
    const open = planId.value !== null;
    return html`<header>
      ${open
        ? html`<button
              class="bare icon"
              aria-label=${texts.allMissions}
              title=${texts.allMissions}
              @click=${() => (location.hash = "")}
            >
              ${icon("back")}
            </button>
            ${this.name()}
            <span class="row planning">
              <button
                class="bare icon"
                aria-label=${texts.undo}
                title=${`${texts.undo} (Ctrl+Z)`}
                ?disabled=${undoable.value.length === 0 || !mayPlan()}
                @click=${undo}
              >
                ${icon("undo")}
              </button>
              <button
                class="bare icon"
                aria-label=${texts.redo}
                title=${`${texts.redo} (Ctrl+Y)`}
                ?disabled=${redoable.value.length === 0 || !mayPlan()}
                @click=${redo}
              >
                ${icon("redo")}
              </button>
              <argo-mission-menu></argo-mission-menu>
            </span>
            ${this.saved()}`
        : html`<h1>Argo</h1>
            <span class="dim">${service.value?.site ?? ""}</span>
            ${waiting.value > 0 ? this.saved() : nothing}`}
      <span class="grow"></span>
      ${this.run()} ${others.value.length > 0 ? this.people() : nothing}
      <button
        class="bare icon planning"
        aria-label=${texts.keysTitle}
        title=${`${texts.keysTitle} (?)`}
        @click=${() => (keysShown.value = true)}
      >
        ${icon("keys")}
      </button>
      <button
        class="bare icon"
        aria-label=${texts.otherTheme[theme.value]}
        title=${texts.otherTheme[theme.value]}
        @click=${() => (theme.value = theme.value === "dark" ? "light" : "dark")}
      >
        ${icon(theme.value === "dark" ? "sun" : "moon")}
      </button>
      <button
        class="bare icon"
        aria-label=${texts.settings}
        title=${texts.settings}
        popovertarget="settings"
      >
        ${icon("settings")}
      </button>
      ${this.settings()}
    </header>`;
  }

  /** What the robot does, wherever one is: it can be halted from there. */
  private run() {
    const state = run.value;
    if (state === null || !runIsOn.value) return nothing;
    const mode = shownMode(state);
    const texts = t().run;
    const show = () => {
      if (planId.value === null) location.hash = `#/missions/${state.plan}`;
      panel.value = "run";
    };
    const drives = state.status === "running" && state.mode !== "paused" && state.mode !== "supervised";
    return html`<span class="row run ${mode}">
      <button class="bare" title=${state.name} @click=${show}>${modeWords(state)}</button>
      ${drives && mayOperate()
        ? html`<button
            class="bare icon"
            aria-label=${texts.pauseRobot}
            title=${texts.pauseRobot}
            ?disabled=${asking.value.includes("pause") || isUnderWay(state, "pause")}
            @click=${() => ask({ kind: "pause" })}
          >
            ${icon("pause")}
          </button>`
        : nothing}
    </span>`;
  }

  /** Whether all that was done is on the service's disk. */
  private saved() {
    const texts = t().frame;
    const away = !connected.value;
    const said = away ? texts.away(waiting.value) : waiting.value > 0 ? texts.saving : texts.saved;
    return html`<span class=${away ? "state away" : "state dim"} role="status">${said}</span>`;
  }

  private name() {
    const texts = t().frame;
    if (!this.renaming)
      return html`<button
        class="bare name"
        title=${texts.rename}
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
    event.preventDefault(); // else it presses the button that takes the focus
    field.blur();
    void this.updateComplete.then(() => this.renderRoot.querySelector<HTMLElement>("button.name")?.focus());
  }

  private async rename(event: Event): Promise<void> {
    this.renaming = false;
    const name = (event.target as HTMLInputElement).value.trim();
    const id = planId.value;
    if (id === null || name === "" || name === planName.value) return;
    try {
      await answered(
        client.PUT("/api/missions/{id}/name", { params: { path: { id } }, body: { name } }),
      );
      if (planId.value === id) planName.value = name;
    } catch (error) {
      tellError(error);
    }
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

  private settings() {
    const texts = t().frame;
    return html`<div id="settings" popover @focusout=${closeLeft} @toggle=${closed}>
      <label>
        ${texts.yourName}
        <input
          maxlength="100"
          .value=${author.value}
          placeholder=${texts.somebody}
          @change=${(event: Event) => (author.value = (event.target as HTMLInputElement).value.trim())}
        />
      </label>
      <label>
        ${texts.language}
        <select
          .value=${language.value}
          @change=${(event: Event) =>
            (language.value = (event.target as HTMLSelectElement).value === "de" ? "de" : "en")}
        >
          <option value="en" ?selected=${language.value === "en"}>English</option>
          <option value="de" ?selected=${language.value === "de"}>Deutsch</option>
        </select>
      </label>
      <p class="dim">
        ${service.value ? texts.version(service.value.argo, texts.roles[service.value.role]) : ""}
      </p>
    </div>`;
  }
}

function initials(name: string): string {
  const words = name.trim().split(/\s+/);
  return words
    .slice(0, 2)
    .map((word) => String.fromCodePoint(word.codePointAt(0) ?? 32).toUpperCase())
    .join("");
}
