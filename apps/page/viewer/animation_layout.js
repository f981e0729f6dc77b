// SPDX-License-Identifier: MIT
// How the cells of an animation lie in its picture: a grid over the wall, a camera's pixels, or a list.

const kSample = 200;  // points whose distances from neighbours are looked at
const { clampIndex } = viewer;

/**
 * A layout has `cells`, `x` and `y` (axes), paint(context, plot, colours) with one picture
 * element for each cell, cellAt(x, y), centre(cell) as [x, y], neighbour(cell, [right, up]) and
 * describe(cell).
 */
viewer.makeAnimationLayout = async function (animation) {
  viewer.require(viewer.isRange(animation.size), 'The capture does not say how large it is.');
  if (animation.kind === 'wall') return wallLayout(animation);
  if (animation.kind === 'camera') return cameraLayout(animation);
  viewer.require(animation.kind === 'list', 'The capture is of an unknown kind.');
  return animation.positions ? listLayout(animation, await viewer.loadPoints(animation.positions)) : stripLayout(animation);
};

function wallLayout(animation) {
  const [w, h] = animation.size;
  viewer.require(viewer.isRange(animation.x_m) && viewer.isRange(animation.y_m), 'The capture does not say where it lies.');
  const indexAt = ([low, high], count, value) => clampIndex(Math.floor(((value - low) / (high - low)) * count), count);
  const centreOf = ([low, high], count, index) => low + ((index + 0.5) / count) * (high - low);
  const centre = (cell) => [centreOf(animation.x_m, w, Math.floor(cell / h)), centreOf(animation.y_m, h, cell % h)];
  return {
    cells: w * h,
    x: viewer.linearAxis(animation.x_m, viewer.wallTitles[0], true),
    y: viewer.linearAxis(animation.y_m, viewer.wallTitles[1]),
    paint: (context, plot, colours) => {
      const bitmap = viewer.makeBitmap(w, h, (column, row) => colours[(w - 1 - column) * h + (h - 1 - row)]);
      viewer.paintBitmap(context, plot, bitmap, animation.x_m, animation.y_m);
    },
    cellAt: (x, y) => indexAt(animation.x_m, w, x) * h + indexAt(animation.y_m, h, y),
    centre,
    neighbour: (cell, [right, up]) =>
      clampIndex(Math.floor(cell / h) - right, w) * h + clampIndex((cell % h) + up, h),
    describe: (cell) => 'Point at ' + viewer.positionText(...centre(cell)),
  };
}

/** Cells in rows from the top left, in units of one cell. */
function pixelLayout(w, h, titles, describe) {
  return {
    cells: w * h,
    x: viewer.linearAxis([0, w], titles[0]),
    y: viewer.linearAxis([0, h], titles[1], true),
    paint: (context, plot, colours) => {
      const bitmap = viewer.makeBitmap(w, h, (column, row) => colours[row * w + column]);
      viewer.paintBitmap(context, plot, bitmap, [0, w], [0, h]);
    },
    cellAt: (x, y) => clampIndex(Math.floor(y), h) * w + clampIndex(Math.floor(x), w),
    centre: (cell) => [(cell % w) + 0.5, Math.floor(cell / w) + 0.5],
    neighbour: (cell, [right, up]) =>
      clampIndex(Math.floor(cell / w) - up, h) * w + clampIndex((cell % w) + right, w),
    describe,
  };
}

function cameraLayout(animation) {
  const [w, h] = animation.size;
  const describe = (cell) => `Pixel in column ${cell % w}, row ${Math.floor(cell / w)}`;
  return pixelLayout(w, h, ['column (pixels)', 'row (pixels)'], describe);
}

/** A list whose points have no known place: one narrow cell each, side by side. */
function stripLayout(animation) {
  const count = animation.size[0];
  const layout = pixelLayout(count, 1, ['number of the point', ''], (cell) => `Point number ${cell}`);
  layout.isStrip = true;
  return layout;
}

function listLayout(animation, positions) {
  const count = animation.size[0];
  viewer.require(positions.length === 3 * count, 'The capture\u2019s list of points has another length.');
  const at = (cell) => [positions[3 * cell], positions[3 * cell + 1]];
  const squared = (cell, x, y) => (at(cell)[0] - x) ** 2 + (at(cell)[1] - y) ** 2;
  const nearest = (x, y, isAllowed) => {
    let best = -1;
    for (let cell = 0; cell < count; ++cell) {
      if (isAllowed(cell) && (best < 0 || squared(cell, x, y) < squared(best, x, y))) best = cell;
    }
    return best;
  };
  const [rangeX, rangeY] = listRanges(animation, positions);
  const radius = 0.48 * typicalDistance(count, at, nearest);
  return {
    cells: count,
    x: viewer.linearAxis(rangeX, viewer.wallTitles[0], true),
    y: viewer.linearAxis(rangeY, viewer.wallTitles[1]),
    paint: (context, plot, colours) => paintDiscs(context, plot, at, radius, colours),
    cellAt: (x, y) => nearest(x, y, () => true),
    centre: at,
    neighbour: (cell, [right, up]) => {
      const [x, y] = at(cell);
      const along = (other) => right * (x - at(other)[0]) + up * (at(other)[1] - y);
      const aside = (other) => Math.abs(right ? at(other)[1] - y : at(other)[0] - x);
      const next = nearest(x, y, (other) => along(other) > 1e-9 && aside(other) <= along(other));
      return next < 0 ? cell : next;
    },
    describe: (cell) => `Point ${cell} at ` + viewer.positionText(...at(cell)),
  };
}

/** The median distance from a point to its nearest neighbour, over a sample of the points. */
function typicalDistance(count, at, nearest) {
  const distances = [];
  for (let cell = 0; cell < count; cell += Math.ceil(count / kSample)) {
    const [x, y] = at(cell);
    const next = nearest(x, y, (other) => other !== cell);
    if (next >= 0) distances.push(Math.hypot(at(next)[0] - x, at(next)[1] - y));
  }
  return distances.sort((a, b) => a - b)[Math.floor(distances.length / 2)] || 0.1;
}

/** The part of the wall to show: around all points, with a margin. */
function listRanges(animation, positions) {
  const around = (axis, known) => {
    let [low, high] = known || [Infinity, -Infinity];
    for (let i = axis; i < positions.length; i += 3) {
      low = Math.min(low, positions[i]);
      high = Math.max(high, positions[i]);
    }
    return [low, high];
  };
  const ranges = [around(0, animation.x_m), around(1, animation.y_m)];
  const reach = Math.max(...ranges.map(([low, high]) => high - low)) || 0.1;
  return ranges.map(([low, high]) => {
    const middle = (low + high) / 2;
    const half = Math.max((high - low) / 2, 0.1 * reach) + 0.05 * reach;
    return [middle - half, middle + half];
  });
}

function paintDiscs(context, plot, at, radius, colours) {
  const pixels = (radius * plot.area.width) / (plot.x.scale.high - plot.x.scale.low);
  const size = Math.min(14, Math.max(3, pixels));
  context.strokeStyle = viewer.theme().soft;
  context.lineWidth = 0.75;
  for (let cell = 0; cell < colours.length; ++cell) {
    const [x, y] = at(cell);
    context.beginPath();
    context.arc(plot.toX(x), plot.toY(y), size, 0, 2 * Math.PI);
    context.fillStyle = viewer.cssColour(colours[cell]);
    context.fill();
    context.stroke();
  }
}
