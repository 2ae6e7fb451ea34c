/** Parser of the service's GLB files: nodes with plain triangles, no textures. */

export interface GlbPart {
  readonly positions: Float32Array;
  readonly index: Uint16Array | Uint32Array;
  /** linear RGB, 0 to 1 */
  readonly colour: readonly [number, number, number];
}

export interface GlbNode {
  readonly name: string;
  /** Index of the parent node; null: the node is in the site's frame. */
  readonly parent: number | null;
  readonly position: readonly [number, number, number];
  /** quaternion x, y, z, w */
  readonly rotation: readonly [number, number, number, number];
  readonly parts: readonly GlbPart[];
}

interface Gltf {
  readonly nodes: readonly {
    readonly name?: string;
    readonly children?: readonly number[];
    readonly translation?: [number, number, number];
    readonly rotation?: [number, number, number, number];
    readonly mesh?: number;
  }[];
  readonly meshes?: readonly { readonly primitives: readonly Primitive[] }[];
  readonly materials?: readonly {
    readonly pbrMetallicRoughness?: { readonly baseColorFactor?: readonly number[] };
  }[];
  readonly accessors: readonly {
    readonly bufferView: number;
    readonly byteOffset?: number;
    readonly componentType: number;
    readonly count: number;
  }[];
  readonly bufferViews: readonly { readonly byteOffset?: number }[];
}

interface Primitive {
  readonly attributes: { readonly POSITION: number };
  readonly indices: number;
  readonly material?: number;
}

const MAGIC = 0x46546c67;
const SHORT = 5123;

/** Return the nodes below the one that turns z up into y up, parents before children. */
export function readGlb(content: ArrayBuffer): GlbNode[] {
  const view = new DataView(content);
  if (view.getUint32(0, true) !== MAGIC) throw new Error("this is no GLB file");
  const length = view.getUint32(12, true);
  const gltf = JSON.parse(new TextDecoder().decode(new Uint8Array(content, 20, length))) as Gltf;
  const binary = 20 + length + 8;
  const carriers = new Map<number, number>();
  gltf.nodes.forEach((node, index) => node.children?.forEach((child) => carriers.set(child, index)));
  return gltf.nodes.slice(1).map((node, index) => {
    const carrier = carriers.get(index + 1) ?? 0;
    const primitives = node.mesh === undefined ? [] : (gltf.meshes?.[node.mesh]?.primitives ?? []);
    return {
      name: node.name ?? "",
      parent: carrier === 0 ? null : carrier - 1,
      position: node.translation ?? [0, 0, 0],
      rotation: node.rotation ?? [0, 0, 0, 1],
      parts: primitives.map((one) => partOf(content, gltf, binary, one)),
    };
  });
}

function partOf(content: ArrayBuffer, gltf: Gltf, binary: number, primitive: Primitive): GlbPart {
  const place = (number: number) => {
    const accessor = gltf.accessors[number];
    const buffer = gltf.bufferViews[accessor?.bufferView ?? -1];
    if (!accessor || !buffer) throw new Error("this GLB file is not whole");
    const at = binary + (buffer.byteOffset ?? 0) + (accessor.byteOffset ?? 0);
    return { ...accessor, at };
  };
  const corners = place(primitive.attributes.POSITION);
  const triangles = place(primitive.indices);
  const material = gltf.materials?.[primitive.material ?? -1];
  const [red = 1, green = 1, blue = 1] = material?.pbrMetallicRoughness?.baseColorFactor ?? [];
  const Index = triangles.componentType === SHORT ? Uint16Array : Uint32Array;
  return {
    positions: new Float32Array(content, corners.at, 3 * corners.count),
    index: new Index(content, triangles.at, triangles.count),
    colour: [red, green, blue],
  };
}
