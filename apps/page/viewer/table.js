// SPDX-License-Identifier: MIT
// Tables that are sorted by a column when its heading is pressed.

const kNext = { none: 'ascending', ascending: 'descending', descending: 'none' };

/** What a row is sorted by: the number that its cell carries, or else the cell's text. */
function keyOf(row, column) {
  const cell = row.cells[column];
  if (!cell) return { number: NaN, text: '' };
  const carried = cell.dataset.value;
  const number = carried === undefined || carried === '' ? NaN : Number(carried);
  return { number, text: cell.textContent.trim() };
}

/** Rows without a number, or without text where nothing is a number, keep to the end in either direction. */
function compare(a, b, sign, isNumeric) {
  if (!isNumeric) {
    if (!a.text || !b.text) return Number(!a.text) - Number(!b.text);
    return sign * a.text.localeCompare(b.text, 'en', { numeric: true });
  }
  if (Number.isNaN(a.number) || Number.isNaN(b.number)) {
    return Number(Number.isNaN(a.number)) - Number(Number.isNaN(b.number));
  }
  return sign * (a.number - b.number);
}

function sortRows(body, original, column, order) {
  if (order === 'none') {
    body.append(...original);
    return;
  }
  const keyed = original.map((row) => ({ row, key: keyOf(row, column) }));
  const isNumeric = keyed.some(({ key }) => !Number.isNaN(key.number));
  const sign = order === 'ascending' ? 1 : -1;
  keyed.sort((a, b) => compare(a.key, b.key, sign, isNumeric));
  body.append(...keyed.map(({ row }) => row));
}

/** Makes the headings of a table's last heading row buttons that sort the rows below. */
viewer.makeSortable = function (table) {
  if (!table.tHead || table.tHead.rows.length === 0) return;
  const headings = [...table.tHead.rows[table.tHead.rows.length - 1].cells];
  const bodies = [...table.tBodies].map((body) => ({ body, rows: [...body.rows] }));
  let column = 0;
  for (const heading of headings) {
    const at = column;
    column += heading.colSpan;
    if (heading.colSpan > 1 || !heading.textContent.trim()) continue;
    const button = viewer.element('button', { type: 'button', class: 'sort', 'data-control': 'sort' });
    button.append(...heading.childNodes);
    heading.append(button);
    heading.setAttribute('aria-sort', 'none');
    button.addEventListener('click', () => {
      const order = kNext[heading.getAttribute('aria-sort')];
      for (const other of headings) {
        if (other.hasAttribute('aria-sort')) other.setAttribute('aria-sort', 'none');
      }
      heading.setAttribute('aria-sort', order);
      for (const { body, rows } of bodies) sortRows(body, rows, at, order);
    });
  }
};
