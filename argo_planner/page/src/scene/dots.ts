/** Points of constant size in pixels, one for each clickable object. */

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  GreaterDepth,
  LessEqualDepth,
  Points,
  ShaderMaterial,
  type Vector3,
} from "three";

import type { Stage } from "./stage";

export interface Dot {
  readonly key: string;
  readonly at: Vector3;
  readonly colour: string;
  readonly rim: string;
  /** px, the diameter */
  readonly size: number;
}

const VERTEX = `
  attribute vec3 color;
  attribute vec3 rim;
  attribute float size;
  uniform float ratio;
  varying vec3 shown;
  varying vec3 edge;
  varying float across;
  void main() {
    vec4 seen = modelViewMatrix * vec4(position, 1.0);
    seen.xyz *= 1.0 - 0.22 / max(0.5, length(seen.xyz)); // in front of the object that it marks
    gl_Position = projectionMatrix * seen;
    gl_PointSize = size * ratio;
    across = size;
    shown = color;
    edge = rim;
  }`;
const FRAGMENT = `
  uniform float opacity;
  varying vec3 shown;
  varying vec3 edge;
  varying float across;
  void main() {
    float away = length(gl_PointCoord - 0.5) * across;
    if (away > across * 0.5) discard;
    vec3 colour = away > across * 0.5 - 2.0 ? edge : shown;
    gl_FragColor = vec4(colour, opacity);
    #include <colorspace_fragment>
  }`;

export class Dots {
  private readonly geometry = new BufferGeometry();
  private readonly seen = material(1, LessEqualDepth);
  /** Points behind other objects are drawn faintly. */
  private readonly behind = material(0.28, GreaterDepth);
  private readonly both = [new Points(this.geometry, this.seen), new Points(this.geometry, this.behind)];
  private dots: readonly Dot[] = [];

  constructor(private readonly stage: Stage) {
    for (const one of this.both) {
      one.frustumCulled = false;
      one.renderOrder = 5;
      stage.scene.add(one);
      one.onBeforeRender = (renderer) => {
        const ratio = renderer.getPixelRatio();
        for (const { uniforms } of [this.seen, this.behind]) (uniforms["ratio"] as { value: number }).value = ratio;
      };
    }
  }

  /** Draw these points; those that have not moved only get their colours. */
  show(dots: readonly Dot[]): void {
    const same = dots.length === this.dots.length && dots.every((dot, i) => dot.key === this.dots[i]?.key && dot.at.equals(this.dots[i].at));
    if (!same) {
      this.geometry.dispose(); // otherwise the old buffers stay on the graphics card
      this.geometry.setAttribute("position", new BufferAttribute(new Float32Array(dots.flatMap(({ at }) => at.toArray())), 3));
      this.geometry.setAttribute("color", new BufferAttribute(new Float32Array(3 * dots.length), 3));
      this.geometry.setAttribute("rim", new BufferAttribute(new Float32Array(3 * dots.length), 3));
      this.geometry.setAttribute("size", new BufferAttribute(new Float32Array(dots.length), 1));
    }
    const [colour, rim, size] = ["color", "rim", "size"].map((name) => this.geometry.getAttribute(name)) as [
      BufferAttribute,
      BufferAttribute,
      BufferAttribute,
    ];
    const made = new Color();
    dots.forEach((dot, i) => {
      const was = same ? this.dots[i] : undefined;
      if (was && was.colour === dot.colour && was.rim === dot.rim && was.size === dot.size) return;
      made.set(dot.colour).toArray(colour.array as unknown as number[], 3 * i);
      made.set(dot.rim).toArray(rim.array as unknown as number[], 3 * i);
      size.array[i] = dot.size;
      for (const one of [colour, rim]) {
        one.addUpdateRange(3 * i, 3);
        one.needsUpdate = true;
      }
      size.addUpdateRange(i, 1);
      size.needsUpdate = true;
    });
    this.dots = dots;
    this.stage.need();
  }

  dispose(): void {
    for (const one of this.both) one.removeFromParent();
    this.geometry.dispose();
    this.seen.dispose();
    this.behind.dispose();
  }
}

function material(opacity: number, depthFunc: typeof LessEqualDepth | typeof GreaterDepth): ShaderMaterial {
  return new ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    uniforms: { opacity: { value: opacity }, ratio: { value: 1 } },
    transparent: opacity < 1,
    depthWrite: opacity === 1,
    depthFunc,
  });
}
