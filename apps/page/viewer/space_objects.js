// SPDX-License-Identifier: MIT
// What stands on the 3-D stage: the relay wall, its scan points, the hidden truth, reconstructed points.

const kMissing = 0x969696;

// Points lie a little nearer to the eye than they are drawn, so that those on a surface of the
// truth are not half hidden by it.
const kPointVertex = `
  attribute vec3 tint;
  uniform float diameter;
  uniform float pixelsPerMetre;
  uniform float leastPixels;
  uniform float lift;
  varying vec3 shade;
  void main() {
    vec4 seen = modelViewMatrix * vec4(position, 1.0);
    gl_Position = projectionMatrix * seen;
    vec4 lifted = projectionMatrix * vec4(seen.xyz - normalize(seen.xyz) * lift, 1.0);
    gl_Position.z = lifted.z / lifted.w * gl_Position.w;
    gl_PointSize = max(leastPixels, diameter * pixelsPerMetre / -seen.z);
    shade = tint;
  }`;
const kPointFragment = `
  varying vec3 shade;
  void main() {
    float r = 2.0 * length(gl_PointCoord - 0.5);
    if (r > 1.0) discard;
    gl_FragColor = vec4(shade * (1.0 - 0.28 * r * r * r), 1.0);
  }`;

/** A cloud of round points of one size; `diameter` in metres, `leastPixels` on the screen. */
function makeCloud(positions, diameter, leastPixels, lift) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
  geometry.setAttribute('tint', new THREE.BufferAttribute(new Uint8Array(positions.length), 3, true));
  const material = new THREE.ShaderMaterial({
    vertexShader: kPointVertex,
    fragmentShader: kPointFragment,
    uniforms: {
      diameter: { value: diameter },
      pixelsPerMetre: { value: 1 },
      leastPixels: { value: leastPixels },
      lift: { value: lift },
    },
  });
  const cloud = new THREE.Points(geometry, material);
  cloud.onBeforeRender = (renderer, scene, camera) => {
    // Half the picture's height in picture elements lies at the tangent of half the field of view.
    material.uniforms.pixelsPerMetre.value = (renderer.domElement.height / 2) * camera.projectionMatrix.elements[5];
  };
  return cloud;
}

/** Colours the points of a cloud by a function of their index: 0xAABBGGRR, or 0 where missing. */
viewer.tintCloud = function (cloud, elementOf) {
  const attribute = cloud.geometry.getAttribute('tint');
  for (let i = 0; i < attribute.count; ++i) {
    const element = elementOf(i) || kMissing;
    attribute.array[3 * i] = element & 255;
    attribute.array[3 * i + 1] = (element >> 8) & 255;
    attribute.array[3 * i + 2] = (element >> 16) & 255;
  }
  attribute.needsUpdate = true;
};

/** A CSS colour such as #1f5fb4 as a picture element. */
viewer.elementOfCss = function (text) {
  const hex = new THREE.Color(text).getHex();
  return ((255 << 24) | ((hex & 255) << 16) | (hex & 0xff00) | (hex >> 16)) >>> 0;
};

/** The distance of neighbours when so many points fill the larger two sides of their box. */
function typicalPitch({ low, high, count }) {
  const sides = low.map((value, axis) => Math.abs(high[axis] - value)).sort((a, b) => b - a);
  return Math.sqrt((sides[0] * (sides[1] || sides[0])) / Math.max(1, count)) || 0.01;
}

/** How far apart the points of a result are: as the elements of its maps, if it has any. */
function pitchOf({ maps, points }) {
  const map = (maps || [])[0];
  const isPlaced = map && viewer.isRange(map.x_m) && viewer.isRange(map.size);
  return (isPlaced && (map.x_m[1] - map.x_m[0]) / map.size[0]) || typicalPitch(points.positions);
}

/** Loads the points of a result, with all their fields. */
viewer.loadCloud = async function (result, lift) {
  const { points } = result;
  const positions = await viewer.loadPoints(points.positions);
  const fields = new Map();
  for (const field of points.fields || []) {
    fields.set(field.name, await viewer.loadQuantity(field.values, points.positions.count));
  }
  const pitch = pitchOf(result);
  const cloud = makeCloud(positions, pitch, 2.5, lift);
  return { object: cloud, fields, pitch };
};

const kMany = 5000;  // scan points, from which on their dots are smaller

/** Loads scan points as small dots. */
viewer.loadScanPoints = async function (description, pixels) {
  const size = description.count > kMany ? pixels / 2 : pixels;
  const cloud = makeCloud(await viewer.loadPoints(description), 0, size, 0.001);
  cloud.renderOrder = 1;
  return cloud;
};

/** The relay wall: a translucent rectangle with its outline, at depth 0. */
viewer.makeWall = function (wall) {
  viewer.require(viewer.isRange(wall.x_m) && viewer.isRange(wall.y_m), 'Its size is not given.');
  const [x0, x1] = wall.x_m;
  const [y0, y1] = wall.y_m;
  const group = new THREE.Group();
  const pane = new THREE.Mesh(
    new THREE.PlaneBufferGeometry(x1 - x0, y1 - y0),
    new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.13, side: THREE.DoubleSide, depthWrite: false }),
  );
  pane.position.set((x0 + x1) / 2, (y0 + y1) / 2, 0);
  const corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(([x, y]) => new THREE.Vector3(x, y, 0));
  const outline = new THREE.LineLoop(new THREE.BufferGeometry().setFromPoints(corners), new THREE.LineBasicMaterial());
  group.add(pane, outline);
  group.setColour = (colour) => {
    pane.material.color.set(colour);
    outline.material.color.set(colour);
  };
  return group;
};

/** Loads the hidden truth as a shaded mesh. */
viewer.loadTruth = async function (truth) {
  const positions = await viewer.loadPoints(truth.positions);
  const { array, type, count } = truth.triangles;
  const triangles = await viewer.loadArray(array, type, count);
  const isInside = triangles.every((index) => index < truth.positions.count);
  viewer.require(isInside && count % 3 === 0, 'The truth\u2019s triangles are damaged.');
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
  geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
  const material = new THREE.MeshPhongMaterial({ side: THREE.DoubleSide, flatShading: true, shininess: 8, specular: 0x222222 });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.setColour = (isDark) => material.color.set(isDark ? 0x8d95a3 : 0xa3abb9);
  return mesh;
};
