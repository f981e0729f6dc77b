// SPDX-License-Identifier: MIT
// A capture as an animation: light over the wall (or a camera's pixels) by path length, and histograms.

const kTallest = 460;       // pixels, of the picture
const kNarrow = 720;        // pixels: below, the histogram stands under the picture
const kCurveHeight = 300;   // pixels, of the histogram there
const kStripHeight = 130;   // pixels, of a picture that is one row of cells
const kSumSpan = 1e-4;      // of the logarithmic scale of sums, at most
const kSpeeds = [5, 15, 30, 60];  // bins per second
const kHints = 'Click the picture to pin a point. With the picture in focus: Left and Right step in time, ' +
  'Home and End go to the ends, Shift with arrows moves the point, Space plays.';

class AnimationView {
  constructor(view, layout, data) {
    this.view = view;
    this.layout = layout;
    this.data = data;
    this.animation = data.animation;
    const isCalm = matchMedia('(prefers-reduced-motion: reduce)').matches;
    this.state = {
      bin: Math.min(this.animation.last_lit, Math.max(this.animation.first_lit, data.brightestBin)),
      pinned: data.brightestCell,
      hovered: null,
      kind: 'gamma',
      speed: isCalm ? 5 : 15,
      isStretched: false,
      isAllTime: false,
      isWhole: false,
      timer: null,
    };
    this.makeControls();
    this.makePictures();
    this.makeScrubber();
    this.assemble();
    this.setRange();
    this.recolour();
  }

  makeControls() {
    const set = (key) => (value) => {
      this.state[key] = value;
      this.recolour();
    };
    this.play = viewer.button('Play', 'play', () => this.setPlaying(this.state.timer === null));
    this.allTime = viewer.toggle('All time', 'all-time', false, (on) => {
      this.setPlaying(false);
      set('isAllTime')(on);
    });
    const speeds = kSpeeds.map((value) => [value, `${value} ${this.data.word}s per second`]);
    this.controls = viewer.element(
      'div',
      { class: 'view-controls' },
      this.play,
      this.allTime,
      viewer.select('Speed', 'speed', speeds, this.state.speed, (value) => {
        this.state.speed = Number(value);
        if (this.state.timer !== null) this.setPlaying(true);
      }),
      viewer.select('Values', 'value-scale', viewer.valueScales, this.state.kind, set('kind')),
      viewer.check('Brighten each picture', 'stretch', false, set('isStretched')),
    );
  }

  makePictures() {
    this.picture = viewer.createPlot({
      label: this.animation.name,
      control: 'picture',
      focusable: true,
      margins: this.layout.isStrip ? { left: 14 } : {},
      paint: (context, plot) => this.paint(context, plot),
      onPoint: (what, x, y) => this.point(what, x, y),
      onKey: (event) => this.key(event),
    });
    this.picture.x = this.layout.x;
    this.picture.y = this.layout.y;
    this.bar = viewer.createColourBar('colour-bar');
    this.curve = viewer.createHistogram(this.data, (bin) => this.jumpTo(bin));
  }

  makeScrubber() {
    this.scrubber = viewer.slider(this.data.isFrames ? 'Frame' : 'Time', 'bin', { min: 0, max: 0 }, 0,
      (bin) => this.binWords(bin), (bin) => this.jumpTo(bin));
    this.scrubber.classList.add('animation-scrubber');
    const { first_lit: first, last_lit: last } = this.animation;
    this.whole = first === 0 && last === this.data.bins - 1
      ? null
      : viewer.check('Whole record, with its dark ends', 'whole-record', false, (on) => {
        this.state.isWhole = on;
        this.setRange();
        this.recolour();
      });
  }

  binWords(bin) {
    if (this.state.isAllTime) return 'All time';
    const words = viewer.capitalised(this.data.describe(bin));
    return this.data.isFrames ? words : `${words} (bin ${bin + 1} of ${this.data.bins})`;
  }

  assemble() {
    const { detail, reduced } = this.animation;
    const title = viewer.element('p', { class: 'view-title' }, [detail, reduced].filter(Boolean).join('; '));
    this.readout = viewer.element('p', { class: 'view-readout' });
    const picture = viewer.element('div', { class: 'animation-pane' }, this.picture.canvas, this.bar.element);
    this.curvePane = viewer.element('div', { class: 'animation-pane' }, this.curve.element);
    this.panes = viewer.element('div', { class: 'animation-panes' }, picture, this.curvePane);
    this.view.body.append(title, this.controls, this.scrubber);
    if (this.whole) this.controls.append(this.whole);
    this.view.body.append(this.panes, this.readout, viewer.element('p', { class: 'view-hint' }, kHints));
    viewer.watchWidth(this.view.body, (width) => this.layOut(width));
  }

  layOut(width) {
    const isNarrow = width < kNarrow || Boolean(this.layout.isStrip);
    const pictureWidth = isNarrow ? width : Math.floor(width * 0.44);
    if (this.layout.isStrip) this.picture.resize(width, kStripHeight);
    else viewer.fitToScale(this.picture, pictureWidth, kTallest);
    this.panes.classList.toggle('stacked', isNarrow);
    const height = isNarrow ? kCurveHeight : Math.min(kTallest, Math.max(kCurveHeight, this.picture.height));
    this.curve.resize(isNarrow ? width : width - Math.max(this.picture.width, 276) - 24, height);
  }

  // ---- Time ----

  /** The bins that the scrubber reaches: those with light, or all. */
  range() {
    return this.state.isWhole ? [0, this.data.bins - 1] : [this.animation.first_lit, this.animation.last_lit];
  }

  setRange() {
    const [first, last] = this.range();
    this.scrubber.input.min = String(first);
    this.scrubber.input.max = String(last);
    this.curve.setRange(first, last);
    this.state.bin = Math.min(last, Math.max(first, this.state.bin));
  }

  goTo(bin) {
    const [first, last] = this.range();
    this.state.bin = Math.min(last, Math.max(first, bin));
    if (this.state.isAllTime) {
      this.state.isAllTime = false;
      this.allTime.setAttribute('aria-pressed', 'false');
    }
    this.recolour();
  }

  /** Goes where a hand asks to, which ends the animation. */
  jumpTo(bin) {
    this.setPlaying(false);
    this.goTo(bin);
  }

  setPlaying(isPlaying) {
    clearInterval(this.state.timer);
    this.state.timer = isPlaying ? setInterval(() => this.advance(), 1000 / this.state.speed) : null;
    this.play.textContent = isPlaying ? 'Pause' : 'Play';
    this.view.root.dataset.playing = String(isPlaying);
  }

  advance() {
    const [first, last] = this.range();
    if (!document.hidden) this.goTo(this.state.bin >= last ? first : this.state.bin + 1);
  }

  // ---- Pictures ----

  scaleOf(low, high) {
    const { kind } = this.state;
    return viewer.makeScale(kind, kind === 'log' ? low : 0, high);
  }

  recolour() {
    const { isAllTime, isStretched, bin } = this.state;
    this.colours = isAllTime ? this.colourSums() : this.colourBin(bin, isStretched);
    this.scrubber.show(bin);
    this.showCell();
  }

  colourBin(bin, isStretched) {
    const { quantity, cells, bins } = this.data;
    const high = (isStretched && this.data.largestAt(bin)) || quantity.high;
    const scale = this.scaleOf(quantity.low, high);
    const lookup = viewer.colourValues(quantity.values, scale, 'heat');
    this.bar.set(scale, 'heat', viewer.titleWithUnit('Light in one ' + this.data.word, this.animation.unit));
    const colours = new Uint32Array(cells);
    for (let cell = 0; cell < cells; ++cell) colours[cell] = lookup[quantity.codes[cell * bins + bin]];
    return colours;
  }

  colourSums() {
    const { sums, brightestCell } = this.data;
    const high = sums[brightestCell];
    const least = sums.reduce((low, sum) => (sum > 0 && sum < low ? sum : low), high);
    const scale = this.scaleOf(Math.max(0.9 * least, kSumSpan * high), high);
    this.bar.set(scale, 'heat', viewer.titleWithUnit(`Light summed over all ${this.data.word}s`, this.animation.unit));
    return viewer.colourValues(sums, scale, 'heat');
  }

  paint(context, plot) {
    if (!this.colours) return;
    this.layout.paint(context, plot, this.colours);
    this.paintRing(context, this.state.pinned, 7);
    if (this.state.hovered !== null) this.paintRing(context, this.state.hovered, 4);
  }

  paintRing(context, cell, radius) {
    const [x, y] = this.layout.centre(cell);
    viewer.strokeVisibly(context, (path) => path.arc(this.picture.toX(x), this.picture.toY(y), radius, 0, 2 * Math.PI));
  }

  // ---- Points ----

  shownCell() {
    return this.state.hovered === null ? this.state.pinned : this.state.hovered;
  }

  showCell() {
    const { isAllTime, bin, kind } = this.state;
    this.curve.show(this.shownCell(), isAllTime ? null : bin, kind);
    this.picture.draw();
    this.describe();
  }

  describe() {
    const { isAllTime, bin, kind } = this.state;
    const cell = this.shownCell();
    const value = isAllTime ? this.data.sums[cell] : this.data.value(cell, bin);
    const when = isAllTime ? 'over all time' : `${this.data.isFrames ? 'in' : 'at'} ${this.data.describe(bin)}`;
    this.readout.textContent = `${this.layout.describe(cell)}: ${this.data.valueText(value)} ${when}.`;
    this.picture.setLabel(`${this.animation.name} ${when}. ${this.readout.textContent}`);
    Object.assign(this.view.root.dataset, { bin, cell, valueScale: kind, allTime: isAllTime });
  }

  point(what, x, y) {
    const cell = what === 'leave' ? null : this.layout.cellAt(x, y);
    const isPinning = what === 'press' || what === 'drag';
    if (isPinning) this.state.pinned = cell;
    const hovered = isPinning ? null : cell;
    if (!isPinning && hovered === this.state.hovered) return;
    this.state.hovered = hovered;
    this.showCell();
  }

  key(event) {
    const step = viewer.stepOfKey(event.key);
    const [first, last] = this.range();
    const ends = { Home: first, End: last };
    if (event.shiftKey && step) {
      this.state.hovered = null;
      this.state.pinned = this.layout.neighbour(this.state.pinned, step);
      this.showCell();
    } else if (event.key in ends || (step && step[0] !== 0)) {
      this.jumpTo(event.key in ends ? ends[event.key] : this.state.bin + step[0]);
    } else if (event.key === ' ') {
      this.setPlaying(this.state.timer === null);
    } else {
      return;
    }
    event.preventDefault();
  }
}

viewer.views.animation = async function (view) {
  const animation = view.metadata.animations[Number(view.root.dataset.animation)];
  viewer.require(animation, 'The page does not hold this capture.');
  const layout = await viewer.makeAnimationLayout(animation);
  const data = await viewer.loadAnimation(animation, layout.cells);
  view.root.dataset.playing = 'false';
  new AnimationView(view, layout, data);
};
