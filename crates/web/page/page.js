// The page begins.

const loadBegun = performance.now();

function restore() {
  const unknown = hashToState(location.hash);
  unknownWords = unknown.length ? `The link says what this page does not know: ${unknown.join(', ')}.` : '';
  showControls();
  change();
}

/** Without an engine there are no numbers. @param {string} why */
function tellDead(why) {
  deadTold = `The engine does not start: ${why} A current browser runs it.`;
  dropTasks(PRIORITIES);
  tell();
}

async function begin() {
  document.title = `${START.title} – afmsweep live`;
  element('title').textContent = START.title;
  makeControls();
  makeCurvePlots();
  makeMotionPlots();
  makeMap();
  makeSaves();
  makeTours();
  onDead = (why) => tellDead(why);
  onWork = tell;
  onScheme = drawMap;
  window.addEventListener('hashchange', () => {
    if (location.hash.replace(/^#/, '') !== lastHash) restore();
  });
  window.afmsweep = {
    times,
    state,
    idle,
    rounds,
    failures,
    get curve() {
      return curve;
    },
    get motion() {
      return motion;
    },
    get map() {
      return chart;
    },
  };
  restore();
  try {
    await startEngines();
    times.loaded = performance.now() - loadBegun;
  } catch (error) {
    tellDead(error instanceof Error ? error.message : String(error));
  }
}

/**
 * A point of the curve was pressed: its gap is held, and its motion is shown.
 * @param {number} gap @param {0 | 1} way
 */
function choosePoint(gap, way) {
  state.hold = 'gap';
  state.way = way;
  setValue('g', gap);
  showControls();
  change();
}

begin();
