// SPDX-License-Identifier: MIT
// The 3-D view: relay wall, hidden truth, reconstructed points and volumes in one scene.

const kHeights = { least: 320, most: 640, fraction: 0.7 };  // of the picture, in pixels and of its width
const kDots = { sensing: 2.2, lit: 4 };  // pixels
const kByResult = 'by result';
const kModes = [['none', 'Nothing'], ['maximum', 'Maximum projection'], ['surface', 'Surface']];
const kReadoutHint = 'Point at a reconstructed point to read its place and values.';
const kHint = 'Drag to turn, drag with the right button to shift; click the picture first to zoom with the wheel. ' +
  'Keys: arrows turn, Shift with arrows shifts, + and \u2212 zoom.';

class Space {
  constructor(view) {
    this.view = view;
    this.metadata = view.metadata;
    this.results = view.metadata.results;
    this.stage = viewer.makeStage();
    this.axes = viewer.makeAxes(this.stage);
    this.clouds = new Map();   // loaded points, by the result's index
    this.scan = [];            // loaded scan points
    const withVolume = this.indices((result) => result.volume);
    const withPoints = this.indices((result) => result.points);
    const first = [this.metadata.best, ...withPoints].find(
      (index) => withPoints.includes(index) && !this.results[index].is_truth,
    );
    const shown = first === undefined ? withPoints[0] : first;
    this.state = {
      results: new Set(shown === undefined ? [] : [shown]),
      colour: this.fieldNames()[0] || kByResult,
      mode: shown === undefined && withVolume.length > 0 ? 'maximum' : 'none',
      volumeOf: withVolume.includes(shown) ? shown : withVolume[0],
      threshold: 30,
      pointSize: 100,
    };
    this.makeControls(withPoints, withVolume);
    this.assemble();
  }

  indices(isWanted) {
    return this.results.map((result, index) => index).filter((index) => isWanted(this.results[index]));
  }

  fields() {
    const fields = this.results.flatMap((result) => (result.points && result.points.fields) || []);
    return fields.filter(({ values }) => values && viewer.isRange([values.low, values.high]));
  }

  fieldNames() {
    return [...new Set(this.fields().map((field) => field.name))];
  }

  // ---- Controls ----

  makeControls(withPoints, withVolume) {
    this.panel = viewer.element('div', { class: 'view-panel' });
    if (withPoints.length > 0) this.panel.append(this.pointControls(withPoints));
    if (withVolume.length > 0) this.panel.append(this.volumeControls(withVolume));
    this.panel.append(this.sceneControls());
    const look = (name, text) => viewer.button(text, 'view-' + name, () => this.stage.look(name));
    this.views = viewer.element(
      'div',
      { class: 'view-controls' },
      look('wall', 'From the wall'),
      look('side', 'Side'),
      look('top', 'Top'),
      viewer.button('Reset', 'reset', () => this.stage.look('wall')),
      viewer.button('Save picture', 'save', () => this.save()),
    );
    this.pointsBar = viewer.createColourBar('points-bar', 280);
    this.volumeBar = viewer.createColourBar('volume-bar', 280);
  }

  pointControls(withPoints) {
    const boxes = withPoints.map((index) => {
      const isOn = this.state.results.has(index);
      const label = viewer.check(this.results[index].name, 'result', isOn, (on) => this.showResult(index, on));
      const swatch = viewer.element('i', { class: 'swatch' });
      swatch.style.background = viewer.resultColour(index);
      label.append(swatch);
      label.querySelector('input').dataset.index = String(index);
      return label;
    });
    const fields = [...this.fieldNames(), kByResult].map((name) => [name, viewer.capitalised(name)]);
    const colour = viewer.select('Colour', 'colour', fields, this.state.colour, (value) => {
      this.state.colour = value;
      this.update();
    });
    const size = viewer.slider('Size', 'point-size', { min: 20, max: 300, step: 10 }, this.state.pointSize,
      (value) => `${value} %`, (value) => {
        this.state.pointSize = value;
        this.update();
      });
    return viewer.group('Points', viewer.element('div', { class: 'choices' }, ...boxes), colour, size);
  }

  volumeControls(withVolume) {
    const set = (key, convert) => (value) => {
      this.state[key] = convert(value);
      this.showVolume();
    };
    const names = withVolume.map((index) => [index, this.results[index].name]);
    return viewer.group(
      'Volume',
      viewer.select('Show', 'volume-mode', kModes, this.state.mode, set('mode', String)),
      viewer.select('Of', 'volume-of', names, this.state.volumeOf, set('volumeOf', Number)),
      viewer.slider('Threshold', 'threshold', { min: 1, max: 99 }, this.state.threshold, (value) => `${value} %`, (value) => {
        this.state.threshold = value;
        this.updateVolume();
        this.describe();
        this.stage.invalidate(true);
      }),
      viewer.element('p', { class: 'view-hint' }, 'The surface, or the faintest light shown, as a fraction of the largest value.'),
    );
  }

  sceneControls() {
    const parts = [];
    const add = (name, control, isPresent, setVisible, isOn = true) => {
      if (!isPresent) return;
      parts.push(viewer.check(name, control, isOn, (on) => {
        setVisible(on);
        this.stage.invalidate();
      }));
    };
    const { wall, sensing, illumination, truth } = this.metadata;
    add('Relay wall', 'wall', wall, (on) => { if (this.wall) this.wall.visible = on; });
    add('Scan points', 'scan-points', sensing || illumination, (on) => {
      for (const { object } of this.scan) object.visible = on;
    });
    add('Hidden truth', 'truth', truth, (on) => { if (this.truth) this.truth.visible = on; });
    add('Axes', 'axes', true, (on) => { this.axes.group.visible = on; });
    return viewer.group('Scene', viewer.element('div', { class: 'choices' }, ...parts));
  }

  assemble() {
    const { canvas } = this.stage;
    const bars = viewer.element('div', { class: 'view-bars' }, this.pointsBar.element, this.volumeBar.element);
    this.readout = viewer.element('p', { class: 'view-readout' }, kReadoutHint);
    const picture = viewer.element('div', { class: 'space-picture' }, canvas, this.stage.printCopy, this.views, bars);
    if (this.fields().length > 0) picture.append(this.readout);
    viewer.splitBody(this.view, picture, this.panel, (width) => {
      const height = Math.round(width * kHeights.fraction);
      this.stage.resize(width, Math.min(kHeights.most, Math.max(kHeights.least, height)));
    });
    this.view.body.append(viewer.element('p', { class: 'view-hint' }, kHint));
    viewer.onThemeChange(() => {
      this.update();
      this.stage.renderSharply();  // at once, as printing does not wait for the next frame
    });
    this.stage.onView = (name) => { this.view.root.dataset.camera = name; };
    this.stage.onRendered = () => { this.view.root.dataset.ready = 'true'; };
    canvas.addEventListener('pointermove', (event) => this.point(event));
    canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      this.view.show(false);
      this.view.say('3-D needs WebGL, which the browser has taken away; it may come back.');
    });
    canvas.addEventListener('webglcontextrestored', () => {
      this.view.show(true);
      this.view.say('');
      this.update();
    });
  }

  // ---- What is shown ----

  /** Loads what the page shows at first. A part that fails is left out, and named. */
  async load() {
    const { wall, sensing, illumination, truth } = this.metadata;
    const failures = [];
    const attempt = (what, work) => work.catch((error) => failures.push(`${what} cannot be shown. ${error.message}`));
    const addScan = async (points, colour, pixels) => {
      const object = await viewer.loadScanPoints(points, pixels);
      this.scan.push({ object, colour });
      this.stage.scene.add(object);
    };
    const addWall = async () => this.stage.scene.add((this.wall = viewer.makeWall(wall)));
    const work = [];
    if (wall) work.push(attempt('The relay wall', addWall()));
    if (sensing) work.push(attempt('The scan points', addScan(sensing, 'accent', kDots.sensing)));
    if (illumination) work.push(attempt('The lit points', addScan(illumination, 'error', kDots.lit)));
    if (truth) work.push(attempt('The hidden truth', this.addTruth(truth)));
    for (const index of this.state.results) work.push(attempt(this.results[index].name, this.loadCloud(index)));
    await Promise.all(work);
    this.fitBox();
    this.update();
    await this.showVolume();
    if (failures.length > 0) this.view.say(failures.join(' '));
  }

  async addTruth(truth) {
    this.truth = await viewer.loadTruth(truth);
    this.stage.scene.add(this.truth);
  }

  /** The box around everything: of volumes only the one that is shown. */
  fitBox() {
    const box = new THREE.Box3();
    const { wall, truth } = this.metadata;
    const include = ({ low, high }) => {
      box.expandByPoint(new THREE.Vector3(...low)).expandByPoint(new THREE.Vector3(...high));
    };
    if (this.wall) include({ low: [wall.x_m[0], wall.y_m[0], 0], high: [wall.x_m[1], wall.y_m[1], 0] });
    if (truth && this.truth) include(truth.positions);
    for (const index of this.clouds.keys()) include(this.results[index].points.positions);
    if (this.volume) box.union(this.volume.bounds);
    if (box.isEmpty()) box.copy(this.stage.box);
    const least = 0.02 * box.getSize(new THREE.Vector3()).length() || 0.1;
    box.expandByVector(new THREE.Vector3(0, 0, box.max.z - box.min.z < least ? least : 0));
    this.stage.box = box;
  }

  async loadCloud(index) {
    const lift = 0.015 * this.sceneSize();
    const cloud = await viewer.loadCloud(this.results[index], lift);
    this.clouds.set(index, cloud);
    this.stage.scene.add(cloud.object);
  }

  sceneSize() {
    const { x_m: x, y_m: y } = this.metadata.wall || {};
    return viewer.isRange(x) && viewer.isRange(y) ? Math.hypot(x[1] - x[0], y[1] - y[0]) : 1;
  }

  async showResult(index, isOn) {
    if (isOn) this.state.results.add(index);
    else this.state.results.delete(index);
    try {
      if (isOn && !this.clouds.has(index)) await this.loadCloud(index);
      this.view.say('');
    } catch (error) {
      this.view.say(`${this.results[index].name} cannot be shown. ${error.message}`);
    }
    this.fitBox();
    this.update();
  }

  async showVolume() {
    const { mode, volumeOf } = this.state;
    try {
      if (mode === 'none') this.removeVolume();
      else if (!this.volume || this.volume.index !== volumeOf) await this.loadVolume(volumeOf);
      if (this.volume && mode === this.state.mode) this.volume.setMode(mode);
      this.view.say('');
    } catch (error) {
      this.removeVolume();
      this.view.say(`The volume cannot be shown. ${error.message}`);
    }
    this.fitBox();
    this.update();
  }

  async loadVolume(index) {
    this.view.say('Loading the volume \u2026');
    const loaded = await viewer.loadVolume(this.results[index].volume);
    if (index !== this.state.volumeOf || this.state.mode === 'none') return;
    this.removeVolume();
    const volume = viewer.makeVolume(this.stage, loaded, viewer.resultColour(index));
    this.volume = Object.assign(volume, { index, high: loaded.quantity.high });
    this.stage.scene.add(volume.object);
  }

  removeVolume() {
    if (!this.volume) return;
    this.stage.scene.remove(this.volume.object);
    this.volume.dispose();
    this.volume = null;
  }

  // ---- Appearance ----

  /** Brings everything in line with the state and the page's colours, and draws. */
  update() {
    const theme = viewer.theme();
    this.stage.setBackground(theme.panel);
    this.axes.build(this.stage.box, theme);
    if (this.wall) this.wall.setColour(theme.accent);
    if (this.truth) this.truth.setColour(theme.dark);
    for (const { object, colour } of this.scan) {
      const element = viewer.elementOfCss(theme[colour]);
      viewer.tintCloud(object, () => element);
    }
    this.updateClouds();
    this.updateVolume();
    this.describe();
    this.stage.invalidate();
  }

  /** The scale of a field, shared by all results. */
  fieldScale(name) {
    const fields = this.fields().filter((field) => field.name === name);
    const ranges = fields.map((field) => field.range || [field.values.low, field.values.high]);
    const { colours, unit } = fields[0];
    const scale = viewer.makeScale('linear', ...viewer.colourRange(colours, viewer.unionOfRanges(ranges)));
    return { scale, colours, unit };
  }

  updateClouds() {
    const { colour, results, pointSize } = this.state;
    const field = colour === kByResult ? null : this.fieldScale(colour);
    for (const [index, cloud] of this.clouds) {
      cloud.object.visible = results.has(index);
      cloud.object.material.uniforms.diameter.value = (cloud.pitch * pointSize) / 100;
      const quantity = field && cloud.fields.get(colour);
      const lookup = quantity && viewer.colourValues(quantity.values, field.scale, field.colours);
      const own = viewer.elementOfCss(viewer.resultColour(index));
      if (field) viewer.tintCloud(cloud.object, (i) => (lookup ? lookup[quantity.codes[i]] : 0));
      else viewer.tintCloud(cloud.object, () => own);
    }
    this.pointsBar.element.hidden = !field || results.size === 0;
    if (!field) return;
    const title = viewer.titleWithUnit(viewer.capitalised(colour) + ' of the points', field.unit);
    this.pointsBar.set(field.scale, field.colours, title);
  }

  updateVolume() {
    const isMaximum = this.volume && this.state.mode === 'maximum';
    if (this.volume) this.volume.setThreshold(this.state.threshold / 100);
    this.stage.isHeavy = Boolean(this.volume);
    this.volumeBar.element.hidden = !isMaximum;
    if (!isMaximum) return;
    this.volumeBar.set(viewer.makeScale('linear', 0, this.volume.high), 'heat', 'Maximum of the volume along each ray');
  }

  describe() {
    const { results, colour, mode, volumeOf, threshold } = this.state;
    const names = [...results].map((index) => this.results[index].name);
    const parts = [this.wall && 'the relay wall', this.truth && 'the hidden truth'];
    parts.push(...names.map((name) => 'points of ' + name));
    if (this.volume) parts.push('the volume of ' + this.results[this.volume.index].name);
    this.stage.canvas.setAttribute('aria-label', `3-D view of ${parts.filter(Boolean).join(', ') || 'an empty scene'}`);
    const shown = [...results].sort((a, b) => a - b).join(',');
    Object.assign(this.view.root.dataset, { results: shown, colour, mode, threshold });
    if (volumeOf !== undefined) this.view.root.dataset.volumeOf = volumeOf;
  }

  /** Tells what lies under the pointer, unless it turns the scene. */
  point(event) {
    if (event.buttons !== 0) return;
    this.readout.textContent = viewer.pointUnder(this.stage, this.clouds, this.results, event) || kReadoutHint;
  }

  save() {
    viewer.savePicture(this.stage, [this.pointsBar, this.volumeBar].filter((bar) => !bar.element.hidden));
  }
}

viewer.views.space = async function (view) {
  await new Space(view).load();
};
