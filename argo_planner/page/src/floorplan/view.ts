/** The view of floor plans and of the mission sheet, in place of the list, the site and the panels. */

import { isTyping } from "../frame/keys";
import { numbersText } from "../model/step-numbers";
import { readFloorPlans } from "../state/floor-plans";
import { showError } from "../state/notices";
import { mission } from "../state/plan";
import { numberOf, taskDetail, taskTitle } from "../state/task-labels";
import { world } from "../state/world";
import { t } from "../texts";
import { css, customElement, html, nothing, PageElement, query, state } from "../ui/element";
import { iconButton } from "../ui/controls";
import { icon } from "../ui/icons";
import { drawingStyles, floorDrawing, FOOT, legend } from "./drawing";
import { allFloors, drawnFloors } from "./floors";
import "./sheet";
import { places, planFloor, plansShown, visited } from "./state";

@customElement("argo-floor-plans")
export class FloorPlansView extends PageElement {
  static override styles = [
    drawingStyles,
    css`
      :host {
        display: grid;
        grid-template-rows: auto minmax(0, 1fr);
        min-height: 0;
        background: var(--ground);
      }
      .bar {
        display: flex;
        flex-wrap: wrap;
        align-items: center;
        gap: 8px;
        padding: 8px 12px;
        border-bottom: 1px solid var(--line);
        background: var(--surface);
      }
      .choice {
        display: flex;
        gap: 4px;
      }
      [aria-checked="true"] {
        border-color: var(--accent);
        background: var(--chosen);
        font-weight: 600;
      }
      .floors {
        display: flex;
        flex-wrap: wrap;
        align-items: center;
        gap: 4px;
      }
      .floors button {
        min-width: 34px;
        padding: 3px 8px;
      }
      .floors .visited::after {
        content: "";
        width: 7px;
        height: 7px;
        border-radius: 50%;
        background: var(--accent);
      }
      .body {
        min-height: 0;
        overflow: auto;
      }
      .plans {
        display: grid;
        grid-template-columns: minmax(0, 1fr) 320px;
        height: 100%;
      }
      .room {
        min-width: 0;
        min-height: 0;
        padding: 16px;
        overflow: auto;
      }
      .room svg {
        margin: 0 auto;
        background: none;
      }
      aside {
        padding: 14px;
        overflow: auto;
        border-left: 1px solid var(--line);
        background: var(--surface);
      }
      aside li {
        padding: 6px 0;
        border-bottom: 1px solid var(--line);
        overflow-wrap: anywhere;
      }
      aside .legend li {
        border: 0;
        padding: 0;
      }
      aside h2 {
        margin: 0 0 4px;
      }
      aside section {
        margin-bottom: 20px;
      }
      .legend {
        display: grid;
      }
      .step {
        display: grid;
        grid-template-columns: 38px minmax(0, 1fr);
      }
      .step b {
        font-size: 15px;
      }
      .said {
        color: var(--dim);
        font-size: 12px;
      }
      argo-mission-sheet {
        max-width: 794px;
        margin: 20px auto;
        padding: 44px 50px;
        box-shadow: var(--shadow);
      }
      @media (max-width: 900px) {
        .plans {
          grid-template-columns: minmax(0, 1fr);
          height: auto;
        }
        aside {
          border-left: 0;
          border-top: 1px solid var(--line);
        }
        .legend {
          display: flex;
        }
      }
      @media (max-width: 600px) {
        argo-mission-sheet {
          margin: 0;
          padding: 16px;
        }
      }
      @media print {
        :host,
        .body,
        .plans {
          display: block;
          height: auto;
          overflow: visible;
          background: none;
        }
        .bar {
          display: none;
        }
        .room,
        aside {
          padding: 0;
          overflow: visible;
          border: 0;
        }
        aside {
          margin-top: 16px;
        }
        argo-mission-sheet {
          max-width: none;
          margin: 0;
          padding: 0;
          box-shadow: none;
        }
      }
    `,
  ];

  @query(".room") private readonly room!: HTMLElement | null;
  /** px, the room of the drawing */
  @state() private size: readonly [number, number] = [900, 600];
  private readonly resized = new ResizeObserver(() => this.measure());

  constructor() {
    super();
    this.listen("keydown", this.onKey, true);
    // The list, which is hidden, would copy and paste tasks.
    this.listen("copy", stop, true);
    this.listen("paste", stop, true);
    this.watch(() => {
      const floors = plansShown.value === "sheet" ? visited.value : allFloors(world.value);
      readFloorPlans(floors).catch(showError);
    });
  }

  override connectedCallback(): void {
    super.connectedCallback();
    this.resized.observe(this);
  }

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    this.resized.disconnect();
  }

  override firstUpdated(): void {
    this.renderRoot.querySelector<HTMLElement>(`#${plansShown.value === "sheet" ? "sheet" : "plans"}`)?.focus();
  }

  override updated(): void {
    this.measure();
  }

  private measure(): void {
    const { room } = this;
    if (room === null || matchMedia("print").matches) return;
    const stacked = matchMedia("(max-width: 900px)").matches;
    const width = Math.max(280, room.clientWidth - 32);
    const height = Math.max(260, (stacked ? innerHeight * 0.7 : room.clientHeight - 32) - FOOT);
    if (this.size[0] !== width || this.size[1] !== height) this.size = [width, height];
  }

  override render() {
    const texts = t().floorplan;
    const sheet = plansShown.value === "sheet";
    return html`<div class="bar">
        <div class="choice" role="group" aria-label=${texts.show}>
          <button id="plans" aria-pressed=${!sheet} @click=${() => (plansShown.value = "plans")}>
            ${icon("plan", 16)} ${texts.plans}
          </button>
          <button id="sheet" aria-pressed=${sheet} @click=${() => (plansShown.value = "sheet")}>
            ${icon("script", 16)} ${texts.sheet}
          </button>
        </div>
        ${sheet ? nothing : this.floors()}
        <span class="grow"></span>
        <button class=${sheet ? "main" : ""} id="print" @click=${this.print}>${icon("print", 16)} ${texts.print}</button>
        ${iconButton("close", texts.close, close, { title: `${texts.close} (Esc)` })}
      </div>
      <div class="body" role="region" aria-label=${sheet ? texts.sheet : texts.plans} tabindex=${sheet ? 0 : -1}>
        ${sheet ? html`<argo-mission-sheet></argo-mission-sheet>` : this.plans()}
      </div>`;
  }

  /** Return the floor that is shown: the chosen one, or the first one that the mission visits. */
  private shown(): number | null {
    return planFloor.value ?? visited.value[0] ?? allFloors(world.value)[0] ?? null;
  }

  private floors() {
    const all = allFloors(world.value);
    const shown = this.shown();
    const counts = new Map<number, number>();
    for (const { floor, numbers } of places.value) counts.set(floor, (counts.get(floor) ?? 0) + numbers.length);
    return html`<div class="floors" role="radiogroup" aria-label=${t().floorplan.floors} @keydown=${this.onFloorKey}>
      <span class="dim">${t().floorplan.floors}</span>
      ${all.map((number) => {
        const label = t().floorplan.withTasks(number, counts.get(number) ?? 0);
        return html`<button
          role="radio"
          class=${visited.value.includes(number) ? "visited" : ""}
          aria-checked=${shown === number}
          aria-label=${label}
          title=${label}
          tabindex=${shown === number ? 0 : -1}
          @click=${() => (planFloor.value = number)}
        >
          ${number}
        </button>`;
      })}
    </div>`;
  }

  private plans() {
    const texts = t().floorplan;
    const number = this.shown();
    const drawn = number === null ? [] : drawnFloors([number], ...this.size);
    const [floor] = drawn;
    return html`<div class="plans">
      <div class="room">${floor ? floorDrawing(floor) : html`<p class="dim">${texts.loading}</p>`}</div>
      <aside tabindex="0" aria-label=${texts.tasksHere}>
        <section>
          <h2>${texts.tasksHere}</h2>
          ${number === null ? nothing : this.steps(this.tasksOn(number))}
        </section>
        ${this.withoutPlace()}
        <section>
          <h2>${texts.legend.title}</h2>
          ${floor ? legend(drawn) : nothing}
        </section>
      </aside>
    </div>`;
  }

  private tasksOn(floor: number): string[] {
    return places.value.filter((place) => place.floor === floor).flatMap((place) => place.tasks);
  }

  /** Render the tasks that are done wherever the robot is, such as waits. */
  private withoutPlace() {
    const placed = new Set(places.value.flatMap((place) => place.tasks));
    const others = (mission.value?.tasks ?? []).filter((task) => !placed.has(task.name)).map((task) => task.name);
    if (others.length === 0) return nothing;
    return html`<section>
      <h2>${t().floorplan.noPlace}</h2>
      ${this.steps(others)}
    </section>`;
  }

  /** Render tasks in the order of the list. */
  private steps(names: readonly string[]) {
    const tasks = mission.value?.tasks ?? [];
    const here = new Set(names);
    const inOrder = tasks.filter((task) => here.has(task.name));
    if (inOrder.length === 0) return html`<p class="dim">${t().floorplan.noTasksHere}</p>`;
    return html`<ol aria-label=${`${t().floorplan.tasksHere}: ${numbersText(inOrder.map((task) => numberOf(task.name)).filter(Boolean))}`}>
      ${inOrder.map(
        (task) =>
          html`<li class="step">
            <b>${numberOf(task.name)}</b>
            <div>${taskTitle(task)}<div class="said">${taskDetail(task)}</div></div>
          </li>`,
      )}
    </ol>`;
  }

  private readonly onKey = (event: KeyboardEvent): void => {
    if (event.defaultPrevented || isTyping(event) || inMenu(event)) return;
    const command = event.ctrlKey || event.metaKey || event.altKey;
    const step = { PageUp: 1, PageDown: -1 }[event.key];
    if (event.key === "Escape" || (event.key === "p" && !command)) close();
    else if (step !== undefined && plansShown.value === "plans") this.changeFloor(step);
    else {
      if (!command && ofHidden(event.key)) event.stopImmediatePropagation();
      return;
    }
    event.preventDefault();
    event.stopImmediatePropagation();
  };

  private onFloorKey(event: KeyboardEvent): void {
    const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (step === undefined) return;
    this.changeFloor(step);
    event.preventDefault();
    void this.updateComplete.then(() => this.renderRoot.querySelector<HTMLElement>("[aria-checked=true]")?.focus());
  }

  private changeFloor(step: number): void {
    const all = allFloors(world.value);
    const next = all[all.indexOf(this.shown() ?? 0) + step];
    if (next !== undefined) planFloor.value = next;
  }

  /** Print the mission sheet. */
  private async print(): Promise<void> {
    plansShown.value = "sheet";
    await readFloorPlans(visited.value).catch(showError);
    await this.updateComplete;
    print();
  }
}

function stop(event: Event): void {
  event.stopImmediatePropagation();
}

/** Return whether a key belongs to what is hidden: the list, the tools and the site. */
function ofHidden(key: string): boolean {
  return (key.length === 1 && key !== "?" && key !== " ") || ["Delete", "Backspace", "F2"].includes(key);
}

/** Return whether a key belongs to a menu, which the browser closes with Escape. */
function inMenu(event: KeyboardEvent): boolean {
  return event.composedPath().some((one) => one instanceof HTMLElement && one.matches(":popover-open"));
}

/** Close the view, and return to the list. */
function close(): void {
  plansShown.value = "off";
  setTimeout(() => dispatchEvent(new CustomEvent("focus-list")));
}
