// SPDX-License-Identifier: MIT
// The transient of one point: light by path length, with a cursor at the present bin.

const kHeadroom = 1.05;  // the axis ends a little above the largest value

/** Traces steps of values over bins, from the first to the last shown. */
function traceSteps(context, plot, data, values, [first, last]) {
  for (let bin = first; bin <= last; ++bin) {
    const y = plot.toY(values[bin]);
    if (bin === first) context.moveTo(plot.toX(data.edge(bin)), y);
    else context.lineTo(plot.toX(data.edge(bin)), y);
    context.lineTo(plot.toX(data.edge(bin + 1)), y);
  }
}

function paintMean(context, plot, data, range) {
  const bottom = plot.area.top + plot.area.height;
  context.beginPath();
  traceSteps(context, plot, data, data.means, range);
  context.lineTo(plot.toX(data.edge(range[1] + 1)), bottom);
  context.lineTo(plot.toX(data.edge(range[0])), bottom);
  context.fillStyle = viewer.theme().line;
  context.fill();
}

function paintPoint(context, plot, data, values, range) {
  context.beginPath();
  traceSteps(context, plot, data, values, range);
  context.strokeStyle = viewer.theme().accent;
  context.lineWidth = 1.5;
  context.stroke();
}

function paintCursor(context, plot, data, bin) {
  const x0 = plot.toX(data.edge(bin));
  const x1 = plot.toX(data.edge(bin + 1));
  context.fillStyle = viewer.theme().ink;
  context.globalAlpha = 0.18;
  context.fillRect(x0, plot.area.top, Math.max(1, x1 - x0), plot.area.height);
  context.globalAlpha = 1;
  context.fillRect((x0 + x1) / 2 - 0.5, plot.area.top, 1, plot.area.height);
}

/** Makes the histogram of an animation; `onBin(bin)` is told where it is pressed. */
viewer.createHistogram = function (data, onBin) {
  const shown = { values: null, bin: null, range: [0, data.bins - 1] };
  const plot = viewer.createPlot({
    label: 'Histogram of one point',
    control: 'histogram',
    margins: { left: 80 },  // room for 2 \u00d7 10\u207b\u2074 beside the title
    paint: (context) => {
      if (!shown.values) return;
      paintMean(context, plot, data, shown.range);
      paintPoint(context, plot, data, shown.values, shown.range);
      if (shown.bin !== null) paintCursor(context, plot, data, shown.bin);
    },
    onPoint: (what, x) => {
      if (what === 'press' || what === 'drag') onBin(data.binAt(x));
    },
  });
  const cell = data.animation.kind === 'camera' ? 'pixel' : 'point';
  const legend = viewer.element(
    'p',
    { class: 'animation-legend' },
    viewer.element('span', { class: 'key-line' }, 'this ' + cell),
    viewer.element('span', { class: 'key-area' }, `mean of all ${cell}s`),
  );
  const makeAxis = (scale) => {
    const { factor, text } = scale.kind === 'log' ? { factor: 1, text: '' } : viewer.axisFactor(scale.high);
    const unit = [text, data.animation.unit].filter(Boolean).join(' ');
    const title = viewer.titleWithUnit('light in a ' + data.word, unit);
    return { scale, title, format: (value) => viewer.formatNumber(value / factor, 3) };
  };
  const setRange = (first, last) => {
    shown.range = [first, last];
    plot.x = viewer.linearAxis([data.edge(first), data.edge(last + 1)], data.axisTitle());
    if (data.isFrames) {
      const ticks = plot.x.scale.ticks;
      plot.x.scale.ticks = (count) => ticks(count).filter(Number.isInteger);
    }
  };
  const show = (cell, bin, kind) => {
    shown.values = data.histogram(cell);
    shown.bin = bin;
    const high = Math.max(...shown.values, ...data.means);
    const low = kind === 'log' ? Math.min(data.quantity.low, high / 10) : 0;
    plot.y = makeAxis(viewer.makeScale(kind, low, kHeadroom * high));
    plot.setLabel(`Histogram of the point: largest value ${data.valueText(Math.max(...shown.values))}`);
    plot.draw();
  };
  const element = viewer.element('div', {}, plot.canvas, legend);
  return { element, setRange, show, resize: (width, height) => plot.resize(width, height - 30) };
};
