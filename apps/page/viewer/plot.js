// SPDX-License-Identifier: MIT
// A canvas with axes: pictures over the wall, slices, histograms and colour bars are drawn on it.

const kMargins = { left: 56, right: 14, top: 10, bottom: 42 };
const kNoMargins = { left: 0, right: 0, top: 0, bottom: 0 };
const kFont = '12px system-ui, -apple-system, "Segoe UI", Roboto, Arial, sans-serif';
const kPixelsPerTick = { x: 56, y: 44 };

/**
 * Makes a plot. `options`: `label` (what the picture shows, for readers who do not see it),
 * `control` (its data-control), `margins` (null: none), `focusable`, and the callbacks
 * `paint(context, plot)` inside the axes, `onPoint(what, x, y)` with what = move, press, drag or
 * leave, and `onKey(event)`.
 *
 * An axis is {scale, reversed, title, format}; x runs to the right and y upwards unless reversed.
 */
viewer.createPlot = function (options) {
  const canvas = viewer.element('canvas', {
    class: 'plot',
    role: 'img',
    'aria-label': options.label,
    'data-control': options.control,
    tabindex: options.focusable ? 0 : null,
  });
  const margins = options.margins === null ? kNoMargins : Object.assign({}, kMargins, options.margins);
  const plot = {
    canvas,
    margins,
    sides: margins.left + margins.right,
    ends: margins.top + margins.bottom,
    area: { left: 0, top: 0, width: 0, height: 0 },
    x: null,
    y: null,
    toX: (value) => plot.area.left + plot.area.width * directed(plot.x, plot.x.scale.toUnit(value)),
    toY: (value) => plot.area.top + plot.area.height * (1 - directed(plot.y, plot.y.scale.toUnit(value))),
    setLabel: (text) => canvas.setAttribute('aria-label', text),
  };
  plot.draw = () => draw(plot, options.paint);
  plot.resize = (width, height) => resize(plot, width, height);
  if (options.onPoint) listenToPointer(plot, options.onPoint);
  if (options.onKey) canvas.addEventListener('keydown', options.onKey);
  viewer.onThemeChange(plot.draw);
  return plot;
};

function directed(axis, fraction) {
  return axis.reversed ? 1 - fraction : fraction;
}

function resize(plot, width, height) {
  const ratio = Math.max(1, window.devicePixelRatio || 1);
  const { canvas, margins } = plot;
  canvas.width = Math.max(1, Math.round(width * ratio));
  canvas.height = Math.max(1, Math.round(height * ratio));
  canvas.style.width = Math.round(width) + 'px';  // the height follows
  plot.width = width;
  plot.height = height;
  plot.area = {
    left: margins.left,
    top: margins.top,
    width: Math.max(1, width - plot.sides),
    height: Math.max(1, height - plot.ends),
  };
  plot.draw();
}

/** Gives a plot the size at which a metre is as long on x as on y; returns pixels per metre. */
viewer.fitToScale = function (plot, maxWidth, maxHeight) {
  const { sides, ends, x, y } = plot;
  const spanX = x.scale.high - x.scale.low;
  const spanY = y.scale.high - y.scale.low;
  const perMetre = Math.min((maxWidth - sides) / spanX, (maxHeight - ends) / spanY);
  plot.resize(spanX * perMetre + sides, spanY * perMetre + ends);
  return perMetre;
};

function draw(plot, paint) {
  if (!plot.x || !plot.y || !plot.width) return;
  const context = plot.canvas.getContext('2d');
  const ratio = plot.canvas.width / plot.width;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, plot.width, plot.height);
  const { left, top, width, height } = plot.area;
  context.save();
  context.beginPath();
  context.rect(left, top, width, height);
  context.clip();
  paint(context, plot);
  context.restore();
  if (plot.margins === kNoMargins) return;
  drawAxes(context, plot, viewer.theme());
}

function drawAxes(context, plot, theme) {
  const { left, top, width, height } = plot.area;
  context.font = kFont;
  context.strokeStyle = theme.soft;
  context.fillStyle = theme.soft;
  context.lineWidth = 1;
  context.strokeRect(left + 0.5, top + 0.5, width - 1, height - 1);
  drawTicksX(context, plot);
  if (plot.margins.left > 20) drawTicksY(context, plot);
}

function tickText(axis, value) {
  return axis.format ? axis.format(value) : viewer.formatNumber(value, 3);
}

function drawTicksX(context, plot) {
  const { left, top, width, height } = plot.area;
  const bottom = top + height;
  context.textAlign = 'center';
  context.textBaseline = 'top';
  const taken = [];
  for (const value of plot.x.scale.ticks(Math.max(2, Math.round(width / kPixelsPerTick.x)))) {
    const x = plot.toX(value);
    const text = tickText(plot.x, value);
    const half = context.measureText(text).width / 2;
    const middle = Math.min(plot.width - half, Math.max(half, x));
    context.fillRect(Math.min(x, left + width - 1), bottom, 1, 4);
    if (taken.some(([from, to]) => middle + half + 6 > from && middle - half - 6 < to)) continue;
    taken.push([middle - half, middle + half]);
    context.fillText(text, middle, bottom + 7);
  }
  if (plot.x.title) context.fillText(plot.x.title, left + width / 2, bottom + 24);
}

function drawTicksY(context, plot) {
  const { left, top, height } = plot.area;
  context.textAlign = 'right';
  context.textBaseline = 'middle';
  let last = Infinity;
  for (const value of plot.y.scale.ticks(Math.max(2, Math.round(height / kPixelsPerTick.y)))) {
    const y = plot.toY(value);
    context.fillRect(left - 4, Math.min(y, top + height - 1), 4, 1);
    if (Math.abs(y - last) < 15) continue;
    last = y;
    context.fillText(tickText(plot.y, value), left - 7, Math.max(top + 5, y));
  }
  if (!plot.y.title) return;
  context.save();
  context.translate(10, top + height / 2);
  context.rotate(-Math.PI / 2);
  context.textAlign = 'center';
  context.fillText(plot.y.title, 0, 0);
  context.restore();
}

function listenToPointer(plot, onPoint) {
  const { canvas } = plot;
  let isDown = false;
  const report = (what, event) => {
    const box = canvas.getBoundingClientRect();
    const zoom = box.width / plot.width;  // below one where the style sheet shrinks the canvas
    const { left, top, width, height } = plot.area;
    const fractionX = ((event.clientX - box.left) / zoom - left) / width;
    const fractionY = 1 - ((event.clientY - box.top) / zoom - top) / height;
    const inside = fractionX >= 0 && fractionX <= 1 && fractionY >= 0 && fractionY <= 1;
    if (!inside && what !== 'drag') {
      onPoint('leave');
      return false;
    }
    const clamp = (fraction) => Math.min(1, Math.max(0, fraction));
    const x = plot.x.scale.fromUnit(directed(plot.x, clamp(fractionX)));
    const y = plot.y.scale.fromUnit(directed(plot.y, clamp(fractionY)));
    onPoint(what, x, y);
    return true;
  };
  canvas.addEventListener('pointerdown', (event) => {
    if (event.button !== 0) return;
    isDown = report('press', event);
    if (isDown) canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener('pointermove', (event) => report(isDown ? 'drag' : 'move', event));
  for (const ending of ['pointerup', 'pointercancel']) {
    canvas.addEventListener(ending, () => { isDown = false; });
  }
  canvas.addEventListener('pointerleave', () => {
    if (!isDown) onPoint('leave');
  });
}

// ---- Things drawn on plots ----

/** An axis in metres or the like, from low to high. */
viewer.linearAxis = function ([low, high], title, reversed = false) {
  return { scale: viewer.makeScale('linear', low, high), reversed, title };
};

/** Draws a bitmap over the ranges that it covers, every element as a sharp rectangle. */
viewer.paintBitmap = function (context, plot, bitmap, [x0, x1], [y0, y1]) {
  // Positions outside the axes are needed as well, which toX and toY would clamp.
  const along = (axis, value) => directed(axis, (value - axis.scale.low) / (axis.scale.high - axis.scale.low));
  const { left, top, width, height } = plot.area;
  const xs = [x0, x1].map((value) => left + width * along(plot.x, value));
  const ys = [y0, y1].map((value) => top + height * (1 - along(plot.y, value)));
  context.imageSmoothingEnabled = false;
  context.drawImage(bitmap, Math.min(...xs), Math.min(...ys), Math.abs(xs[1] - xs[0]), Math.abs(ys[1] - ys[0]));
};

/** Fills the axes with the colour that stands for missing values. */
viewer.paintMissing = function (context, { area }) {
  context.fillStyle = viewer.theme().missing;
  context.fillRect(area.left, area.top, area.width, area.height);
};

/** Strokes a path so that it shows on light and dark ground alike. */
viewer.strokeVisibly = function (context, makePath) {
  for (const [colour, width] of [['rgba(0,0,0,0.6)', 2.5], ['#ffffff', 1]]) {
    context.beginPath();
    makePath(context);
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.stroke();
  }
};

/** A cross-hair through a position, open in the middle. */
viewer.paintCross = function (context, plot, x, y) {
  const [px, py] = [plot.toX(x), plot.toY(y)];
  const { left, top, width, height } = plot.area;
  const gap = 5;
  viewer.strokeVisibly(context, (path) => {
    path.moveTo(left, py);
    path.lineTo(px - gap, py);
    path.moveTo(px + gap, py);
    path.lineTo(left + width, py);
    path.moveTo(px, top);
    path.lineTo(px, py - gap);
    path.moveTo(px, py + gap);
    path.lineTo(px, top + height);
  });
};

// ---- Colour bars ----

/** A horizontal colour bar; set() gives it its scale, colours and title. */
viewer.createColourBar = function (control, width = 260) {
  let table = viewer.colourTable('heat');
  const title = viewer.element('span', { class: 'bar-title' });
  const plot = viewer.createPlot({
    label: 'Colour bar',
    control,
    margins: { left: 8, right: 8, top: 2, bottom: 24 },
    paint: (context, { area }) => {
      const bar = viewer.makeBitmap(256, 1, (column) => table[column]);
      context.imageSmoothingEnabled = true;
      context.drawImage(bar, area.left, area.top, area.width, area.height);
    },
  });
  plot.y = viewer.linearAxis([0, 1], '');
  const element = viewer.element('div', { class: 'colour-bar' }, title, plot.canvas);
  const set = (scale, colours, text, format) => {
    table = viewer.colourTable(colours);
    plot.x = { scale, title: '', format };
    title.textContent = text;
    const ends = [scale.low, scale.high].map((value) => viewer.formatNumber(value, 3));
    plot.setLabel(`Colour bar: ${text}, from ${ends[0]} to ${ends[1]}`);
    if (plot.width) plot.draw();
    else plot.resize(width, 42);
  };
  return { element, set, canvas: plot.canvas, title };
};
