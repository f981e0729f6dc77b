// SPDX-License-Identifier: MIT
// The stage of the 3-D view: renderer, camera and its moves. It draws only when something changed.

const kDraftTime = 220;      // ms of rest after which a coarse picture is redrawn sharply
const kDraftRatio = 0.5;     // picture elements of coarse pictures, per CSS pixel
const kLabelRoom = { x: 110, fraction: 0.16, y: 46 };  // pixels beside and below the scene
const kFitPasses = 4;        // each centres the picture better
const kTurn = Math.PI / 36;  // by one press of an arrow key

// Where the eye stands, as a direction from the middle of the scene, and its field of view in
// degrees; from far away with a narrow field, lengths can be read off the axes. The wall's frame
// is right-handed, so an eye that looks along +z sees x run from right to left without any flip.
const kViews = {
  wall: { from: [-0.42, 0.3, -1], field: 30 },
  side: { from: [-1, 0, 0], field: 4 },
  top: { from: [0, 1, -0.0005], field: 4 },
};

function makeRenderer() {
  const canvas = viewer.element('canvas', { class: 'space-canvas', role: 'img', tabindex: 0, 'data-control': 'scene' });
  const settings = { antialias: true, alpha: false, preserveDrawingBuffer: true };
  const context = canvas.getContext('webgl2', settings) || canvas.getContext('webgl', settings);
  viewer.require(context, '3-D needs WebGL, which this browser does not offer here.');
  return new THREE.WebGLRenderer(Object.assign({ canvas, context }, settings));
}

class Stage {
  constructor() {
    this.renderer = makeRenderer();
    this.canvas = this.renderer.domElement;
    this.printCopy = viewer.element('canvas', { class: 'print-copy' });
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(kViews.wall.field, 1, 0.01, 1000);
    this.light();
    this.beforeRender = [];  // callbacks, such as the axes', which follow the camera
    this.isHeavy = false;    // whether moving pictures are drawn coarsely
    this.box = new THREE.Box3(new THREE.Vector3(-1, -1, 0), new THREE.Vector3(1, 1, 1));
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.controls.enableKeys = false;
    this.controls.enableZoom = false;  // the wheel scrolls the page until the picture is in focus
    this.controls.screenSpacePanning = true;
    this.listen();
  }

  get hasVolumes() {
    return this.renderer.capabilities.isWebGL2;
  }

  light() {
    this.camera.add(new THREE.DirectionalLight(0xffffff, 0.55));
    this.scene.add(this.camera, new THREE.HemisphereLight(0xffffff, 0x8a8f9c, 0.6));
  }

  listen() {
    this.controls.addEventListener('change', () => {
      if (!this.isPlacing) this.setViewName('free');
      this.invalidate(true);
    });
    this.canvas.addEventListener('focus', () => { this.controls.enableZoom = true; });
    this.canvas.addEventListener('blur', () => { this.controls.enableZoom = false; });
    this.canvas.addEventListener('touchstart', () => this.canvas.focus(), { passive: true });
    this.canvas.addEventListener('keydown', (event) => this.key(event));
  }

  // ---- Drawing ----

  /** Asks for a new picture; several requests before the next frame make one. */
  invalidate(isMoving = false) {
    clearTimeout(this.sharpTimer);
    const isDraft = isMoving && this.isHeavy;
    if (isDraft) this.sharpTimer = setTimeout(() => this.invalidate(), kDraftTime);
    this.isDraft = isDraft;
    if (this.request) return;
    this.request = requestAnimationFrame(() => {
      this.request = 0;
      this.render();
    });
  }

  render() {
    if (!this.width) return;
    const ratio = this.isDraft ? kDraftRatio : Math.min(2, window.devicePixelRatio || 1);
    if (ratio !== this.renderer.getPixelRatio()) this.renderer.setPixelRatio(ratio);
    this.placeClipping();
    this.camera.updateMatrixWorld();
    for (const callback of this.beforeRender) callback(this);
    this.renderer.render(this.scene, this.camera);
    if (this.onRendered) this.onRendered();
  }

  /** Draws at once, and keeps a copy: print shows the last frame of WebGL, but any other canvas as it is. */
  renderSharply() {
    this.isDraft = false;
    this.render();
    this.printCopy.width = this.canvas.width;
    this.printCopy.height = this.canvas.height;
    this.printCopy.getContext('2d').drawImage(this.canvas, 0, 0);
  }

  /** Keeps the range of depths that the picture can tell apart fit for the camera's distance. */
  placeClipping() {
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.camera.near = distance / 100;
    this.camera.far = distance * 100;
    this.camera.updateProjectionMatrix();
  }

  resize(width, height) {
    const isFirst = !this.width;
    Object.assign(this, { width, height });
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (isFirst) this.look('wall');
    this.invalidate();
  }

  setBackground(colour) {
    this.renderer.setClearColor(new THREE.Color(colour), 1);
  }

  // ---- Camera ----

  setViewName(name) {
    if (this.onView) this.onView(name);
  }

  /** Turns to one of the standard views, at the distance from which everything is seen. */
  look(name) {
    const direction = new THREE.Vector3(...kViews[name].from).normalize();
    this.camera.fov = kViews[name].field;
    const { target, distance } = this.fit(direction);
    this.isPlacing = true;
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(direction, distance);
    this.controls.update();
    this.isPlacing = false;
    this.setViewName(name);
    this.invalidate();
  }

  corners() {
    const { min, max } = this.box;
    const corner = (i) => new THREE.Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z);
    return [0, 1, 2, 3, 4, 5, 6, 7].map(corner);
  }

  /** The target and distance at which the box fills the picture, but for the room of its labels. */
  fit(direction) {
    const right = new THREE.Vector3(0, 1, 0).cross(direction).normalize();
    const up = new THREE.Vector3().crossVectors(direction, right);
    const tangent = Math.tan((this.camera.fov * Math.PI) / 360);
    const tanUp = tangent * (1 - (2 * kLabelRoom.y) / this.height);
    const tanRight = tangent * this.camera.aspect * (1 - 2 * Math.min(kLabelRoom.fraction, kLabelRoom.x / this.width));
    const target = this.box.getCenter(new THREE.Vector3());
    let distance = 0;
    for (let pass = 0; pass < kFitPasses; ++pass) {
      const seen = this.corners().map((corner) => {
        corner.sub(target);
        return { across: corner.dot(right), along: corner.dot(up), towards: corner.dot(direction) };
      });
      distance = Math.max(...seen.map(({ across, along, towards }) =>
        towards + Math.max(Math.abs(across) / tanRight, Math.abs(along) / tanUp)));
      if (pass === kFitPasses - 1) break;
      // What is near looks larger, so the middle of the picture is not the middle of the box.
      const middle = (key) => {
        const slopes = seen.map((corner) => corner[key] / (distance - corner.towards));
        return (distance * (Math.min(...slopes) + Math.max(...slopes))) / 2;
      };
      target.addScaledVector(right, middle('across')).addScaledVector(up, middle('along'));
    }
    return { target, distance };
  }

  /** Arrow keys turn, with Shift they shift; plus and minus come nearer and go away. */
  key(event) {
    const zooms = { '+': 0.9, '=': 0.9, '-': 1 / 0.9 };
    const step = viewer.stepOfKey(event.key);
    if (step && event.shiftKey) this.shift(...step);
    else if (step) this.turn(...step);
    else if (zooms[event.key]) this.zoom(zooms[event.key]);
    else return;
    event.preventDefault();
    this.controls.update();
  }

  turn(right, up) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const angles = new THREE.Spherical().setFromVector3(offset);
    angles.theta += right * kTurn;
    angles.phi -= up * kTurn;
    angles.makeSafe();
    this.camera.position.copy(this.controls.target).add(offset.setFromSpherical(angles));
  }

  shift(right, up) {
    const distance = this.camera.position.distanceTo(this.controls.target);
    const moved = new THREE.Vector3(-right, -up, 0).multiplyScalar(0.03 * distance);
    moved.applyQuaternion(this.camera.quaternion);
    this.camera.position.add(moved);
    this.controls.target.add(moved);
  }

  zoom(factor) {
    const { target } = this.controls;
    this.camera.position.sub(target).multiplyScalar(factor).add(target);
  }
}

viewer.makeStage = function () {
  viewer.require(typeof THREE !== 'undefined' && THREE.OrbitControls, '3-D needs three.js, which the page lacks.');
  return new Stage();
};
