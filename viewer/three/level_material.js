import { Color, DoubleSide, FrontSide, MeshStandardMaterial } from 'three';

/** Distance of the hatch's lines along the pixel rows. */
const HATCH_PIXELS = 9;

/** The surface's material. Where the attribute `paleness` is above zero, it is hatched on the screen. */
export class LevelMaterial extends MeshStandardMaterial {
  #hatch = { value: new Color() };

  constructor(settings) {
    super({ roughness: 0.62, metalness: 0, side: DoubleSide, ...settings });
  }

  /** The plain colour; the hatch has it as well. */
  set plain(color) {
    this.#hatch.value.set(color);
    this.color.set(this.vertexColors ? 0xffffff : color);
  }

  onBeforeCompile(shader) {
    shader.uniforms.hatch = this.#hatch;
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', '#include <common>\nattribute float paleness;\nvarying float vPaleness;')
      .replace('#include <begin_vertex>', '#include <begin_vertex>\nvPaleness = paleness;');
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', '#include <common>\nuniform vec3 hatch;\nvarying float vPaleness;')
      .replace('#include <color_fragment>', `#include <color_fragment>\n${HATCH}`);
  }

  customProgramCacheKey() {
    return 'hatched';
  }
}

/** Diagonal lines a few pixels apart, with soft edges, stronger the paler. */
const HATCH = `
  float across = abs(fract((gl_FragCoord.x + gl_FragCoord.y) / ${HATCH_PIXELS.toFixed(1)}) - 0.5);
  diffuseColor.rgb = mix(diffuseColor.rgb, hatch, vPaleness * (1.0 - smoothstep(0.10, 0.22, across)));
`;

/** What is left of the other bodies when one is singled out. */
export function ghostMaterial() {
  return new LevelMaterial({ transparent: true, opacity: 0.2, depthWrite: false, side: FrontSide });
}
