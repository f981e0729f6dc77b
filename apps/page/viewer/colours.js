// SPDX-License-Identifier: MIT
// Colour maps as small tables, scales from values to fractions of a colour map, and pictures of both.

const tables = {};

function tableOf(hex) {
  const table = new Uint32Array(hex.length / 6);  // as the four bytes of a picture element
  for (let i = 0; i < table.length; ++i) {
    const byte = (at) => parseInt(hex.slice(6 * i + 2 * at, 6 * i + 2 * at + 2), 16);
    table[i] = (255 << 24) | (byte(2) << 16) | (byte(1) << 8) | byte(0);
  }
  return table;
}

/** 256 colours of a map, each as the picture element 0xAABBGGRR. */
viewer.colourTable = function (name) {
  const maps = viewer.colours.maps;
  const known = Object.prototype.hasOwnProperty.call(maps, name) ? name : 'heat';
  if (!tables[known]) tables[known] = tableOf(maps[known]);
  return tables[known];
};

viewer.resultColour = (index) => viewer.colours.series[index % viewer.colours.series.length];

/** The range that a colour map covers: a diverging one is centred on zero, fractions are 0 to 1. */
viewer.colourRange = function (colours, range) {
  if (colours === 'share') return [0, 1];
  let [low, high] = viewer.isRange(range) ? range : [0, 1];
  if (colours === 'diverging') {
    const reach = Math.max(Math.abs(low), Math.abs(high)) || 1;
    return [-reach, reach];
  }
  return low < high ? [low, high] : [low - 0.5, low + 0.5];
};

// ---- Scales ----

const kDefaultDecades = 1e-4;  // of a logarithmic scale whose range names no smallest value

/** Round numbers between low and high, about `count` of them. */
viewer.roundTicks = function (low, high, count) {
  const span = high - low;
  if (!(span > 0) || !(count > 0)) return [low];
  const rough = span / count;
  const power = Math.pow(10, Math.floor(Math.log10(rough)));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((s) => s >= rough * 0.999);
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-6); i * step <= high + step * 1e-6; ++i) ticks.push(i * step);
  return ticks;
};

function logTicks(low, high) {
  const first = Math.ceil(Math.log10(low) - 1e-6);
  const last = Math.floor(Math.log10(high) + 1e-6);
  const factors = last - first >= 2 ? [1] : [1, 2, 5];
  const ticks = [];
  for (let exponent = first - 1; exponent <= last; ++exponent) {
    for (const factor of factors) {
      const value = factor * Math.pow(10, exponent);
      if (value >= low * 0.999 && value <= high * 1.001) ticks.push(value);
    }
  }
  return ticks;
}

const clampUnit = (fraction) => Math.min(1, Math.max(0, fraction));

/** A scale of one of the kinds `linear`, `gamma` (square root) and `log`: values to 0..1. */
viewer.makeScale = function (kind, low, high) {
  if (!(high > low)) high = low + (Math.abs(low) || 1);
  if (kind === 'log') {
    if (!(low > 0)) low = high * kDefaultDecades;
    const span = Math.log(high / low);
    return {
      kind, low, high,
      toUnit: (value) => (value > 0 ? clampUnit(Math.log(value / low) / span) : 0),
      fromUnit: (fraction) => low * Math.exp(fraction * span),
      ticks: () => logTicks(low, high),
    };
  }
  const power = kind === 'gamma' ? 0.5 : 1;
  return {
    kind, low, high,
    toUnit: (value) => Math.pow(clampUnit((value - low) / (high - low)), power),
    fromUnit: (fraction) => low + (high - low) * Math.pow(fraction, 1 / power),
    ticks: (count) => viewer.roundTicks(low, high, count),
  };
};

/** The choice of how values become brightness, for select(). */
viewer.valueScales = [['linear', 'Linear'], ['gamma', 'Square root (gamma)'], ['log', 'Logarithmic']];

/** One picture element for each value; missing values are transparent. */
viewer.colourValues = function (values, scale, colours) {
  const table = viewer.colourTable(colours);
  const painted = new Uint32Array(values.length);
  for (let i = 0; i < values.length; ++i) {
    painted[i] = values[i] === values[i] ? table[Math.round(scale.toUnit(values[i]) * 255)] : 0;
  }
  return painted;
};

/** CSS text of a picture element. */
viewer.cssColour = function (element) {
  return `rgba(${element & 255},${(element >> 8) & 255},${(element >> 16) & 255},${(element >>> 24) / 255})`;
};

// ---- Pictures ----

/** A canvas of width x height elements; `colourAt(column, row)` counts from the top left. */
viewer.makeBitmap = function (width, height, colourAt) {
  const canvas = document.createElement('canvas');
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext('2d');
  const image = context.createImageData(width, height);
  const elements = new Uint32Array(image.data.buffer);
  for (let row = 0; row < height; ++row) {
    for (let column = 0; column < width; ++column) {
      elements[row * width + column] = colourAt(column, row);
    }
  }
  context.putImageData(image, 0, 0);
  return canvas;
};

/** A map as an eye at the wall sees it: x from right to left, y upwards. */
viewer.bitmapOfMap = function (loaded, scale, colours) {
  const [nx, ny] = loaded.map.size;
  const lookup = viewer.colourValues(loaded.quantity.values, scale, colours);
  const codes = loaded.quantity.codes;
  return viewer.makeBitmap(nx, ny, (column, row) => lookup[codes[(nx - 1 - column) * ny + (ny - 1 - row)]]);
};
