// SPDX-License-Identifier: MIT
// Finds the page's placeholders and starts a view in each when it first comes near the window.
//
// Controls carry data-control; tests may rely on these names:
//   space    result (check box, with data-index), colour, point-size, volume-of, volume-mode,
//            threshold, wall, scan-points, truth, axes, view-wall, view-side, view-top, reset, save;
//            canvas: scene; bars: points-bar, volume-bar
//   animation     play, speed, value-scale, stretch, all-time, whole-record, bin (slider);
//            canvases: picture, histogram, colour-bar
//   slices   result, value-scale, brightest, slider-x, slider-y, slider-z;
//            canvases: slice-xy, slice-zy, slice-xz, colour-bar
//   matrix   cell (canvas, one for each map), colour-bar
//   pair     map, left, right, swap, divider (slider); canvases: picture, colour-bar
//   tables   sort (button in each heading; the heading has aria-sort)
//
// State is readable from attributes of the placeholders (div.view):
//   all      data-started="true" once running, data-failed="true" when nothing can be shown
//   space    data-ready, data-results ("1,2"), data-colour, data-mode (none, maximum, surface),
//            data-volume-of, data-threshold (per cent), data-camera (wall, side, top, free)
//   animation     data-bin, data-cell, data-value-scale, data-all-time, data-playing
//   slices   data-result, data-ix, data-iy, data-iz, data-value-scale
//   matrix   data-ready
//   pair     data-left, data-right (indices of results), data-map, data-position (per cent)

const kNearby = '400px';  // how far outside the window a view starts to load
const kLoading = 'Loading \u2026';

/** What a view gets: its placeholder, a place for its contents, and a line for messages. */
function prepare(root, metadata) {
  const fallback = viewer.element('div', { class: 'view-fallback' }, ...root.childNodes);
  const body = viewer.element('div', { class: 'view-body', hidden: true });
  const message = viewer.element('p', { class: 'view-message', role: 'status' });
  root.append(body, message, fallback);
  const say = (text) => {
    message.textContent = text;
    message.hidden = text === '';
  };
  say(kLoading);
  const hide = () => { root.hidden = true; };
  /** Shows the view instead of what the page holds without scripts, or the other way round. */
  const show = (isView) => {
    body.hidden = !isView;
    fallback.hidden = isView;
  };
  const isLoading = () => message.textContent === kLoading;
  return { root, metadata, body, say, hide, show, isLoading };
}

function fail(view, error) {
  view.show(false);
  view.root.dataset.failed = 'true';
  view.say('This view cannot be shown. ' + error.message);
}

async function start(view) {
  const make = viewer.views[view.root.dataset.view];
  try {
    viewer.require(make, 'Its kind is unknown.');
    viewer.require(
      typeof DecompressionStream === 'function',
      'This browser cannot unpack the page\u2019s data, because it lacks DecompressionStream; a newer one can.',
    );
    await make(view);
    if (view.isLoading()) view.say('');
    view.show(true);
    view.root.dataset.started = 'true';
  } catch (error) {
    fail(view, error);
  }
}

function startWhenNear(views) {
  const byRoot = new Map(views.map((view) => [view.root, view]));
  const observer = new IntersectionObserver(
    (entries) => {
      for (const entry of entries) {
        if (!entry.isIntersecting) continue;
        observer.unobserve(entry.target);
        start(byRoot.get(entry.target));
      }
    },
    { rootMargin: kNearby },
  );
  for (const view of views) observer.observe(view.root);
}

function main() {
  for (const table of document.querySelectorAll('table.sortable')) viewer.makeSortable(table);
  const roots = [...document.querySelectorAll('.view[data-view]')];
  if (roots.length === 0) return;
  let metadata = null;
  let problem = null;
  try {
    metadata = viewer.readMetadata();
    viewer.colours = metadata.colours;
    viewer.worldFromWall = metadata.world_from_wall;
  } catch (error) {
    problem = error;
  }
  const views = roots.map((root) => prepare(root, metadata));
  if (problem) views.forEach((view) => fail(view, problem));
  else startWhenNear(views);
}

if (document.readyState === 'loading') addEventListener('DOMContentLoaded', main);
else main();
