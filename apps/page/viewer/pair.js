// SPDX-License-Identifier: MIT
// Two results as one picture with a divider: left of it the one, right of it the other.

const kTallest = 560;  // pixels
const kHandle = 11;    // pixels, radius of the divider's handle

const columnsWith = (results, name) => viewer.resultsWith(results, (result) => viewer.mapOf(result, name));

const optionsOf = (columns) => columns.map(({ result, index }) => [index, result.name]);

function paintDivider(context, { area }, position) {
  const x = area.left + (area.width * position) / 100;
  const y = area.top + area.height / 2;
  viewer.strokeVisibly(context, (path) => {
    path.moveTo(x, area.top);
    path.lineTo(x, area.top + area.height);
  });
  context.beginPath();
  context.arc(x, y, kHandle, 0, 2 * Math.PI);
  context.fillStyle = '#ffffff';
  context.fill();
  context.strokeStyle = 'rgba(0,0,0,0.65)';
  context.lineWidth = 1;
  context.stroke();
  context.beginPath();
  for (const side of [-1, 1]) {
    context.moveTo(x + side * 3, y - 4);
    context.lineTo(x + side * 7, y);
    context.lineTo(x + side * 3, y + 4);
  }
  context.fillStyle = '#333333';
  context.fill();
}

function paintSide(context, plot, side, from, to) {
  if (!side) return;
  const { left, top, width, height } = plot.area;
  context.save();
  context.beginPath();
  context.rect(left + (width * from) / 100, top, (width * (to - from)) / 100, height);
  context.clip();
  viewer.paintBitmap(context, plot, side.bitmap, side.map.x_m, side.map.y_m);
  context.restore();
}

class Pair {
  constructor(view, names) {
    this.view = view;
    this.results = view.metadata.results;
    this.state = { name: names[0], left: 0, right: view.metadata.best || 1, position: 50 };
    this.sides = [null, null];
    this.makeControls(names);
    this.makePicture();
    this.chooseColumns();
  }

  makeControls(names) {
    const change = (key, convert) => (value) => {
      this.state[key] = convert(value);
      if (key === 'name') this.chooseColumns();
      this.refresh();
    };
    const named = names.map((name) => [name, name]);
    this.name = viewer.select('Map', 'map', named, this.state.name, change('name', String));
    this.left = viewer.select('Left', 'left', [], 0, change('left', Number));
    this.right = viewer.select('Right', 'right', [], 1, change('right', Number));
    const describe = (percent) => `${Math.round(percent)} %`;
    this.slider = viewer.slider('Divider', 'divider', { min: 0, max: 100 }, 50, describe, (value) => this.moveTo(value));
    this.bar = viewer.createColourBar('colour-bar');
    this.labels = [viewer.element('b', {}), viewer.element('b', {})];
    this.readout = viewer.element('p', { class: 'view-readout', 'aria-live': 'polite' });
    const swap = viewer.button('Swap', 'swap', () => {
      [this.state.left, this.state.right] = [this.state.right, this.state.left];
      this.chooseColumns();
      this.refresh();
    });
    this.panel = viewer.element(
      'div',
      { class: 'view-panel' },
      viewer.group('Compare', this.name, this.left, this.right, this.slider, swap),
      this.bar.element,
      this.readout,
    );
  }

  makePicture() {
    this.plot = viewer.createPlot({
      label: 'Two results side by side',
      control: 'picture',
      paint: (context, plot) => {
        viewer.paintMissing(context, plot);
        paintSide(context, plot, this.sides[0], 0, this.state.position);
        paintSide(context, plot, this.sides[1], this.state.position, 100);
        paintDivider(context, plot, this.state.position);
      },
      onPoint: (what, x, y) => this.point(what, x, y),
    });
    this.plot.canvas.classList.add('plot-drag');
    const picture = viewer.element(
      'div',
      { class: 'pair-picture' },
      viewer.element('div', { class: 'pair-labels' }, ...this.labels),
      this.plot.canvas,
    );
    this.frame = picture;
    viewer.splitBody(this.view, picture, this.panel, (width) => {
      this.width = width;
      this.layOut();
    });
  }

  /** Offers the columns that have the chosen map, and keeps a choice where it still can be. */
  chooseColumns() {
    const columns = columnsWith(this.results, this.state.name);
    const has = (index) => columns.some((column) => column.index === index);
    if (!has(this.state.left)) this.state.left = columns[0].index;
    if (!has(this.state.right) || this.state.right === this.state.left) {
      this.state.right = columns.find((column) => column.index !== this.state.left).index;
    }
    this.left.setOptions(optionsOf(columns), this.state.left);
    this.right.setOptions(optionsOf(columns), this.state.right);
  }

  async load(index) {
    const map = viewer.mapOf(this.results[index], this.state.name);
    const loaded = await viewer.loadMap(map);
    return Object.assign(loaded, { bitmap: viewer.bitmapOfMap(loaded, viewer.scaleOfMap(map), map.colours) });
  }

  /** Loads what is chosen and shows it; a later choice overtakes an earlier one. */
  async refresh() {
    const { name, left, right } = this.state;
    try {
      const sides = await Promise.all([this.load(left), this.load(right)]);
      if (name !== this.state.name || left !== this.state.left || right !== this.state.right) return;
      this.sides = sides;
      this.view.say('');
    } catch (error) {
      this.sides = [null, null];
      this.view.say(error.message);
    }
    this.showState();
    this.layOut();
  }

  showState() {
    const { name, left, right, position } = this.state;
    const maps = [left, right].map((index) => viewer.mapOf(this.results[index], name));
    const names = [left, right].map((index) => this.results[index].name);
    this.bar.set(viewer.scaleOfMap(maps[0]), maps[0].colours, viewer.titleWithUnit(name, maps[0].unit));
    this.labels.forEach((label, i) => { label.textContent = names[i]; });
    this.plot.x = viewer.linearAxis(viewer.unionOfRanges(maps.map((map) => map.x_m)), viewer.wallTitles[0], true);
    this.plot.y = viewer.linearAxis(viewer.unionOfRanges(maps.map((map) => map.y_m)), viewer.wallTitles[1]);
    this.plot.setLabel(`${name}: ${names[0]} left of the divider, ${names[1]} right of it`);
    this.readout.textContent = 'Drag the divider to compare. Point at the picture to read both values.';
    Object.assign(this.view.root.dataset, { left, right, position, map: name });
  }

  layOut() {
    if (!this.width || !this.plot.x) return;
    viewer.fitToScale(this.plot, this.width, kTallest);
    this.frame.style.width = this.plot.width + 'px';
  }

  moveTo(position) {
    this.state.position = position;
    this.slider.show(position);
    this.view.root.dataset.position = String(Math.round(position));
    this.plot.draw();
  }

  point(what, x, y) {
    if (what === 'leave') return;
    if (what !== 'move') {
      const { area } = this.plot;
      this.moveTo(((this.plot.toX(x) - area.left) / area.width) * 100);
    }
    if (!this.sides[0]) return;
    const [left, right] = this.sides.map((side, i) => {
      const result = this.results[i === 0 ? this.state.left : this.state.right];
      return `${result.name} ${viewer.mapValueText(side.map, side.valueAt(x, y))}`;
    });
    this.readout.textContent = `At ${viewer.positionText(x, y)}. ${this.state.name}: ${left}; ${right}.`;
  }
}

viewer.views.pair = async function (view) {
  const { results } = view.metadata;
  const names = viewer.mapNames(results).filter((name) => columnsWith(results, name).length > 1);
  if (names.length === 0) return view.hide();
  await new Pair(view, names).refresh();
};
