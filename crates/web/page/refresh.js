// Drawing what is new, marking what is old, and telling when all is at rest.

function markAllOld() {
  markOld('curves', curve !== null && curve.round !== rounds.curve);
  markOld('motion', motion !== null && motion.round !== rounds.motion);
  markOld('map', chart !== null && chart.round !== rounds.map);
  tell();
}

let refreshDue = false;
/** Draws what is new, once a frame. */
function refresh() {
  if (refreshDue) return;
  refreshDue = true;
  requestAnimationFrame(() => {
    refreshDue = false;
    drawCurve();
    drawMotion();
    drawMap();
    tellMapCell();
    tell();
    takeTimes();
  });
}

function takeTimes() {
  const now = performance.now();
  if (curve?.round === rounds.curve) {
    times.first ??= now - changedAt.curve;
    if (curve.kind === 'followed') times.curve ??= now - changedAt.curve;
  }
  if (motion?.round === rounds.motion) times.motion ??= now - changedAt.motion;
  if (chart?.round === rounds.map && chart.done === ROWS) times.map ??= now - changedAt.map;
}

/** Nothing is running, waiting or to be drawn. */
const isQuiet = () => isIdle() && !refreshDue && laterTimer === undefined && detailTimer === undefined;

/** @returns {Promise<void>} */
function idle() {
  return new Promise((done) => {
    const look = () => {
      if (isQuiet()) done();
      else setTimeout(look, 10);
    };
    look();
  });
}
