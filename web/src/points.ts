// SPDX-License-Identifier: Apache-2.0
// Points drawn as squares or discs of a size in metres.
import { BufferAttribute, BufferGeometry, Color, GLSL3, type PerspectiveCamera, Points, ShaderMaterial } from "three";

const kVertexShader = `
uniform float size;
uniform float scale;
uniform float hasNormals;
uniform float nearer;
uniform float enlarge;
in vec3 color;
in float pointSize; // 0 where the points have no sizes of their own
out vec3 vColor;
void main() {
  vec4 p = modelViewMatrix * vec4(position, 1.0);
  float shade = 1.0;
  if (hasNormals > 0.5) {
    float facing = dot(normalize(normalMatrix * normal), normalize(-p.xyz));
    shade = 0.55 + 0.45 * max(facing, 0.0);
    if (facing < -0.1) p.xyz = vec3(0.0, 0.0, 1.0); // the far side: behind the camera
  }
  vColor = color * shade;
  gl_Position = projectionMatrix * p;
  vec4 moved = projectionMatrix * (p + vec4(0.0, 0.0, nearer, 0.0));
  if (moved.w > 0.0) gl_Position.z = moved.z / moved.w * gl_Position.w;
  gl_PointSize = clamp((pointSize > 0.0 ? pointSize : size) * enlarge * scale / -p.z, 1.0, 24.0);
}`;

const kFragmentShader = `
uniform float opacity;
uniform float isRound;
uniform vec3 tint;
uniform float tintShare;
in vec3 vColor;
out vec4 fragment;
void main() {
  if (isRound > 0.5 && length(gl_PointCoord - 0.5) > 0.5) discard;
  fragment = vec4(mix(vColor, tint, tintShare), opacity);
}`;

export interface PointStyle {
  sizeM: number;
  /** Is drawn as if it were this much nearer, in front of other points of the same place. */
  nearerM: number;
  isRound: boolean;
  opacity: number;
}

export class PointSet extends Points<BufferGeometry, ShaderMaterial> {
  /** Whether the first points alone are spread evenly (depthToPoints()). */
  isEven = false;

  constructor(positions: Float32Array, colors: Uint8Array, normals: Int8Array | null, style: PointStyle) {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    geometry.setAttribute("color", new BufferAttribute(colors, 3, true));
    if (normals) geometry.setAttribute("normal", new BufferAttribute(normals, 3, true));
    super(
      geometry,
      new ShaderMaterial({
        glslVersion: GLSL3,
        vertexShader: kVertexShader,
        fragmentShader: kFragmentShader,
        transparent: style.opacity < 1,
        uniforms: {
          size: { value: style.sizeM },
          scale: { value: 1 },
          enlarge: { value: 1 },
          nearer: { value: style.nearerM },
          hasNormals: { value: normals ? 1 : 0 },
          isRound: { value: style.isRound ? 1 : 0 },
          opacity: { value: style.opacity },
          tint: { value: new Color() },
          tintShare: { value: 0 },
        },
      }),
    );
    this.frustumCulled = false;
    this.matrixAutoUpdate = false;
  }

  get positions(): Float32Array {
    return this.geometry.getAttribute("position").array as Float32Array;
  }
  /** Sizes of the single points, in metres. */
  setSizes(sizes: Float32Array): void {
    this.geometry.setAttribute("pointSize", new BufferAttribute(sizes, 1));
  }
  /** Moves the colours towards another one; share 0 leaves them. */
  setTint(color: string, share: number): void {
    const { tint, tintShare } = this.material.uniforms;
    if (tint) tint.value.set(color).convertLinearToSRGB();
    if (tintShare) tintShare.value = share;
  }
  /** Draws only the first points, enlarged: a cloud whose order allows it is drawn faster while the camera moves. */
  setShare(share: number): void {
    const count = this.geometry.getAttribute("position").count;
    this.geometry.setDrawRange(0, Math.ceil(share * count));
    const { enlarge } = this.material.uniforms;
    if (enlarge) enlarge.value = 1 / Math.sqrt(share);
  }
  /** To be called before drawing: pixels per metre at a distance of 1 m. */
  fitScreen(camera: PerspectiveCamera, heightPx: number): void {
    const { scale } = this.material.uniforms;
    if (scale) scale.value = heightPx / (2 * Math.tan((camera.fov * Math.PI) / 360));
  }
}
