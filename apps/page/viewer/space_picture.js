// SPDX-License-Identifier: MIT
// What one can take from the 3-D view: the point under the pointer, and a picture as a file.

const kReach = 9;  // pixels around the pointer in which a point counts as meant
const kBar = { width: 280, height: 42, pitch: 320, room: 74 };  // pixels of colour bars in the file

/** The index of the point of a cloud nearest to the eye within reach of the pointer, or null. */
function nearestPoint(stage, cloud, pointer) {
  const toClip = new THREE.Matrix4().multiplyMatrices(stage.camera.projectionMatrix, stage.camera.matrixWorldInverse);
  const positions = cloud.object.geometry.getAttribute('position').array;
  const seen = new THREE.Vector3();
  let best = null;
  for (let i = 0; 3 * i < positions.length; ++i) {
    seen.fromArray(positions, 3 * i).applyMatrix4(toClip);
    const dx = ((seen.x - pointer.x) * stage.width) / 2;
    const dy = ((seen.y - pointer.y) * stage.height) / 2;
    if (dx * dx + dy * dy > kReach * kReach || Math.abs(seen.z) > 1) continue;
    if (!best || seen.z < best.depth) best = { index: i, depth: seen.z };
  }
  return best;
}

function describePoint(result, cloud, index) {
  const position = [...cloud.object.geometry.getAttribute('position').array.slice(3 * index, 3 * index + 3)];
  const fields = result.points.fields || [];
  const values = fields.map(({ name, unit }) =>
    `${name} ${viewer.withUnit(viewer.formatNumber(cloud.fields.get(name).at(index)), unit)}`);
  return `${result.name} at ${viewer.placeText(position)}. ${values.join('; ')}${values.length > 0 ? '.' : ''}`;
}

/** The shown point under the pointer in words, or an empty text; `clouds` by the result's index. */
viewer.pointUnder = function (stage, clouds, results, event) {
  const box = stage.canvas.getBoundingClientRect();
  const pointer = {
    x: (2 * (event.clientX - box.left)) / box.width - 1,
    y: 1 - (2 * (event.clientY - box.top)) / box.height,
  };
  let best = null;
  for (const [index, cloud] of clouds) {
    const found = cloud.object.visible && nearestPoint(stage, cloud, pointer);
    if (found && (!best || found.depth < best.found.depth)) best = { found, index, cloud };
  }
  return best ? describePoint(results[best.index], best.cloud, best.found.index) : '';
};

/** Offers the scene, with its colour bars below it, as a PNG file. */
viewer.savePicture = function (stage, bars) {
  stage.renderSharply();
  const ratio = stage.canvas.width / stage.width;
  const height = stage.height + (bars.length > 0 ? kBar.room : 0);
  const picture = viewer.element('canvas', { width: stage.canvas.width, height: Math.round(height * ratio) });
  const context = picture.getContext('2d');
  const theme = viewer.theme();
  context.scale(ratio, ratio);
  context.fillStyle = theme.panel;
  context.fillRect(0, 0, stage.width, height);
  context.drawImage(stage.canvas, 0, 0, stage.width, stage.height);
  context.fillStyle = theme.ink;
  context.font = '13px system-ui, "Segoe UI", Roboto, Arial, sans-serif';
  bars.forEach((bar, i) => {
    context.fillText(bar.title.textContent, 24 + kBar.pitch * i, stage.height + 16);
    context.drawImage(bar.canvas, 16 + kBar.pitch * i, stage.height + 24, kBar.width, kBar.height);
  });
  picture.toBlob((blob) => {
    const link = viewer.element('a', { href: URL.createObjectURL(blob), download: 'hidden-scene.png' });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  });
};
