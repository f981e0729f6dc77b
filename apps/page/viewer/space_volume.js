// SPDX-License-Identifier: MIT
// A volume in 3-D, ray by ray: its maximum projection, or the surface where it reaches a threshold.

const kMostSteps = 1024;

const kVertex = `
  varying vec3 onBox;
  void main() {
    onBox = (modelMatrix * vec4(position, 1.0)).xyz;
    gl_Position = projectionMatrix * viewMatrix * vec4(onBox, 1.0);
  }`;

// The texture's axes are z, y, x, as the volume is stored. A ray takes one step for each voxel
// that it crosses along the axis on which it crosses most of them, so that flat voxels count too.
const kFragment = `
  precision highp sampler3D;
  uniform sampler3D volume;
  uniform sampler2D colours;
  uniform vec3 low;
  uniform vec3 high;
  uniform vec3 voxels;
  uniform float threshold;
  uniform vec3 surfaceColour;
  uniform mat4 toClip;
  varying vec3 onBox;

  float valueAt(vec3 fraction) {
    return max(0.0, (texture(volume, fraction.zyx).r * 255.0 - 1.0) / 254.0);
  }

  #ifdef SURFACE
  vec3 slopeAt(vec3 fraction) {
    vec3 e = 1.0 / voxels;
    vec3 rise = vec3(
        valueAt(fraction + vec3(e.x, 0.0, 0.0)) - valueAt(fraction - vec3(e.x, 0.0, 0.0)),
        valueAt(fraction + vec3(0.0, e.y, 0.0)) - valueAt(fraction - vec3(0.0, e.y, 0.0)),
        valueAt(fraction + vec3(0.0, 0.0, e.z)) - valueAt(fraction - vec3(0.0, 0.0, e.z)));
    return rise * voxels / (high - low);
  }

  void showSurface(vec3 outer, vec3 inner, vec3 direction) {
    for (int i = 0; i < 6; ++i) {
      vec3 middle = 0.5 * (outer + inner);
      if (valueAt(middle) < threshold) outer = middle; else inner = middle;
    }
    vec3 slope = slopeAt(inner);
    float facing = abs(dot(slope, direction)) / max(length(slope), 1e-9);
    vec4 clip = toClip * vec4(mix(low, high, inner), 1.0);
    gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;
    gl_FragColor = vec4(surfaceColour * (0.5 + 0.5 * facing) + 0.12 * pow(facing, 24.0), 1.0);
  }
  #endif

  void main() {
    vec3 direction = normalize(onBox - cameraPosition);
    vec3 toLow = (low - cameraPosition) / direction;
    vec3 toHigh = (high - cameraPosition) / direction;
    vec3 entries = min(toLow, toHigh);
    vec3 exits = max(toLow, toHigh);
    float from = max(0.0, max(entries.x, max(entries.y, entries.z)));
    float to = min(exits.x, min(exits.y, exits.z));
    if (to <= from) discard;
    vec3 start = (cameraPosition + from * direction - low) / (high - low);
    vec3 end = (cameraPosition + to * direction - low) / (high - low);
    vec3 crossed = abs(end - start) * voxels;
    float count = clamp(ceil(1.2 * max(crossed.x, max(crossed.y, crossed.z))), 2.0, float(MOST_STEPS));
    vec3 advance = (end - start) / count;
    vec3 here = start + 0.5 * advance;
    float largest = 0.0;
    for (int i = 0; i < MOST_STEPS; ++i) {
      if (float(i) >= count) break;
      float value = valueAt(here);
  #ifdef SURFACE
      if (value >= threshold) {
        showSurface(here - advance, here, direction);
        return;
      }
  #else
      largest = max(largest, value);
  #endif
      here += advance;
    }
  #ifdef SURFACE
    discard;
  #else
    if (largest < threshold) discard;
    float cover = smoothstep(0.0, 1.0, (largest - threshold) / max(1.0 - threshold, 1e-6) * 3.0 + 0.25);
    gl_FragColor = vec4(texture2D(colours, vec2(largest, 0.5)).rgb, cover);
  #endif
  }`;

function makeColours() {
  const table = viewer.colourTable('heat');
  const texture = new THREE.DataTexture(new Uint8Array(table.slice().buffer), 256, 1, THREE.RGBAFormat);
  texture.minFilter = THREE.LinearFilter;
  texture.magFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

function makeTexture(loaded) {
  const [nx, ny, nz] = loaded.size;
  const texture = new THREE.DataTexture3D(loaded.quantity.codes, nz, ny, nx);
  texture.format = THREE.RedFormat;
  texture.type = THREE.UnsignedByteType;
  texture.minFilter = THREE.LinearFilter;
  texture.magFilter = THREE.LinearFilter;
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  return texture;
}

function checkSize(stage, { size, quantity }) {
  viewer.require(stage.hasVolumes, 'Volumes need WebGL 2, which this browser does not offer here.');
  const context = stage.renderer.getContext();
  const most = context.getParameter(context.MAX_3D_TEXTURE_SIZE);
  viewer.require(Math.max(...size) <= most, `This computer\u2019s graphics show volumes of up to ${most} voxels a side.`);
  viewer.require(quantity.codes instanceof Uint8Array, 'The volume has numbers of an unknown type.');
}

/** The volume of a result as an object for the stage, with setMode, setThreshold and dispose. */
viewer.makeVolume = function (stage, loaded, surfaceColour) {
  checkSize(stage, loaded);
  const [low, high] = [0, 1].map((end) => new THREE.Vector3(...loaded.edges.map((edge) => edge[end])));
  const size = high.clone().sub(low);
  const material = new THREE.ShaderMaterial({
    vertexShader: kVertex,
    fragmentShader: kFragment,
    side: THREE.BackSide,
    defines: { MOST_STEPS: kMostSteps },
    uniforms: {
      volume: { value: makeTexture(loaded) },
      colours: { value: makeColours() },
      low: { value: low },
      high: { value: high },
      voxels: { value: new THREE.Vector3(...loaded.size) },
      threshold: { value: 0.5 },
      surfaceColour: { value: new THREE.Color(surfaceColour) },
      toClip: { value: new THREE.Matrix4() },
    },
  });
  const box = new THREE.Mesh(new THREE.BoxBufferGeometry(size.x, size.y, size.z), material);
  box.position.copy(low).add(high).multiplyScalar(0.5);
  box.renderOrder = 5;
  box.onBeforeRender = (renderer, scene, camera) => {
    material.uniforms.toClip.value.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
  };
  return {
    object: box,
    bounds: new THREE.Box3(low, high),
    setThreshold: (fraction) => { material.uniforms.threshold.value = fraction; },
    setMode: (mode) => setMode(material, mode),
    dispose: () => disposeVolume(box),
  };
};

/** A surface hides and is hidden like any solid; a maximum projection lies over everything. */
function setMode(material, mode) {
  const isSurface = mode === 'surface';
  if (isSurface) material.defines.SURFACE = 1;
  else delete material.defines.SURFACE;
  material.transparent = !isSurface;
  material.depthTest = isSurface;
  material.depthWrite = isSurface;
  material.needsUpdate = true;
}

function disposeVolume(box) {
  box.material.uniforms.volume.value.dispose();
  box.material.uniforms.colours.value.dispose();
  box.material.dispose();
  box.geometry.dispose();
}
