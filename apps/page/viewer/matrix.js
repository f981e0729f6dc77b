// SPDX-License-Identifier: MIT
// Small multiples: one column for each result, one row for each kind of map, one colour scale a row.

const kCell = { narrowest: 132, widest: 300, gap: 10, tallest: 320 };  // pixels
const kWords = { m: 4, mm: 4 };  // significant digits of values with these units

/** Distinct names of maps, in the order in which they first appear. */
viewer.mapNames = function (results) {
  return [...new Set(results.flatMap((result) => (result.maps || []).map((map) => map.name)))];
};

viewer.mapOf = (result, name) => (result.maps || []).find((map) => map.name === name);

viewer.scaleOfMap = (map) => viewer.makeScale('linear', ...viewer.colourRange(map.colours, map.range));

viewer.mapValueText = (map, value) =>
  viewer.withUnit(viewer.formatNumber(value, kWords[map.unit] || 3), map.unit);

function makeCell(grid, row, column, map) {
  const { result } = column;
  const cell = { map, column, loaded: null, bitmap: null, plot: null };
  cell.plot = viewer.createPlot({
    label: `${map.name} of ${result.name}`,
    control: 'cell',
    margins: null,
    focusable: !row.cells.some((other) => other && other.plot),
    paint: (context, plot) => paintCell(context, plot, grid, cell),
    onPoint: (what, x, y) => grid.mark(row, what === 'leave' ? null : { x, y }),
    onKey: (event) => moveMark(grid, row, event),
  });
  cell.plot.x = viewer.linearAxis(grid.x, '', true);
  cell.plot.y = viewer.linearAxis(grid.y, '');
  return cell;
}

function paintCell(context, plot, grid, cell) {
  viewer.paintMissing(context, plot);
  if (!cell.bitmap) return;
  viewer.paintBitmap(context, plot, cell.bitmap, cell.map.x_m, cell.map.y_m);
  if (grid.position) viewer.paintCross(context, plot, grid.position.x, grid.position.y);
}

/** Arrow keys move the marked position by one element of the row's first map. */
function moveMark(grid, row, event) {
  const step = viewer.stepOfKey(event.key);
  if (!step) return;
  event.preventDefault();
  const { map } = row.cells.find((cell) => cell);
  const moved = (axis, [low, high], count, by) => {
    const pitch = (high - low) / count;
    const from = grid.position ? grid.position[axis] : (low + high) / 2 - by * pitch;
    const index = Math.round((from - low) / pitch - 0.5) + by;
    return low + (viewer.clampIndex(index, count) + 0.5) * pitch;
  };
  grid.mark(row, {
    x: moved('x', map.x_m, map.size[0], -step[0]),
    y: moved('y', map.y_m, map.size[1], step[1]),
  });
}

async function fillCell(row, cell, holder) {
  try {
    cell.loaded = await viewer.loadMap(cell.map);
    cell.bitmap = viewer.bitmapOfMap(cell.loaded, row.scale, row.map.colours);
    cell.plot.draw();
  } catch (error) {
    holder.replaceChildren(viewer.element('span', { class: 'view-error' }, error.message));
  }
}

function describeMark(grid, row) {
  if (!grid.position) return grid.hint;
  const { x, y } = grid.position;
  const values = row.cells
    .filter((cell) => cell && cell.loaded)
    .map((cell) => `${cell.column.result.name} ${viewer.mapValueText(cell.map, cell.loaded.valueAt(x, y))}`);
  return `At ${viewer.positionText(x, y)}. ${row.map.name}: ${values.join('; ')}.`;
}

function makeHeading(results) {
  const headings = results.map((result) =>
    viewer.element(
      'th',
      { scope: 'col' },
      viewer.element('b', {}, result.name),
      viewer.element('small', {}, result.detail || ''),
    ),
  );
  return viewer.element('thead', {}, viewer.element('tr', {}, ...headings));
}

/** The rows of one kind of map: a line with its name and colour bar, and a line of pictures. */
function makeRow(grid, name, columns, waiting) {
  const maps = columns.map(({ result }) => viewer.mapOf(result, name));
  const map = maps.find((present) => present);
  const row = { map, cells: [], scale: viewer.scaleOfMap(map) };
  const bar = viewer.createColourBar('colour-bar');
  bar.set(row.scale, map.colours, viewer.titleWithUnit(name, map.unit));
  const pictures = columns.map((column, i) => {
    const cell = maps[i] ? makeCell(grid, row, column, maps[i]) : null;
    row.cells.push(cell);
    if (!cell) return viewer.element('td', { class: 'none', 'aria-label': `${column.result.name} has no such map` }, '\u2013');
    const holder = viewer.element('td', {}, cell.plot.canvas);
    waiting.push(fillCell(row, cell, holder));
    return holder;
  });
  const title = viewer.element('th', { colspan: columns.length, scope: 'rowgroup' }, bar.element);
  const body = viewer.element('tbody', {}, viewer.element('tr', {}, title), viewer.element('tr', {}, ...pictures));
  return { row, body };
}

function layOut(grid, width) {
  const { columns, rows } = grid;
  const room = Math.floor((width - kCell.gap * (columns.length - 1)) / columns.length);
  const cellWidth = Math.min(kCell.widest, Math.max(kCell.narrowest, room));
  for (const column of columns) column.heading.style.minWidth = cellWidth + 'px';
  for (const row of rows) {
    for (const cell of row.cells) {
      if (cell) viewer.fitToScale(cell.plot, cellWidth, kCell.tallest);
    }
  }
}

viewer.views.matrix = async function (view) {
  const { results } = view.metadata;
  const names = viewer.mapNames(results);
  if (names.length === 0) return view.hide();
  const maps = results.flatMap((result) => result.maps || []);
  const readout = viewer.element('p', { class: 'view-readout', 'aria-live': 'polite' });
  const grid = {
    x: viewer.unionOfRanges(maps.map((map) => map.x_m)),
    y: viewer.unionOfRanges(maps.map((map) => map.y_m)),
    position: null,
    hint: 'Point at a map, or focus it and use the arrow keys, to read the values of all results there.',
    rows: [],
  };
  viewer.require(grid.x && grid.y, 'The maps do not say where they lie.');
  grid.mark = (row, position) => {
    grid.position = position;
    readout.textContent = describeMark(grid, row);
    for (const other of grid.rows) {
      for (const cell of other.cells) if (cell) cell.plot.draw();
    }
  };
  const head = makeHeading(results);
  const headings = head.querySelectorAll('th');
  grid.columns = results.map((result, i) => ({ result, heading: headings[i] }));
  const waiting = [];
  const table = viewer.element('table', { class: 'matrix' }, head);
  for (const name of names) {
    const { row, body } = makeRow(grid, name, grid.columns, waiting);
    grid.rows.push(row);
    table.append(body);
  }
  readout.textContent = grid.hint;
  const scroll = viewer.element('div', { class: 'view-scroll' }, table);
  view.body.append(scroll, readout);
  viewer.watchWidth(view.body, (width) => layOut(grid, width));
  await Promise.all(waiting);
  view.root.dataset.ready = 'true';
};
