/** Adding tasks: a menu, and a field in which a checkpoint or a place is typed. */

import type { Action, Mission, Pose, Reaction, Task } from "../api/types";
import { freeName, numberedName, taskNames } from "../model/naming";
import { outline, reactionKey, taskKey } from "../model/outline";
import { placeForNew } from "../model/places";
import { tell } from "../state/notices";
import { edit, inTurn } from "../state/commands";
import { mission, select, selection } from "../state/plan";
import { mayPlan } from "../state/session";
import { panel, shownFloor, tool } from "../state/view";
import { world } from "../state/world";
import { t } from "../texts";
import { css, customElement, html, look, nothing, PageElement, query, state } from "../ui/element";
import { icon } from "../ui/icons";
import { type Choice, checkpointChoices, matching, placeChoices, typedPlace } from "./choices";

interface NewTask {
  readonly action: Action;
  /** What it is to be called; another name is taken where there is such a task. */
  readonly wanted: string;
  readonly fields: Partial<Task>;
}

/** Adds a task behind what is selected, and selects it. Whether it was added. */
export function addTask(action: Action, wanted: string, fields: Partial<Task>): Promise<boolean> {
  return added(() => ({ action, wanted, fields }));
}

/** Adds a waypoint, or in a mission that begins nowhere yet its start. */
export function addPlace(pose: Pose, name?: string): Promise<boolean> {
  return added((open) => {
    const action = open.tasks.some((task) => task.action === "START") ? "WAYPOINT" : "START";
    const wanted = action === "WAYPOINT" && name !== undefined ? name : action;
    return { action, wanted, fields: { pose } };
  });
}

/** Adds what is to be added to the mission as it is when its turn comes. */
function added(find: (open: Mission) => NewTask): Promise<boolean> {
  return inTurn(async (make) => {
    const open = mission.value;
    if (open === null) return false;
    const { action, wanted, fields } = find(open);
    const names = taskNames(open);
    const start = action === "START";
    const numbered = wanted === action && !start;
    const name = numbered ? numberedName(wanted, names) : freeName(wanted, names);
    const where = start ? { first: true } : placeForNew(outline(open), selection.value);
    const done = await make({ kind: "add_task", task: { name, action, ...fields }, ...where });
    if (done) select([taskKey(name)]);
    return done;
  });
}

/** Adds the measuring of a checkpoint. */
export function addMeasure(id: string): Promise<boolean> {
  return addTask("MEASURE", `MEASURE ${id}`, { object_id: id });
}

@customElement("argo-add")
export class AddTasks extends PageElement {
  static override styles = [
    look,
    css`
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
      }
      .menu kbd {
        margin-left: auto;
        color: var(--dim);
        font: inherit;
        font-size: 12px;
      }
      [role="listbox"] {
        max-height: 50vh;
        margin: 4px 0 0;
        padding: 0;
        overflow: auto;
        list-style: none;
      }
      [role="option"] {
        padding: 4px 8px;
        border-radius: 4px;
      }
      [role="option"][aria-selected="true"] {
        background: var(--chosen);
      }
    `,
  ];

  @state() private open: "" | "menu" | "measure" | "place" = "";
  @state() private text = "";
  @state() private at = 0;
  @query("input") private readonly field!: HTMLInputElement | null;

  override connectedCallback(): void {
    super.connectedCallback();
    addEventListener("pointerdown", this.onOutside);
  }

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    removeEventListener("pointerdown", this.onOutside);
  }

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
    if (world.value === null) return; // the site is being read: there is nothing to choose from yet
    this.open = which;
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
    const site = world.value;
    if (site === null) return [];
    if (this.open === "measure") return matching(checkpointChoices(site), this.text);
    const typed = typedPlace(site, this.text, shownFloor.value);
    return [...(typed ? [typed] : []), ...matching(placeChoices(site), this.text)];
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
    const started = mission.value?.tasks.some((task) => task.action === "START") ?? true;
    return html`<div class="menu" role="menu" @keydown=${this.onMenuKey}>
      ${started
        ? nothing
        : world.value?.docks.map(
            (dock) =>
              html`<button
                role="menuitem"
                class="bare"
                @click=${() => this.addStart(dock.pose, dock.area)}
              >
                ${icon("flag")} ${texts.addStart} (${texts.dock(dock.area)})
              </button>`,
          )}
      <button role="menuitem" class="bare" @click=${() => this.openMeasure()}>
        ${icon("gauge")} ${texts.addMeasure} <kbd>m</kbd>
      </button>
      <button role="menuitem" class="bare" @click=${() => this.navigate()}>
        ${icon("drive")} ${texts.addWaypoint} <kbd>n</kbd>
      </button>
      <button role="menuitem" class="bare" @click=${() => this.addAtPlace()}>
        ${icon("flag")} ${texts.addAtPlace} <kbd>w</kbd>
      </button>
      <button role="menuitem" class="bare" @click=${() => this.addWait()}>
        ${icon("wait")} ${texts.addWait}
      </button>
      <button role="menuitem" class="bare" @click=${() => this.addReaction()}>
        ${icon("reaction")} ${texts.addReaction}
      </button>
    </div>`;
  }

  private onMenuKey(event: KeyboardEvent): void {
    const items = [...this.renderRoot.querySelectorAll<HTMLElement>("[role=menuitem]")];
    const at = items.indexOf(event.target as HTMLElement);
    const move = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (event.key === "Escape") this.close();
    else if (move !== undefined) items[(at + move + items.length) % items.length]?.focus();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  private chooser() {
    const texts = t().list;
    const found = this.choices();
    const label = this.open === "measure" ? texts.checkpoint : texts.place;
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
      <ul role="listbox" id="choices" aria-label=${label}>
        ${found.slice(0, 60).map(
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
      ${found.length === 0 ? html`<p class="dim" role="status">${texts.nothingFits}</p>` : nothing}
    </div>`;
  }

  private onInput(event: InputEvent): void {
    this.text = (event.target as HTMLInputElement).value;
    this.at = 0;
  }

  private onFieldKey(event: KeyboardEvent): void {
    const found = this.choices();
    const move = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (event.key === "Escape") this.close();
    else if (move !== undefined) this.at = Math.max(0, Math.min(found.length - 1, this.at + move));
    else if (event.key === "Enter") {
      const choice = found[this.at];
      if (choice) this.choose(choice);
      else tell("warn", t().list.nothingFits);
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }

  private choose(choice: Choice): void {
    this.close();
    if (choice.checkpoint !== undefined) void addMeasure(choice.checkpoint);
    else if (choice.pose) void addPlace(choice.pose, choice.name);
  }

  private addStart(pose: Pose, area: number): void {
    this.close();
    void addTask("START", "START", { pose }).then(
      (done) => done && edit({ kind: "set_header", start_area: area, dock: pose }),
    );
  }

  private addWait(): void {
    this.close();
    panel.value = "properties";
    void addTask("WAIT", "WAIT", { wait: { duration: 60, conditions: [] } });
  }

  private navigate(): void {
    this.close();
    tool.value = "navigate";
  }

  /** A reaction to the first event that has none yet; the form is for choosing another one. */
  private addReaction(): void {
    this.close();
    const had = new Set(mission.value?.reactions.map((one) => one.event));
    const events = Object.keys(t().words.event) as Reaction["event"][];
    const event = events.find((one) => !had.has(one));
    if (event === undefined) return;
    panel.value = "properties";
    const reaction = { event, response: "pause" };
    void edit({ kind: "add_reaction", reaction }).then((done) => done && select([reactionKey(event)]));
  }
}
