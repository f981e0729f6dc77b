// SPDX-License-Identifier: MIT
// Slices through a volume: front, side and top views with linked cross-hairs.

const kAxes = ['x', 'y', 'z'];
const kGap = 16;         // pixels between the views
const kTallest = 760;    // pixels, of two views above each other
const kStackBelow = 520; // pixels: narrower pages show the views one below the other
const kLogSpan = 1e-3;   // of the logarithmic scale

// What each view shows: its horizontal and vertical axis, and the axis it cuts at one place.
const kViews = [
  { name: 'Front view, as an eye at the wall sees', across: 0, up: 1, cut: 2, reversed: true },
  { name: 'Side view', across: 2, up: 1, cut: 0, reversed: false },
  { name: 'Top view', across: 0, up: 2, cut: 1, reversed: true },
];

class Slices {
  constructor(view, choices) {
    this.view = view;
    this.choices = choices;
    const best = choices.find(({ index }) => index === view.metadata.best) || choices[0];
    this.state = { result: best.index, kind: 'linear', voxel: [0, 0, 0] };
    this.makeControls();
    this.makeViews();
  }

  makeControls() {
    const names = this.choices.map(({ result, index }) => [index, result.name]);
    const result = viewer.select('Result', 'result', names, this.state.result, (value) => {
      this.state.result = Number(value);
      this.load();
    });
    const kind = viewer.select('Values', 'value-scale', viewer.valueScales, this.state.kind, (value) => {
      this.state.kind = value;
      this.recolour();
    });
    const peak = viewer.button('Go to the brightest voxel', 'brightest', () => this.moveTo(this.brightestVoxel()));
    this.bar = viewer.createColourBar('colour-bar');
    this.readout = viewer.element('p', { class: 'view-readout', 'aria-live': 'polite' });
    this.note = viewer.element('p', { class: 'view-hint' });
    this.choice = viewer.group('Volume', result, kind);
    this.peak = peak;
  }

  makeViews() {
    this.grid = viewer.element('div', { class: 'slices-grid' });
    this.plots = kViews.map((shown) => {
      const plot = viewer.createPlot({
        label: shown.name,
        control: 'slice-' + kAxes[shown.across] + kAxes[shown.up],
        focusable: true,
        paint: (context) => this.paint(context, shown),
        onPoint: (what, a, b) => this.point(shown, what, a, b),
        onKey: (event) => this.key(shown, event),
      });
      this.grid.append(plot.canvas);
      return plot;
    });
    this.sliders = kAxes.map((axis, i) =>
      viewer.slider(viewer.capitalised(viewer.wallAxes[i]), 'slider-' + axis, { min: 0, max: 0 }, 0,
        (voxel) => this.positionWords(i, voxel),
        (voxel) => this.moveTo(this.state.voxel.map((old, k) => (k === i ? voxel : old)))),
    );
    const cuts = viewer.group('Where it is cut', ...this.sliders, this.peak);
    const panel = viewer.element('div', { class: 'view-panel' }, this.choice, cuts, this.bar.element, this.readout, this.note);
    viewer.splitBody(this.view, this.grid, panel, (width) => {
      this.width = width;
      this.layOut();
    });
  }

  async load() {
    const chosen = this.state.result;
    const { result } = this.choices.find(({ index }) => index === chosen);
    this.view.say('Loading the volume \u2026');
    try {
      const volume = await viewer.loadVolume(result.volume);
      if (chosen !== this.state.result) return;
      const isFirst = !this.volume;
      this.volume = volume;
      this.view.say('');
      this.adopt(isFirst);
    } catch (error) {
      this.view.say(`The volume of ${result.name} cannot be shown. ${error.message}`);
    }
  }

  /** Fits axes and sliders to the present volume; a first one is shown at its brightest voxel. */
  adopt(isFirst) {
    const { size, edges, reduced } = this.volume;
    this.sliders.forEach((slider, i) => { slider.input.max = String(size[i] - 1); });
    kViews.forEach((shown, i) => {
      this.plots[i].x = viewer.linearAxis(edges[shown.across], viewer.wallTitles[shown.across], shown.reversed);
      this.plots[i].y = viewer.linearAxis(edges[shown.up], viewer.wallTitles[shown.up]);
    });
    this.note.textContent = `${size.join(' \u00d7 ')} voxels.` + (reduced ? ` Reduced: ${reduced}.` : '');
    this.view.root.dataset.result = String(this.state.result);
    this.layOut();
    if (isFirst) this.state.voxel = this.brightestVoxel();
    this.recolour();
  }

  recolour() {
    if (!this.volume) return;
    const { values, high } = this.volume.quantity;
    const low = this.state.kind === 'log' ? high * kLogSpan : 0;
    const scale = viewer.makeScale(this.state.kind, low, high);
    this.lookup = viewer.colourValues(values, scale, 'heat');
    this.bar.set(scale, 'heat', 'Value of the reconstruction');
    this.view.root.dataset.valueScale = this.state.kind;
    this.moveTo(this.state.voxel);
  }

  brightestVoxel() {
    const { size, quantity } = this.volume;
    let best = 0;
    for (let i = 1; i < quantity.codes.length; ++i) {
      if (quantity.codes[i] > quantity.codes[best]) best = i;
    }
    return [Math.floor(best / (size[1] * size[2])), Math.floor(best / size[2]) % size[1], best % size[2]];
  }

  centre(axis, voxel) {
    const [low, high] = this.volume.edges[axis];
    return low + ((voxel + 0.5) / this.volume.size[axis]) * (high - low);
  }

  voxelAt(axis, position) {
    const [low, high] = this.volume.edges[axis];
    return Math.floor(((position - low) / (high - low)) * this.volume.size[axis]);
  }

  positionWords(axis, voxel) {
    return this.volume ? viewer.formatFixed(this.centre(axis, voxel)) + ' m' : '';
  }

  /** Moves the cross to a voxel (the nearest inside) and shows the three slices through it. */
  moveTo(voxel) {
    const { size } = this.volume;
    this.state.voxel = voxel.map((index, axis) => viewer.clampIndex(index, size[axis]));
    this.sliders.forEach((slider, axis) => slider.show(this.state.voxel[axis]));
    const [ix, iy, iz] = this.state.voxel;
    Object.assign(this.view.root.dataset, { ix, iy, iz });
    this.bitmaps = kViews.map((shown) => this.sliceBitmap(shown));
    this.describe(this.state.voxel);
    this.plots.forEach((plot, i) => {
      const { cut, name } = kViews[i];
      plot.setLabel(`${name} at ${viewer.wallAxes[cut]} ${this.positionWords(cut, this.state.voxel[cut])}`);
      plot.draw();
    });
  }

  sliceBitmap({ across, up, cut, reversed }) {
    const { size, quantity } = this.volume;
    const strides = [size[1] * size[2], size[2], 1];
    const base = this.state.voxel[cut] * strides[cut];
    return viewer.makeBitmap(size[across], size[up], (column, row) => {
      const a = reversed ? size[across] - 1 - column : column;
      const b = size[up] - 1 - row;
      return this.lookup[quantity.codes[base + a * strides[across] + b * strides[up]]];
    });
  }

  paint(context, shown) {
    if (!this.bitmaps) return;
    const i = kViews.indexOf(shown);
    const { edges } = this.volume;
    viewer.paintBitmap(context, this.plots[i], this.bitmaps[i], edges[shown.across], edges[shown.up]);
    const at = (axis) => this.centre(axis, this.state.voxel[axis]);
    viewer.paintCross(context, this.plots[i], at(shown.across), at(shown.up));
  }

  describe(voxel) {
    const place = viewer.placeText(voxel.map((index, axis) => this.centre(axis, index)));
    const { size, quantity } = this.volume;
    const value = quantity.at((voxel[0] * size[1] + voxel[1]) * size[2] + voxel[2]);
    this.readout.textContent = `Voxel at ${place}: value ${viewer.formatNumber(value)}.`;
  }

  point(shown, what, a, b) {
    if (!this.volume) return;
    if (what === 'leave') {
      this.describe(this.state.voxel);
      return;
    }
    const voxel = this.state.voxel.slice();
    for (const [axis, position] of [[shown.across, a], [shown.up, b]]) {
      voxel[axis] = viewer.clampIndex(this.voxelAt(axis, position), this.volume.size[axis]);
    }
    if (what === 'move') this.describe(voxel);
    else this.moveTo(voxel);
  }

  key(shown, event) {
    const step = viewer.stepOfKey(event.key);
    const cuts = { PageUp: 1, PageDown: -1 };
    const voxel = this.state.voxel.slice();
    if (step) {
      voxel[shown.across] += step[0] * (shown.reversed ? -1 : 1);
      voxel[shown.up] += step[1];
    } else if (cuts[event.key]) {
      voxel[shown.cut] += cuts[event.key];
    } else {
      return;
    }
    event.preventDefault();
    if (this.volume) this.moveTo(voxel);
  }

  /** One scale for all three views, so that a metre is as long everywhere. */
  layOut() {
    if (!this.width || !this.volume) return;
    const [x, y, z] = this.volume.edges.map(([low, high]) => high - low);
    const { sides, ends } = this.plots[0];
    const isStacked = this.width < kStackBelow;
    const perMetre = isStacked
      ? (this.width - sides) / Math.max(x, z)
      : Math.min((this.width - kGap - 2 * sides) / (x + z), (kTallest - 2 * ends) / (y + z));
    this.grid.classList.toggle('stacked', isStacked);
    const spans = [x, y, z];
    kViews.forEach(({ across, up }, i) => {
      this.plots[i].resize(spans[across] * perMetre + sides, spans[up] * perMetre + ends);
    });
  }
}

viewer.views.slices = async function (view) {
  const choices = viewer.resultsWith(view.metadata.results, (result) => result.volume);
  if (choices.length === 0) return view.hide();
  await new Slices(view, choices).load();
};
