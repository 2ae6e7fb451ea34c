/** The picture of the site: its floors drawn apart, with the checkpoints. */

import { svg } from "lit";

import type { FloorPlan, World } from "../api/types";
import { nearness, outlineData, projected, short, silhouette, type Point } from "../model/axonometry";
import { floorPlans, readFloorPlans } from "../state/floor-plans";
import { showError } from "../state/notices";
import { world } from "../state/world";
import { t } from "../texts";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { pointedMission } from "./state";

/** Roles that are drawn flat on the floor, the lower ones first. */
const FLAT = ["ground", "deck", "stair", "pipe"] as const;
/** Roles that are drawn as bodies, with their heights relative to the storey. */
const BODIES: Readonly<Record<string, number>> = { vessel: 0.7, pump: 0.3, dock: 0.4, structure: 1 };
/** m around the site, and for the names of floors */
const MARGIN = 0.4;
const NAME = 5.8;

@customElement("argo-site-picture")
export class SitePicture extends PageElement {
  static override styles = css`
    figure {
      margin: 0;
    }
    svg {
      display: block;
      width: 100%;
      max-height: 380px;
    }
    path {
      stroke-width: 0.05;
      stroke-linejoin: round;
    }
    .ground {
      fill: color-mix(in srgb, var(--sunken) 70%, transparent);
      stroke: var(--line);
    }
    .deck {
      fill: color-mix(in srgb, var(--surface) 88%, transparent);
      stroke: color-mix(in srgb, var(--dim) 60%, var(--line));
    }
    .stair {
      fill: color-mix(in srgb, var(--accent) 22%, var(--surface));
      stroke: color-mix(in srgb, var(--accent) 55%, var(--line));
    }
    .pipe {
      fill: color-mix(in srgb, var(--warn) 30%, var(--surface));
      stroke: color-mix(in srgb, var(--warn) 60%, var(--line));
    }
    .vessel {
      fill: color-mix(in srgb, var(--warn) 16%, var(--surface));
      stroke: color-mix(in srgb, var(--warn) 60%, var(--line));
    }
    .pump {
      fill: color-mix(in srgb, var(--good) 22%, var(--surface));
      stroke: color-mix(in srgb, var(--good) 60%, var(--line));
    }
    .dock {
      fill: color-mix(in srgb, var(--accent) 70%, var(--surface));
      stroke: var(--accent);
    }
    .structure {
      fill: color-mix(in srgb, var(--dim) 30%, transparent);
      stroke: none;
    }
    circle {
      fill: var(--accent);
      stroke: var(--surface);
      stroke-width: 0.07;
    }
    .some circle:not(.lit) {
      fill: var(--dim);
      opacity: 0.5;
    }
    .some circle.lit {
      fill: var(--bad);
    }
    text {
      fill: var(--dim);
      font-size: 0.8px;
      text-anchor: end;
    }
    @media (max-width: 1050px) {
      svg {
        max-height: 270px;
      }
    }
    figcaption {
      margin-top: 6px;
      color: var(--dim);
      font-size: 13px;
    }
    strong {
      color: var(--text);
    }
  `;

  constructor() {
    super();
    this.watch(() => {
      const floors = world.value?.floors.map((floor) => floor.number) ?? [];
      readFloorPlans(floors).catch(showError);
    });
  }

  override render() {
    const site = world.value;
    if (site === null) return nothing;
    const texts = t().home;
    const caption = texts.siteFigures(site.floors.length, site.checkpoints.length, site.docks.length);
    const plans = site.floors.map((floor) => floorPlans.value.get(floor.number));
    const complete = plans.every((plan) => plan !== undefined);
    return html`<figure>
      ${complete ? this.picture(site, plans, texts.pictureOf(site.title, caption)) : nothing}
      <figcaption><strong>${site.title}</strong><br />${caption}</figcaption>
    </figure>`;
  }

  private picture(site: World, plans: readonly FloorPlan[], label: string) {
    const marked = pointedMission.value?.checkpoints ?? null;
    return html`<svg
      viewBox=${viewBox(site, plans)}
      preserveAspectRatio="xMidYMid meet"
      role="img"
      aria-label=${label}
      class=${marked === null ? "" : "some"}
    >
      ${plans.map((plan) => floorView(site, plan))} ${checkpointsView(site, marked)}
    </svg>`;
  }
}

/** Render the checkpoints in front of all floors, so that none is hidden. */
function checkpointsView(site: World, marked: readonly string[] | null) {
  return site.checkpoints.map((one) => {
    const [x, y] = projected(...one.position);
    const lit = marked?.includes(String(one.id)) ?? false;
    return svg`<circle class=${lit ? "lit" : ""} cx=${short(x)} cy=${short(y)} r=${lit ? 0.42 : 0.24} />`;
  });
}

function floorView(site: World, plan: FloorPlan) {
  const floor = site.floors.find((one) => one.number === plan.number);
  if (floor === undefined) return nothing;
  const { z, storey } = floor;
  const top = plan.number === site.floors.at(-1)?.number;
  const outlinesOf = (role: string) => plan.shapes.find((shape) => shape.role === role)?.outlines ?? [];
  const flat = FLAT.map((role) => {
    const level = role === "ground" ? site.ground_z : z;
    const outlines = outlinesOf(role).map((outline) => outline.map(([x, y]) => projected(x, y, level)));
    return svg`<path class=${role} d=${outlineData(outlines)} />`;
  });
  const bodies = Object.entries(BODIES)
    .filter(([role]) => !(top && role === "structure"))
    .flatMap(([role, height]) =>
      outlinesOf(role)
        .filter((outline) => outline.length > 2)
        .map((outline) => ({ role, outline, near: Math.max(...outline.map(([x, y]) => nearness(x, y))), height })),
    )
    .sort((a, b) => a.near - b.near)
    .map(({ role, outline, height }) => {
      const lid = outline.map(([x, y]) => projected(x, y, z + height * storey));
      return svg`<path class=${role} d=${outlineData([silhouette(outline, z, z + height * storey)])} />
        ${role === "structure" ? nothing : svg`<path class=${role} d=${outlineData([lid])} />`}`;
    });
  const [x, y] = leftEdge(plan, z);
  return svg`<g>
    ${flat} ${bodies}
    <text x=${short(x - 0.3)} y=${short(y + 0.2)}>${t().scene.floor(plan.number)}</text>
  </g>`;
}

/** Return the point of a floor that is farthest to the left. */
function leftEdge(plan: FloorPlan, z: number): Point {
  const decks = plan.shapes.find((shape) => shape.role === "deck")?.outlines ?? [];
  const corners = decks.flat().map(([x, y]) => projected(x, y, z));
  return corners.reduce((a, b) => (b[0] < a[0] ? b : a), corners[0] ?? [0, 0]);
}

function viewBox(site: World, plans: readonly FloorPlan[]): string {
  const corners: Point[] = [];
  for (const plan of plans) {
    const floor = site.floors.find((one) => one.number === plan.number);
    if (floor === undefined) continue;
    for (const { role, outlines } of plan.shapes) {
      const height = (BODIES[role] ?? 0) * floor.storey;
      for (const [x, y] of outlines.flat()) corners.push(projected(x, y, floor.z), projected(x, y, floor.z + height));
    }
    const [x, y] = leftEdge(plan, floor.z);
    corners.push([x - NAME, y]);
  }
  const xs = corners.map(([x]) => x);
  const ys = corners.map(([, y]) => y);
  const [left, top] = [least(xs) - MARGIN, least(ys) - MARGIN];
  return [left, top, most(xs) + MARGIN - left, most(ys) + MARGIN - top].map(short).join(" ");
}

function least(values: readonly number[]): number {
  return values.reduce((a, b) => Math.min(a, b), Infinity);
}
function most(values: readonly number[]): number {
  return values.reduce((a, b) => Math.max(a, b), -Infinity);
}
