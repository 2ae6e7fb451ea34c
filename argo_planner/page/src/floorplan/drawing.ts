/** The drawing of a floor as SVG, for the screen and for paper. */

import { svg } from "lit";

import type { FloorPlan, World } from "../api/types";
import { outlineData, short, type Point } from "../model/axonometry";
import { declutter, type LabelBox, type LabelRequest } from "../model/declutter";
import {
  boxOutline,
  floorData,
  floorNumber,
  inFrame,
  northTurn,
  scaleBar,
  type DrawingFrame,
  type FloorPaths,
  type StepPlace,
} from "../model/floor-drawing";
import { timeColour } from "../model/path-colours";
import { numbersText, sortedNumbers } from "../model/step-numbers";
import { t } from "../texts";
import { css, html, nothing } from "../ui/element";

export interface DrawnFloor {
  readonly site: World;
  readonly plan: FloorPlan;
  readonly frame: DrawingFrame;
  /** of this floor */
  readonly places: readonly StepPlace[];
  readonly paths: FloorPaths | null;
  /** Names of selected tasks. */
  readonly chosen: ReadonlySet<string>;
}

/** px */
const BADGE = 9;
const POINT = 4.5;
const FACE = 11;
const FONT = 11;
/** width of a letter, relative to the size of the font */
const LETTER = 0.58;
const BAR = 130;
/** Height of the strip with the scale bar and the compass below the floor. */
export const FOOT = 46;

export const drawingStyles = css`
  svg.floor {
    display: block;
    max-width: 100%;
    height: auto;
    background: var(--surface);
  }
  .floor path {
    stroke-linejoin: round;
  }
  .ground {
    fill: var(--sunken);
    stroke: none;
  }
  .deck {
    fill: var(--raised);
    stroke: color-mix(in srgb, var(--dim) 45%, var(--surface));
    stroke-width: 0.7;
  }
  .stair {
    fill: color-mix(in srgb, var(--accent) 18%, var(--surface));
    stroke: color-mix(in srgb, var(--accent) 50%, var(--line));
    stroke-width: 0.8;
  }
  .pump {
    fill: color-mix(in srgb, var(--good) 20%, var(--surface));
    stroke: color-mix(in srgb, var(--good) 50%, var(--line));
  }
  .vessel,
  .pipe {
    fill: color-mix(in srgb, var(--warn) 18%, var(--surface));
    stroke: color-mix(in srgb, var(--warn) 50%, var(--line));
  }
  .pipe {
    fill: color-mix(in srgb, var(--warn) 32%, var(--surface));
  }
  .structure,
  .railing {
    fill: var(--dim);
    stroke: var(--dim);
    stroke-width: 0.8;
  }
  .dock {
    fill: color-mix(in srgb, var(--accent) 45%, var(--surface));
    stroke: var(--accent);
  }
  .obstacle {
    fill: color-mix(in srgb, var(--bad) 30%, var(--surface));
    stroke: var(--bad);
    stroke-width: 1.5;
  }
  .way {
    fill: none;
    stroke-width: 2.2;
    stroke-linecap: round;
  }
  .arrow {
    stroke: none;
  }
  .other {
    fill: none;
    stroke: var(--dim);
    stroke-width: 1.2;
    stroke-dasharray: 4 4;
  }
  .checkpoint {
    fill: var(--surface);
    stroke: var(--dim);
    stroke-width: 1.5;
  }
  .checkpoint.planned {
    fill: var(--accent);
    stroke: var(--accent);
  }
  .face {
    stroke: var(--dim);
    stroke-width: 1.5;
  }
  .face.planned {
    stroke: var(--accent);
  }
  .place {
    fill: var(--surface);
    stroke: var(--text);
    stroke-width: 1.5;
  }
  .badge rect {
    fill: var(--text);
    stroke: var(--surface);
    stroke-width: 1.5;
  }
  .badge text {
    fill: var(--surface);
    font-weight: 700;
    text-anchor: middle;
  }
  .badge.chosen rect {
    fill: var(--accent);
  }
  .floor text {
    font-size: ${FONT}px;
    dominant-baseline: central;
  }
  .label {
    fill: var(--text);
    stroke: var(--surface);
    stroke-width: 3px;
    stroke-linejoin: round;
    paint-order: stroke;
  }
  .label.dim {
    fill: var(--dim);
  }
  .label.planned {
    font-weight: 600;
  }
  .leader {
    stroke: var(--dim);
    stroke-width: 0.8;
  }
  .north {
    fill: var(--bad);
    stroke: none;
  }
  .south {
    fill: var(--dim);
    stroke: none;
  }
  .bar {
    fill: none;
    stroke: var(--text);
    stroke-width: 1.6;
  }
  .legend {
    display: flex;
    flex-wrap: wrap;
    gap: 4px 16px;
    margin: 8px 0 0;
    font-size: 12px;
  }
  .legend li {
    display: inline-flex;
    align-items: center;
    gap: 6px;
  }
  .legend svg {
    flex: none;
  }
`;

/** Render the drawing of a floor. */
export function floorDrawing(drawn: DrawnFloor) {
  const { site, plan, frame, places } = drawn;
  const texts = t().floorplan;
  const tasks = numbersText(sortedNumbers(places.flatMap((place) => place.numbers)));
  const label = tasks === "" ? texts.drawingOf(plan.number) : texts.drawingWithTasks(plan.number, tasks);
  const height = frame.height + FOOT;
  const shown = svg`
    ${plan.shapes.map(({ role, outlines }) => svg`<path class=${role} d=${floorData(frame, outlines)} />`)}
    ${obstaclesOn(site, plan.number).map((one) => svg`<path class="obstacle" d=${floorData(frame, [boxOutline(one.pose, one.size)])} />`)}
    ${pathsView(drawn)} ${pointsView(drawn)} ${labelsView(drawn)} ${footView(site, frame)}`;
  return html`<svg
    class="floor"
    viewBox="0 0 ${short(frame.width)} ${short(height)}"
    width=${short(frame.width)}
    height=${short(height)}
    role="img"
    aria-label=${label}
  >
    ${shown}
  </svg>`;
}

function obstaclesOn(site: World, floor: number) {
  return site.obstacles.filter((one) => floorNumber(site.floors, one.pose.z) === floor);
}

function pathsView({ paths }: DrawnFloor) {
  if (paths === null) return nothing;
  const colour = (share: number) => `rgb(${timeColour(share).join(" ")})`;
  return svg`${paths.other === "" ? nothing : svg`<path class="other" d=${paths.other} />`}
    ${[...paths.timed].map(
      ([share, { line, arrows }]) => svg`<path class="way" d=${line} stroke=${colour(share)} />
        ${arrows === "" ? nothing : svg`<path class="arrow" d=${arrows} fill=${colour(share)} />`}`,
    )}`;
}

/** Render the points of checkpoints, docks and places. */
function pointsView({ site, plan, frame, places }: DrawnFloor) {
  const measured = new Set(places.map((place) => place.checkpoint?.id));
  const points = site.checkpoints
    .filter((one) => one.floor === plan.number)
    .map((one) => {
      const [x, y] = inFrame(frame, one.position[0], one.position[1]);
      const look = measured.has(one.id) ? "planned" : "";
      const [dx, dy] = [FACE * Math.cos(one.facing), -FACE * Math.sin(one.facing)];
      return svg`<line class="face ${look}" x1=${short(x)} y1=${short(y)} x2=${short(x + dx)} y2=${short(y + dy)} />
        <circle class="checkpoint ${look}" cx=${short(x)} cy=${short(y)} r=${POINT} />`;
    });
  const named = namedPoses(site, plan.number).map(({ pose }) => {
    const [x, y] = inFrame(frame, pose.x, pose.y);
    return svg`<path class="place" d=${outlineData([[[x - 5, y], [x, y - 5], [x + 5, y], [x, y + 5]]])} />`;
  });
  return svg`${points} ${named}`;
}

/** Return the docks and the named places of a floor. */
function namedPoses(site: World, floor: number) {
  const all = [
    ...site.docks.map(({ area, pose }) => ({ name: t().scene.dock(area), pose })),
    ...site.places.map(({ name, pose }) => ({ name, pose })),
  ];
  return all.filter(({ pose }) => floorNumber(site.floors, pose.z) === floor);
}

interface Label extends LabelRequest {
  readonly text: string;
  readonly look: string;
}

/** Render the numbers of tasks at their places, and names where there is room. */
function labelsView({ site, plan, frame, places, paths, chosen }: DrawnFloor) {
  const badges = places.map((place) => {
    const text = numbersText(place.numbers);
    const [x, y] = badgeAt(frame, place);
    const width = Math.max(2 * BADGE, widthOf(text) + 9);
    return { place, text, x, y, width };
  });
  const boxOf = (x: number, y: number, width: number, height: number): LabelBox => ({
    left: x - width / 2,
    top: y - height / 2,
    width,
    height,
  });
  const taken = badges.map(({ x, y, width }) => boxOf(x, y, width, 2 * BADGE));
  for (const outline of plan.shapes.find(({ role }) => role === "dock")?.outlines ?? []) {
    const corners = outline.map(([x, y]) => inFrame(frame, x, y));
    const [left, top] = [Math.min(...corners.map(([x]) => x)), Math.min(...corners.map(([, y]) => y))];
    const [right, bottom] = [Math.max(...corners.map(([x]) => x)), Math.max(...corners.map(([, y]) => y))];
    taken.push({ left, top, width: right - left, height: bottom - top });
  }
  const measured = new Set(places.map((place) => place.checkpoint?.id));
  const labels: Label[] = [];
  const add = (key: string, text: string, at: readonly [number, number], weight: number, look: string) => {
    const [x, y] = inFrame(frame, at[0], at[1]);
    labels.push({ key, text, look, x, y, weight, width: widthOf(text) + 2, height: FONT + 3 });
  };
  const numbers = new Map<string, string>();
  for (const one of site.checkpoints.filter(({ floor }) => floor === plan.number)) {
    const planned = measured.has(one.id);
    const at = [one.position[0], one.position[1]] as const;
    const [x, y] = inFrame(frame, ...at);
    taken.push(boxOf(x, y, 2 * POINT, 2 * POINT));
    numbers.set(`checkpoint ${one.id}`, `#${one.id}`);
    add(`checkpoint ${one.id}`, `#${one.id} ${one.name}`, at, planned ? 5 : 3, planned ? "planned" : "dim");
  }
  namedPoses(site, plan.number).forEach(({ name, pose }, at) => add(`pose ${at}`, name, [pose.x, pose.y], 4, ""));
  for (const { id, name, pose } of obstaclesOn(site, plan.number))
    add(`obstacle ${id}`, name === "" ? t().scene.obstacle : name, [pose.x, pose.y], 2, "");
  paths?.crossings.forEach(({ x, y, floor }, at) => add(`crossing ${at}`, t().floorplan.toFloor(floor), [x, y], 1, ""));
  const placed = declutter(labels, frame.width, frame.height, new Map(), Infinity, taken);
  // Checkpoints whose names have no room get their numbers at least.
  const there = new Set(placed.map(({ key }) => key));
  const shortened = labels
    .filter(({ key }) => numbers.has(key) && !there.has(key))
    .map((one) => ({ ...one, text: numbers.get(one.key) ?? "" }))
    .map((one) => ({ ...one, width: widthOf(one.text) + 2 }));
  const more = declutter(shortened, frame.width, frame.height, new Map(), Infinity, [...taken, ...placed]);
  const byKey = new Map([...labels, ...shortened].map((one) => [one.key, one]));
  return svg`${[...placed, ...more].map(({ key, left, top, height }) => {
    const { text, look } = byKey.get(key) as Label;
    return svg`<text class="label ${look}" x=${short(left + 1)} y=${short(top + height / 2)}>${text}</text>`;
  })}
    ${badges.map(({ place, text, x, y, width }) => {
      const [px, py] = inFrame(frame, place.x, place.y);
      const look = place.tasks.some((task) => chosen.has(task)) ? "badge chosen" : "badge";
      return svg`${place.checkpoint === null ? nothing : svg`<line class="leader" x1=${short(px)} y1=${short(py)} x2=${short(x)} y2=${short(y)} />`}
        <g class=${look}>
          <title>${place.tasks.join(", ")}</title>
          <rect x=${short(x - width / 2)} y=${short(y - BADGE)} width=${short(width)} height=${2 * BADGE} rx=${BADGE} />
          <text x=${short(x)} y=${short(y + 0.5)}>${text}</text>
        </g>`;
    })}`;
}

/** Return where the number of a place is drawn (px): behind the face of its checkpoint, or at the place itself. */
function badgeAt(frame: DrawingFrame, { x, y, checkpoint }: StepPlace): Point {
  const [px, py] = inFrame(frame, x, y);
  if (checkpoint === null) return [px, py];
  const away = POINT + BADGE + 6; // a name fits between the number and the next one
  const [bx, by] = [px - away * Math.cos(checkpoint.facing), py + away * Math.sin(checkpoint.facing)];
  const within = (value: number, most: number) => Math.min(Math.max(value, BADGE + 1), most - BADGE - 1);
  return [within(bx, frame.width), within(by, frame.height)];
}

function widthOf(text: string): number {
  return text.length * FONT * LETTER;
}

/** Render the scale bar and the compass. */
function footView(site: World, frame: DrawingFrame) {
  const { length, width } = scaleBar(frame, Math.min(BAR, frame.width / 3));
  const y = frame.height + FOOT - 10;
  const turn = northTurn(site.north);
  const [x, at] = [frame.width - 22, frame.height + FOOT / 2];
  const far = (turn * Math.PI) / 180;
  return svg`<path class="bar" d="M8 ${short(y - 6)}V${short(y)}H${short(8 + width)}V${short(y - 6)}" />
    <text class="label" x=${short(8 + width / 2)} y=${short(y - 12)} text-anchor="middle">${length} m</text>
    <g transform="translate(${short(x)} ${short(at)})">
      <g transform="rotate(${short(turn)})">
        <path class="north" d="M0-14L5 1H-5z" />
        <path class="south" d="M0 14L5 1H-5z" />
      </g>
      <text class="label" text-anchor="middle" x=${short(-14 * Math.cos(far) + 0)} y=${short(-8)}>${t().scene.north}</text>
    </g>`;
}

/** Render what the signs of the drawings mean; only those that occur in these floors. */
export function legend(floors: readonly DrawnFloor[]) {
  const texts = t().floorplan.legend;
  const roles = new Set(floors.flatMap(({ plan }) => plan.shapes.map((shape) => shape.role)));
  const has = (there: boolean, sign: unknown, text: string) =>
    there ? html`<li><svg width="26" height="16" viewBox="0 0 26 16" class="floor" aria-hidden="true">${sign}</svg>${text}</li>` : nothing;
  const area = (name: string) => svg`<rect class=${name} x="3" y="2" width="20" height="12" />`;
  const site = floors[0]?.site;
  const anyPlace = floors.some(({ places }) => places.length > 0);
  const timed = floors.some(({ paths }) => (paths?.timed.size ?? 0) > 0);
  const measured = floors.some(({ places }) => places.some(({ checkpoint }) => checkpoint !== null));
  const checkpoints = floors.some(({ plan }) => site?.checkpoints.some((one) => one.floor === plan.number) ?? false);
  return html`<ul class="legend" aria-label=${texts.title}>
    ${has(anyPlace, svg`<g class="badge"><rect x="4" y="0" width="18" height="16" rx="8" /><text x="13" y="8.500">3</text></g>`, texts.step)}
    ${has(measured, svg`<line class="face planned" x1="8" y1="8" x2="22" y2="8" /><circle class="checkpoint planned" cx="8" cy="8" r="4.500" />`, texts.planned)}
    ${has(checkpoints, svg`<line class="face" x1="8" y1="8" x2="22" y2="8" /><circle class="checkpoint" cx="8" cy="8" r="4.500" />`, texts.checkpoint)}
    ${timed
      ? html`<li>
          <svg width="60" height="16" viewBox="0 0 60 16" class="floor" aria-hidden="true">
            ${Array.from({ length: 12 }, (_, at) => svg`<rect x=${2 + at * 4.67} y="6" width="4.700" height="3" fill="rgb(${timeColour(at / 11).join(" ")})" />`)}
          </svg>
          ${texts.path}
        </li>`
      : nothing}
    ${has(floors.some(({ paths }) => (paths?.other ?? "") !== ""), svg`<path class="other" d="M2 8H24" />`, texts.other)}
    ${has(roles.has("deck"), area("deck"), texts.deck)} ${has(roles.has("ground"), area("ground"), texts.ground)}
    ${has(roles.has("stair"), area("stair"), texts.stair)} ${has(roles.has("vessel"), area("vessel"), texts.vessel)}
    ${has(roles.has("pipe"), area("pipe"), texts.pipe)} ${has(roles.has("pump"), area("pump"), texts.pump)}
    ${has(roles.has("structure") || roles.has("railing"), svg`<rect class="structure" x="3" y="4" width="7" height="7" /><path class="railing" d="M13 8H24" />`, texts.structure)}
    ${has(roles.has("dock"), area("dock"), texts.dock)}
    ${has(
      site !== undefined && floors.some(({ plan }) => namedPoses(site, plan.number).length > 0),
      svg`<path class="place" d="M8 8L13 3L18 8L13 13Z" />`,
      texts.place,
    )}
    ${has(site !== undefined && floors.some(({ plan }) => obstaclesOn(site, plan.number).length > 0), area("obstacle"), texts.obstacle)}
  </ul>`;
}
