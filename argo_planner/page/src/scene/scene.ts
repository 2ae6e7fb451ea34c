/** The scene: floors, checkpoints, the mission and the robot. */

import { effect, signal } from "@preact/signals-core";

import { isTyping } from "../frame/keys";
import { nameOfKey } from "../model/outline";
import { showNotice } from "../state/notices";
import { select, selection } from "../state/plan";
import { hoveredLeg } from "../state/preview";
import { mayPlan } from "../state/session";
import { placingForm } from "../state/faults";
import { shownFloor, tool } from "../state/view";
import { world } from "../state/world";
import { t } from "../texts";
import { customElement, html, nothing, PageElement, query } from "../ui/element";
import { styled } from "../ui/styled";
import "./bar";
import { placeRobotText, placeGhostText } from "./overlay-texts";
import "./card";
import { colours } from "./colours";
import { clickFault, FaultsView, pointFault } from "./faults-view";
import "./compass";
import "./floors";
import { box } from "./ground-marks";
import { dependOn } from "../state/depend-on";
import { type Keyed, onSceneKey } from "./keys";
import { ghost, ghostWords, hideGhost, moveGhostToRay, placeGhost, setsStart, activateNavigation, turnGhost, verdictWords } from "./navigate";
import { clickCorner, corners, hideCorners, pointCorner, spannedBox } from "./obstacle-tool";
import "./obstacle-form";
import { type Frame, PointerWatch } from "./pointer";
import { edgesMove } from "./settings";
import { dispose } from "./stage";
import { sceneStyle } from "./style";
import { RobotView } from "./robot-view";
import { SceneView } from "./view";
import { selectTaskOfPath, type Mark, openMark } from "./marks";
import { PathsView } from "./paths-view";
import { RunPathsView } from "./run-paths";

/** px from an edge of the view within which the pointer moves the camera */
const EDGE_PX = 14;
const SAID_AFTER_MS = 350;
const MOST_TIMES = 500;

@customElement("argo-scene")
export class ScenePanel extends PageElement {
  static override styles = sceneStyle;

  @query("canvas") private readonly canvas!: HTMLCanvasElement;
  @query("#labels") private readonly labels!: HTMLElement;
  @query("#picture") private readonly picture!: HTMLElement;
  @query("#robot") private readonly robotSign!: HTMLElement | null;
  @query("#verdict") private readonly verdict!: HTMLElement | null;

  private readonly view = signal<SceneView | null>(null);
  private readonly broken = signal(false);
  /** The frame that is being drawn. */
  private readonly frame = signal<Frame | null>(null);
  private readonly announcement = signal("");
  private parts: { dispose(): void }[] = [];
  private stops: (() => void)[] = [];
  private saying: ReturnType<typeof setTimeout> | undefined;
  /** Whether the ghost was last moved by keys. */
  private keyed = false;
  /** The path under the pointer; a leg pointed at elsewhere is left alone. */
  private pointed: number | null = null;

  constructor() {
    super();
    this.listen("contextmenu", this.onMenu);
    this.listen("pointerdown", this.onElsewhere);
    this.listen("keydown", this.onEscape, true);
  }

  override connectedCallback(): void {
    super.connectedCallback();
    if (this.hasUpdated) this.begin();
  }

  override firstUpdated(): void {
    this.begin();
  }

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    clearTimeout(this.saying);
    for (const stop of this.stops) stop();
    for (const part of this.parts.reverse()) part.dispose();
    this.parts = [];
    this.stops = [];
    this.view.value = null;
    hideGhost();
    hideCorners();
    openMark.value = null;
  }

  private begin(): void {
    let view: SceneView;
    try {
      view = new SceneView(this.canvas, this.labels);
    } catch {
      this.broken.value = true; // no WebGL
      return;
    }
    const sizes = new ResizeObserver(() => view.resize(this.picture.clientWidth, this.picture.clientHeight));
    sizes.observe(this.picture);
    view.resize(this.picture.clientWidth, this.picture.clientHeight);
    const robot = new RobotView(view);
    const paths = new PathsView(view);
    this.parts = [
      view,
      robot,
      paths,
      new RunPathsView(view),
      new FaultsView(view),
      new PointerWatch(this.canvas, this.pointerHandlers(view, paths)),
      { dispose: () => sizes.disconnect() },
    ];
    this.stops = [
      effect(() => this.take(view)),
      effect(() => {
        if (tool.value !== "select") this.picture.focus({ preventScroll: true }); // its keys work at once
      }),
      effect(() => this.drawSpanned(view)),
      effect(() => this.announce()),
      effect(() => placeGhostText(view, this.verdict)),
      effect(() => placeRobotText(view, robot, this.robotSign)),
    ];
    this.view.value = view;
  }

  /** Set up the selected tool. */
  private take(view: SceneView): void {
    const now = tool.value;
    view.camera.wheel = now !== "navigate";
    if (now === "navigate" && world.value !== null) activateNavigation();
    if (now !== "select") openMark.value = null;
    if (now !== "navigate") hideGhost();
    if (now !== "obstacle") hideCorners();
  }

  /** Draw the box of the obstacle tool before it is added; return a function that removes it. */
  private drawSpanned(view: SceneView): () => void {
    const shown = spannedBox.value;
    const mesh = shown && box(shown.pose, shown.size, colours.value.warn, 0.55);
    if (mesh) view.stage.scene.add(mesh);
    view.stage.need();
    return () => {
      if (mesh) dispose(mesh);
    };
  }

  private pointerHandlers(view: SceneView, paths: PathsView) {
    return {
      pointed: (x: number, y: number) => {
        this.keyed = false;
        this.pushAtEdge(view, x, y);
        if (tool.value === "navigate") this.timed(view, () => moveGhostToRay(view.rayAt(x, y), view.site));
        else if (tool.value === "obstacle") pointCorner(view.site.hitWays(view.rayAt(x, y)));
        else if (tool.value === "fault") pointFault(view, x, y);
        else this.pointAt(view.markAt(x, y), paths.wayAt(x, y));
      },
      left: () => {
        view.camera.edge(0, 0);
        if (!this.keyed) hideGhost();
      },
      clicked: (x: number, y: number, add: boolean) => {
        this.picture.focus({ preventScroll: true });
        if (tool.value !== "select" && !mayPlan()) showNotice("warn", t().scene.mayNot);
        else if (tool.value === "navigate") {
          moveGhostToRay(view.rayAt(x, y), view.site);
          this.place();
        } else if (tool.value === "obstacle") clickCorner(view.site.hitWays(view.rayAt(x, y)));
        else if (tool.value === "fault") clickFault(view, x, y);
        else {
          const mark = view.markAt(x, y);
          const way = mark === null ? paths.wayAt(x, y) : null;
          if (way === null) view.choose(mark, add);
          else selectTaskOfPath(way, add);
        }
      },
      mayFrame: () => tool.value === "select",
      framed: (frame: Frame, done: boolean) => {
        this.frame.value = done ? null : frame;
        if (done) select(view.tasksIn(frame));
      },
      clickedRight: () => (tool.value = "select"),
      wheeled: (steps: number) => {
        if (tool.value !== "navigate") return false;
        turnGhost(-steps);
        return true;
      },
    };
  }

  private pointAt(mark: Mark | null, way: number | null): void {
    this.canvas.classList.toggle("over", mark !== null || way !== null);
    const meant = mark === null ? way : null;
    if (meant !== this.pointed) hoveredLeg.value = meant;
    this.pointed = meant;
  }

  /** Record how long a verdict takes, for measurements. */
  private timed(view: SceneView, work: () => void): void {
    const begun = performance.now();
    work();
    dependOn(ghost);
    view.hoverTimes = [...view.hoverTimes.slice(-MOST_TIMES), performance.now() - begun];
  }

  private pushAtEdge(view: SceneView, x: number, y: number): void {
    const { width, height } = view.stage.size;
    const side = (at: number, all: number) => (at < EDGE_PX ? -1 : at > all - EDGE_PX ? 1 : 0);
    if (edgesMove.value) view.camera.edge(side(x, width), side(y, height));
  }

  private place(): void {
    void placeGhost().then((placed) => {
      const name = nameOfKey(selection.value.at(-1) ?? "");
      this.announcement.value = placed ? t().scene.placed(name) : `${verdictWords(ghost.value)} `;
    });
  }

  /** Close the card on a click elsewhere; `onEscape` closes it by key. */
  private readonly onElsewhere = (event: Event): void => {
    if (!event.composedPath().includes(this)) openMark.value = null;
  };

  private readonly onEscape = (event: KeyboardEvent): void => {
    if (event.key !== "Escape" || openMark.value === null || isTyping(event)) return;
    openMark.value = null;
    event.preventDefault();
    event.stopImmediatePropagation();
  };

  private readonly onMenu = (event: MouseEvent): void => {
    const inList = event.composedPath().some((one) => one instanceof HTMLElement && one.localName === "argo-list");
    if (!inList || tool.value === "select") return;
    tool.value = "select";
    event.preventDefault();
  };

  private readonly onKey = (event: KeyboardEvent): void => {
    const view = this.view.value;
    if (view === null || event.defaultPrevented) return;
    const keyed: Keyed = { view, place: () => this.place() };
    if (!onSceneKey(event, keyed)) return;
    this.keyed = true;
    event.preventDefault();
    event.stopPropagation();
  };

  /** Announce the verdict on the ghost once it rests. */
  private announce(): void {
    const at = ghost.value;
    clearTimeout(this.saying);
    if (at === null) return;
    const words = `${verdictWords(at)}. ${ghostWords(at)}`;
    this.saying = setTimeout(() => (this.announcement.value = words), SAID_AFTER_MS);
  }

  private frameView() {
    const frame = this.frame.value;
    if (frame === null) return nothing;
    const { left, top, right, bottom } = frame;
    const place = { left: `${left}px`, top: `${top}px`, width: `${right - left}px`, height: `${bottom - top}px` };
    return html`<div id="frame" aria-hidden="true" ${styled(place)}></div>`;
  }

  override render() {
    const texts = t().scene;
    const view = this.view.value;
    if (this.broken.value) return html`<p class="nothing" role="status">${texts.noPicture}</p>`;
    const loading = view?.loading.value ?? "loading";
    const navigates = tool.value === "navigate";
    return html`
      <div
        id="picture"
        role="application"
        tabindex="0"
        aria-label=${texts.site}
        aria-describedby="help"
        @keydown=${this.onKey}
        @keyup=${(event: KeyboardEvent) => view?.camera.key(event.key, false, event.shiftKey)}
        @blur=${() => view?.camera.letGo()}
      >
        <canvas class=${tool.value}></canvas>
        <div id="labels" aria-hidden="true"></div>
        ${this.frameView()}
        <div id="robot" aria-hidden="true" hidden></div>
        <div id="verdict" aria-hidden="true" hidden></div>
      </div>
      <p id="help" class="unseen">
        ${navigates ? texts.helpNavigate : tool.value === "obstacle" ? texts.helpObstacle : texts.help}
      </p>
      <p class="unseen" aria-live="polite" id="said">${this.announcement.value}</p>
      ${loading === "there"
        ? nothing
        : html`<p class="loading" role="status">${loading === "failed" ? texts.notLoaded : texts.loading}</p>`}
      ${view === null
        ? nothing
        : html`<argo-scene-floors .view=${view}></argo-scene-floors>
            <argo-scene-bar .view=${view}></argo-scene-bar>
            <argo-scene-compass .view=${view}></argo-scene-compass>
            <argo-scene-card .view=${view}></argo-scene-card>`}
      ${navigates ? html`<p class="hint">${setsStart.value ? texts.hintStart : texts.hintWaypoint}</p>` : nothing}
      ${tool.value === "obstacle" && (corners.value?.second ?? null) === null
        ? html`<p class="hint">${texts.hintObstacle}</p>`
        : nothing}
      ${placingForm.value === null ? nothing : html`<p class="hint">${t().faults.hints[placingForm.value]}</p>`}
      ${tool.value === "obstacle" ? html`<argo-obstacle-form></argo-obstacle-form>` : nothing}
      <span class="unseen" id="floor">${shownFloor.value === null ? texts.allFloors : texts.floor(shownFloor.value)}</span>
    `;
  }
}
