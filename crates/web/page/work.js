// What is asked of the engines after a change, and in which order; what of the pictures is old.

/** Each picture has a round; it is old while its numbers are of an earlier one. */
const rounds = { curve: 0, motion: 0, map: 0 };
/** The scenes that the rounds stand for. @type {Record<string, string>} */
const asked = { curve: '', motion: '', map: '' };
/** What the engine says against a scene. @type {Record<string, string>} */
const failures = { curve: '', motion: '', map: '' };
/**
 * In ms after the last change that touched them, as the numbers are on the screen.
 * @type {Record<string, number | null>}
 */
const times = { loaded: null, first: null, curve: null, motion: null, map: null };
/** When each picture became old. @type {Record<string, number>} */
const changedAt = { curve: 0, motion: 0, map: 0 };
/** @type {number | undefined} */
let laterTimer;
/** @type {number | undefined} */
let detailTimer;
let mapAsked = false;

const POINTS = 49;
/** The gaps that come first: one of so many. */
const COARSE = 6;
/** Changes that follow each other so quickly are one drag, ms. */
const DRAG = 150;
/** After so long without the followed curve, what is waiting behind it begins, ms. */
const LATER = 250;

/** @param {number} gap */
function insideCurve(gap) {
  const free = freeAmplitude();
  const ends = [valueOf(quantity('near')), valueOf(quantity('far'))];
  return free !== null && gap >= Math.min(...ends) * free && gap <= Math.max(...ends) * free;
}

/** Whether the motion is that of a point of the curve. */
const onCurve = () => state.hold === 'gap' && insideCurve(valueOf(quantity('g')));

/** From far to near, with the gap that is held. @returns {number[]} */
function curveGaps() {
  const free = /** @type {number} */ (freeAmplitude());
  const [far, near] = [valueOf(quantity('far')) * free, valueOf(quantity('near')) * free];
  const gaps = Array.from({ length: POINTS }, (_, n) =>
    Number((far + ((near - far) * n) / (POINTS - 1)).toPrecision(5)),
  );
  const held = valueOf(quantity('g'));
  if (onCurve() && !gaps.includes(held)) gaps.push(held);
  return gaps.sort((a, b) => (far > near ? b - a : a - b));
}

/** The texts of what is wanted. Where a text is what it was, the picture is not old. */
function wanted() {
  const common = toml(commonScene());
  const way = [common, valueOf(quantity('far')), valueOf(quantity('near'))].join('\n');
  const { x, y, of } = mapChoice();
  const map = [mapAxis(x, COLUMNS), mapAxis(y, ROWS)];
  return {
    curve: way,
    motion: onCurve() ? `${way}\n${state.way}\n${valueOf(quantity('g'))}` : toml(heldScene()),
    map: JSON.stringify([
      of,
      mapScene(
        map[0],
        map[1],
        map[1].values.map((_, n) => n),
        of,
      ),
    ]),
  };
}

/** Something was moved: what it touches is old, and is asked for anew. */
function change() {
  const now = performance.now();
  const dragged = now - changedAt.curve < DRAG;
  const next = wanted();
  const touched = {
    curve: next.curve !== asked.curve,
    motion: next.motion !== asked.motion,
    map: next.map !== asked.map,
  };
  if (touched.curve || touched.motion || touched.map) {
    clearTimeout(laterTimer);
  }
  if (touched.curve) times.first = null;
  Object.assign(asked, next);
  for (const key of /** @type {const} */ (['curve', 'motion', 'map'])) {
    if (!touched[key]) continue;
    rounds[key] += 1;
    changedAt[key] = now;
    times[key] = null;
    failures[key] = '';
  }
  if (touched.curve) {
    dropTasks(['probe', 'coarse', 'curve', 'fine', 'motion', 'map', 'detail']);
    askCurve(rounds.curve, dragged);
  } else if (touched.motion) {
    dropTasks(['motion', 'map', 'detail']);
    askMotion();
  } else if (touched.map) dropTasks(['map']);
  // A map that is not whole was dropped with the tasks above, and is asked for again.
  if (chart?.round !== rounds.map || chart.done < ROWS) mapAsked = false;
  if (touched.curve || touched.motion || touched.map)
    laterTimer = setTimeout(askLater, touched.curve ? LATER : touched.motion ? 60 : 0);
  markAllOld();
  followHash();
  refresh();
}

/** @param {'curve' | 'motion' | 'map'} key @param {number} round @param {(answer: Answer, ms: number) => void} take */
function answered(key, round, take) {
  return (/** @type {Answer} */ answer, /** @type {number} */ ms) => {
    if (round !== rounds[key]) return;
    if (answer.error) failures[key] = answer.error;
    else take(answer, ms);
    refresh();
  };
}

/** @param {number} round @param {boolean} dragged */
function askCurve(round, dragged) {
  if (hasQuantity('a')) return askPoints(round, dragged);
  ask({
    kind: 'probe',
    brief: true,
    scene: probeScene(),
    done: answered('curve', round, (answer) => {
      probedAmplitude = answer.variables.amplitude.data[0];
      showControls();
      askPoints(round, dragged);
    }),
  });
}

/**
 * Some points by themselves first. A drag waits for them before it follows the curve.
 * @param {number} round @param {boolean} dragged
 */
function askPoints(round, dragged) {
  const gaps = curveGaps();
  const some = searchedScene(gaps.filter((_, n) => n % COARSE === 0));
  ask({
    kind: 'coarse',
    scene: some,
    brief: true,
    done: answered('curve', round, (answer, ms) => {
      if (!curve || curve.round !== round) curve = curveFrom(answer, round, ms, some);
      if (dragged) askFollowed(round, gaps);
    }),
  });
  if (!dragged) askFollowed(round, gaps);
  askMotion();
}

/** @param {number} round @param {number[]} gaps */
function askFollowed(round, gaps) {
  const scene = followedScene(gaps, 'all');
  ask({
    kind: 'curve',
    scene,
    done: answered('curve', round, (answer, ms) => {
      curve = curveFrom(answer, round, ms, scene);
      // The gap that is held may have moved while the curve was followed.
      if (onCurve() && !takeMotionOfCurve()) askMotion();
      askMap();
    }),
  });
}

/** What has waited long enough for a slow curve. */
function askLater() {
  laterTimer = undefined;
  if (curve && curve.round === rounds.curve && curve.kind === 'followed') return askMap();
  if (failures.curve === '' && freeAmplitude() !== null && isBusyWith(['curve'])) {
    const round = rounds.curve;
    const scene = searchedScene(curveGaps());
    ask({
      kind: 'fine',
      scene,
      done: answered('curve', round, (answer, ms) => {
        if (!curve || curve.round !== round || curve.kind !== 'followed') curve = curveFrom(answer, round, ms, scene);
      }),
    });
  }
  askMap();
}

/** The motion at the held gap is one of the curve's; that at a set-point has a scene of its own. */
function askMotion() {
  const round = rounds.motion;
  if (onCurve()) {
    if (!curve || curve.round !== rounds.curve || curve.kind !== 'followed' || takeMotionOfCurve()) return;
    // The gap lies between two points: the curve is followed once more, with the gap among them.
    const scene = followedScene(curveGaps(), 'all');
    ask({
      kind: 'motion',
      scene,
      done: answered('motion', round, (answer, ms) => {
        curve = curveFrom(answer, rounds.curve, ms, scene);
        takeMotionOfCurve();
      }),
    });
    return;
  }
  const scene = heldScene();
  ask({
    kind: 'motion',
    scene,
    done: answered('motion', round, (answer, ms) => {
      motion = motionFrom(answer, round, ms, scene);
    }),
  });
}

/** Takes the motion at the held gap from the followed curve; shows the nearest point's until it is there. */
function takeMotionOfCurve() {
  if (!onCurve() || !curve || curve.kind !== 'followed') return false;
  const held = valueOf(quantity('g'));
  const gaps = curve.gaps;
  const n = gaps.reduce((best, gap, k) => (Math.abs(gap - held) < Math.abs(gaps[best] - held) ? k : best), 0);
  const exact = gaps[n] === held;
  motion = { ...motionOfCurve(curve, state.way, n), round: exact ? rounds.motion : -1 };
  if (exact) askDetail();
  return exact;
}

/** A dragged point has its motion at once, with few samples. When nothing else is to do, it gets the others. */
function askDetail() {
  dropTasks(['detail']);
  clearTimeout(detailTimer);
  detailTimer = setTimeout(() => {
    detailTimer = undefined;
    const of = motion;
    if (!of || of.detailed || of.round !== rounds.motion || !curve) return;
    const gaps = curve.scene.curve.values.map((/** @type {string} */ gap) => parseQuantity(gap, 'm'));
    const scene = followedScene(gaps, of.place);
    ask({ kind: 'detail', scene, done: answered('motion', rounds.motion, (answer) => takeDetail(of, answer)) });
  }, LATER);
}

function askMap() {
  if (mapAsked) return;
  mapAsked = true;
  const round = rounds.map;
  let here = emptyChart(round);
  for (const rows of ROW_PIECES) {
    ask({
      kind: 'map',
      scene: mapScene(here.x, here.y, rows, here.of),
      done: answered('map', round, (answer) => {
        chart = here;
        takeRows(here, rows, answer);
      }),
    });
  }
}
