// SPDX-License-Identifier: MIT
// Axes of the 3-D view, which are the wall's: grids on the far sides of a box, with ticks in metres on its outline.

const kFontSize = 12.5;   // CSS pixels
const kTicks = 5;         // about so many on the longest side
const kSharpness = 2;     // picture elements of labels per CSS pixel
const kGap = 6;           // CSS pixels between an edge, its numbers and its title
const kEndOn = 0.985;     // an axis is seen end-on, and not labelled, from this cosine on

const alongAxis = (axis, value) => new THREE.Vector3().setComponent(axis, value);

/** A label of constant size on the screen. */
function makeLabel(text, colour, isBold) {
  const canvas = document.createElement('canvas');
  const font = `${isBold ? '600 ' : ''}${kFontSize * kSharpness}px system-ui, "Segoe UI", Roboto, Arial, sans-serif`;
  const context = canvas.getContext('2d');
  context.font = font;
  canvas.width = Math.ceil(context.measureText(text).width) + 4;
  canvas.height = Math.ceil(kFontSize * kSharpness * 1.4);
  context.font = font;
  context.fillStyle = colour;
  context.textBaseline = 'middle';
  context.fillText(text, 2, canvas.height / 2);
  const map = new THREE.CanvasTexture(canvas);
  map.minFilter = THREE.LinearFilter;
  map.generateMipmaps = false;
  const material = new THREE.SpriteMaterial({ map, sizeAttenuation: false, depthTest: false, transparent: true });
  const sprite = new THREE.Sprite(material);
  sprite.renderOrder = 10;
  sprite.pixels = [canvas.width / kSharpness, canvas.height / kSharpness];
  return sprite;
}

class Axes {
  constructor(stage) {
    this.stage = stage;
    this.group = new THREE.Group();
    stage.scene.add(this.group);
    stage.beforeRender.push(() => this.follow());
  }

  /** Builds grids and labels for a box in the colours of the page, unless they stand already. */
  build(box, theme) {
    const key = JSON.stringify([box, theme]);
    if (key === this.key) return;
    this.key = key;
    this.clear();
    this.box = box;
    const spans = box.getSize(new THREE.Vector3()).toArray();
    const longest = Math.max(...spans);
    this.ticks = spans.map((span, axis) => {
      const count = Math.max(1, Math.round((kTicks * span) / longest));
      return viewer.roundTicks(box.min.getComponent(axis), box.max.getComponent(axis), count);
    });
    this.faces = [];
    for (let axis = 0; axis < 3; ++axis) {
      for (const isHigh of [false, true]) this.faces.push(this.makeFace(axis, isHigh, theme));
    }
    this.labels = this.ticks.map((values, axis) => {
      const numbers = values.map((value) => {
        const label = makeLabel(viewer.formatNumber(value, 3), theme.soft, false);
        return Object.assign(label, { value });
      });
      const title = makeLabel(viewer.wallTitles[axis], theme.ink, true);
      this.group.add(...numbers, title);
      return { numbers, title };
    });
  }

  clear() {
    for (const object of this.group.children.slice()) {
      this.group.remove(object);
      if (object.material.map) object.material.map.dispose();
      object.material.dispose();
      if (!object.isSprite) object.geometry.dispose();
    }
  }

  makeFace(axis, isHigh, theme) {
    const { min, max } = this.box;
    const level = (isHigh ? max : min).getComponent(axis);
    const points = [];
    for (const across of [0, 1, 2].filter((other) => other !== axis)) {
      const along = 3 - axis - across;
      const ends = [min.getComponent(across), max.getComponent(across)];
      for (const value of [...ends, ...this.ticks[across]]) {
        for (const end of [min, max]) {
          const point = alongAxis(axis, level).setComponent(across, value);
          points.push(point.setComponent(along, end.getComponent(along)));
        }
      }
    }
    const material = new THREE.LineBasicMaterial({ color: new THREE.Color(theme.line) });
    const lines = new THREE.LineSegments(new THREE.BufferGeometry().setFromPoints(points), material);
    this.group.add(lines);
    return { axis, isHigh, level, lines };
  }

  isFacing(axis, isHigh) {
    const level = (isHigh ? this.box.max : this.box.min).getComponent(axis);
    return (this.stage.camera.position.getComponent(axis) - level) * (isHigh ? 1 : -1) > 0;
  }

  /** Shows the far sides of the box, and puts the labels on its outline as the camera sees it. */
  follow() {
    if (!this.group.visible || !this.box) return;
    for (const { axis, isHigh, lines } of this.faces) lines.visible = !this.isFacing(axis, isHigh);
    const towards = this.box.getCenter(new THREE.Vector3()).sub(this.stage.camera.position).normalize();
    for (let axis = 0; axis < 3; ++axis) {
      const edge = Math.abs(towards.getComponent(axis)) < kEndOn ? this.bestEdge(axis) : null;
      this.placeLabels(axis, edge);
    }
  }

  /** Of the outline's edges along an axis: the lowest on the screen, for y the leftmost. */
  bestEdge(axis) {
    const [b, c] = [0, 1, 2].filter((other) => other !== axis);
    let best = null;
    for (const highB of [false, true]) {
      for (const highC of [false, true]) {
        if (this.isFacing(b, highB) === this.isFacing(c, highC)) continue;
        const middle = this.box.getCenter(new THREE.Vector3());
        middle.setComponent(b, (highB ? this.box.max : this.box.min).getComponent(b));
        middle.setComponent(c, (highC ? this.box.max : this.box.min).getComponent(c));
        const seen = middle.clone().project(this.stage.camera);
        const rank = axis === 1 ? seen.x : seen.y;
        if (!best || rank < best.rank - 1e-6) best = { middle, rank };
      }
    }
    return best;
  }

  placeLabels(axis, edge) {
    const { numbers, title } = this.labels[axis];
    for (const sprite of [...numbers, title]) sprite.visible = edge !== null;
    if (!edge) return;
    const outward = this.outward(axis, edge.middle);
    const extent = ({ pixels: [w, h] }) => Math.abs(outward.x) * w + Math.abs(outward.y) * h;
    for (const sprite of numbers) {
      const point = edge.middle.clone().setComponent(axis, sprite.value);
      this.place(sprite, point, outward, kGap + extent(sprite) / 2);
    }
    const widest = Math.max(0, ...numbers.map(extent));
    this.place(title, edge.middle, outward, 2 * kGap + widest + extent(title) / 2);
  }

  /** The direction on the screen, in pixels, that leads away from the box. */
  outward(axis, middle) {
    const toPixels = (point) => {
      const seen = point.clone().project(this.stage.camera);
      return new THREE.Vector2((seen.x * this.stage.width) / 2, (seen.y * this.stage.height) / 2);
    };
    const step = alongAxis(axis, this.box.getSize(new THREE.Vector3()).getComponent(axis) / 4);
    const along = toPixels(middle.clone().add(step)).sub(toPixels(middle)).normalize();
    const normal = new THREE.Vector2(-along.y, along.x);
    const away = toPixels(middle).sub(toPixels(this.box.getCenter(new THREE.Vector3())));
    return normal.dot(away) < 0 ? normal.negate() : normal;
  }

  /** Puts a label beside a point: so many pixels outward on the screen, but inside the picture. */
  place(sprite, point, outward, reach) {
    const { camera, width, height } = this.stage;
    const perPixel = (2 * Math.tan((camera.fov * Math.PI) / 360)) / height;
    const [w, h] = sprite.pixels;
    sprite.scale.set(w * perPixel, h * perPixel, 1);
    const seen = point.clone().project(camera);
    const isInside = Math.abs(seen.x) <= 1 && Math.abs(seen.y) <= 1;
    seen.x += (2 * outward.x * reach) / width;
    seen.y += (2 * outward.y * reach) / height;
    const keep = (value, margin) => Math.min(1 - margin, Math.max(margin - 1, value));
    if (isInside) seen.set(keep(seen.x, w / width), keep(seen.y, h / height), seen.z);
    sprite.position.copy(seen.unproject(camera));
  }
}

viewer.makeAxes = (stage) => new Axes(stage);
