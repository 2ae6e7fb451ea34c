/** The menu of what can be added, and a field in which a checkpoint or a location is typed. */

import type { Pose } from "../api/types";
import { showNotice } from "../state/notices";
import { mission } from "../state/plan";
import { mayPlan } from "../state/session";
import { panel, shownFloor, tool } from "../state/view";
import { world } from "../state/world";
import { t } from "../texts";
import { valueOf } from "../ui/controls";
import { css, customElement, html, nothing, PageElement, query, state } from "../ui/element";
import { icon, type Icon } from "../ui/icons";
import { addMeasures, addPlace, addReaction, addStart, addTask, addWait, isEmpty, lacksStart } from "./adding";
import { type Choice, checkpointChoices, floorChoices, matchingChoices, poseChoices, typedPose } from "./choices";

/** The number of choices that are shown; typing finds the others. */
const MOST = 60;

@customElement("argo-add")
export class AddTasks extends PageElement {
  static override styles = css`
    :host {
      position: relative;
    }
    .menu {
      position: absolute;
      z-index: 10;
      top: 34px;
      left: 0;
      display: grid;
      width: 270px;
      padding: 4px;
      border: 1px solid var(--line);
      border-radius: var(--round);
      background: var(--raised);
      box-shadow: var(--shadow);
    }
    .menu button {
      justify-content: start;
      text-align: left;
    }
    .menu kbd {
      margin-left: auto;
      color: var(--dim);
      font: inherit;
      font-size: 12px;
    }
    .added {
      padding: 4px 8px 0;
    }
    [role="listbox"] {
      max-height: 50vh;
      margin-top: 4px;
      overflow: auto;
    }
    [role="option"] {
      padding: 4px 8px;
      border-radius: 4px;
    }
    [role="option"][aria-selected="true"] {
      background: var(--chosen);
    }
  `;

  @state() private open: "" | "menu" | "measure" | "place" = "";
  @state() private text = "";
  @state() private at = 0;
  @query("input") private readonly field!: HTMLInputElement | null;
  /** The last added item since the field was opened. */
  @state() private added: string | null = null;
  /** Poses that were added since the field was opened; the mission may not contain them yet. */
  private placed: Pose[] = [];

  constructor() {
    super();
    this.listen("pointerdown", this.onOutside);
    this.listen("keydown", this.onEscape, true);
  }

  /** Close the field on Escape, wherever the focus is. */
  private readonly onEscape = (event: KeyboardEvent): void => {
    if (event.key !== "Escape" || this.open === "") return;
    this.close();
    event.preventDefault();
    event.stopImmediatePropagation();
  };

  private readonly onOutside = (event: Event): void => {
    if (this.open !== "" && !event.composedPath().includes(this)) this.open = "";
  };

  openMeasure(): void {
    void this.openField("measure");
  }

  addAtPlace(): void {
    void this.openField("place");
  }

  private async openField(which: "measure" | "place"): Promise<void> {
    if (world.value === null) return; // the site is being loaded: there is nothing to choose yet
    this.open = which;
    this.placed = [];
    this.added = null;
    this.text = "";
    this.at = 0;
    await this.updateComplete;
    this.field?.focus();
  }

  private close(): void {
    this.open = "";
    this.dispatchEvent(new CustomEvent("focus-list"));
  }

  private choices(): readonly Choice[] {
    // The added task is visible in the list, which the choices would cover.
    return this.added !== null && this.text === "" ? [] : this.allChoices().slice(0, MOST);
  }

  private allChoices(): readonly Choice[] {
    const site = world.value;
    if (site === null) return [];
    if (this.open === "measure") return matchingChoices([...checkpointChoices(site), ...floorChoices(site)], this.text);
    const typed = typedPose(site, this.text, shownFloor.value);
    const planned = (mission.value?.tasks ?? []).flatMap((task) => task.pose ?? []);
    return [...(typed ? [typed] : []), ...matchingChoices(poseChoices(site, [...planned, ...this.placed]), this.text)];
  }

  override render() {
    const texts = t().list;
    return html`<button
        ?disabled=${!mayPlan() || world.value === null}
        title=${mayPlan() ? "" : texts.mayNot}
        aria-haspopup="menu"
        aria-expanded=${this.open === "menu"}
        @click=${() => (this.open = this.open === "menu" ? "" : "menu")}
      >
        ${icon("add")} ${texts.add}
      </button>
      ${this.open === "menu" ? this.menu() : nothing}
      ${this.open === "measure" || this.open === "place" ? this.chooser() : nothing}`;
  }

  private menu() {
    const texts = t().list;
    const started = mission.value === null || !lacksStart(mission.value);
    const docks = world.value?.docks ?? [];
    return html`<div class="menu" role="menu" @keydown=${this.onMenuKey}>
      ${started
        ? nothing
        : docks.map(({ pose, area }) =>
            this.item("flag", texts.addStart(area), () => this.end(() => addStart(pose, area))),
          )}
      ${this.item("gauge", texts.addMeasure, () => this.openMeasure(), "m")}
      ${this.item("drive", texts.addWaypoint, () => this.end(() => (tool.value = "navigate")), "n")}
      ${this.item("flag", texts.addAtPlace, () => this.addAtPlace(), "w")}
      ${docks.map(({ pose, area }) =>
        this.item("back", texts.addReturn(area), () => this.end(() => addTask("WAYPOINT", "DOCK", { pose }))),
      )}
      ${this.item("wait", texts.addWait, () => this.end(addWait, true))}
      ${this.item("reaction", texts.addReaction, () => this.end(addReaction, true))}
    </div>`;
  }

  private item(sign: Icon, label: string, act: () => void, key?: string) {
    return html`<button role="menuitem" class="bare" @click=${act}>
      ${icon(sign)} ${label} ${key === undefined ? nothing : html`<kbd>${key}</kbd>`}
    </button>`;
  }

  private onMenuKey(event: KeyboardEvent): void {
    const items = [...this.renderRoot.querySelectorAll<HTMLElement>("[role=menuitem]")];
    const at = items.indexOf(event.target as HTMLElement);
    const move = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (move !== undefined) items[(at + move + items.length) % items.length]?.focus();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  private chooser() {
    const texts = t().list;
    const found = this.choices();
    const begins = mission.value !== null && isEmpty(mission.value);
    const label = this.open === "measure" ? texts.checkpoint : begins ? texts.startPlace : texts.place;
    return html`<div class="menu">
      <input
        role="combobox"
        aria-label=${label}
        placeholder=${label}
        aria-expanded="true"
        aria-controls="choices"
        aria-autocomplete="list"
        aria-activedescendant=${found.length > 0 ? `choice-${this.at}` : nothing}
        autocomplete="off"
        .value=${this.text}
        @input=${this.onInput}
        @keydown=${this.onFieldKey}
      />
      ${this.added === null ? nothing : html`<p class="dim added" role="status">${texts.added(this.added)}</p>`}
      <ul role="listbox" id="choices" aria-label=${label}>
        ${found.map(
          (choice, index) =>
            html`<li
              role="option"
              id=${`choice-${index}`}
              aria-selected=${index === this.at}
              @click=${() => this.choose(choice)}
            >
              ${choice.label} <span class="dim">${choice.detail}</span>
            </li>`,
        )}
      </ul>
      ${found.length === 0 && this.added === null ? html`<p class="dim" role="status">${texts.nothingFits}</p>` : nothing}
    </div>`;
  }

  private onInput(event: InputEvent): void {
    this.text = valueOf(event);
    this.at = 0;
  }

  private onFieldKey(event: KeyboardEvent): void {
    const found = this.choices();
    const move = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (move !== undefined) this.at = Math.max(0, Math.min(found.length - 1, this.at + move));
    else if (event.key === "Enter") {
      const choice = found[this.at];
      if (choice) this.choose(choice);
      else showNotice("warn", t().list.nothingFits);
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }

  /** Add the choice. The field stays open for the next one, until Escape or a click elsewhere. */
  private choose(choice: Choice): void {
    this.added = choice.label;
    this.text = "";
    this.at = 0;
    this.field?.focus();
    if (choice.checkpoint !== undefined) void addMeasures([choice.checkpoint]);
    else if (choice.checkpoints !== undefined) void addMeasures(choice.checkpoints);
    else if (choice.pose) {
      this.placed.push(choice.pose);
      void addPlace(choice.pose, isEmpty, choice.name);
    }
  }

  /** Close the menu and carry out the choice; `details`: the focus moves on to the details. */
  private end(act: () => unknown, details = false): void {
    this.close();
    if (details) panel.value = "properties";
    void act();
  }
}
