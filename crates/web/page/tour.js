// Going through a tour. Leaving it brings back what was there before.

/** @type {{number: number, step: number, before: string} | null} */
let tour = null;

/** @returns {string} why there are no tours for the scene given; empty where there are */
function toursRefused() {
  const needed = ['k', 'f', 'q', 'r', 'e', 'nu', 'w', 'lt', 'a', 'd'];
  const fits = needed.every(hasQuantity) && at(START.base, 'drive.on') === 'tip' && leverModes.length === 0;
  return fits ? '' : 'The tours are for a calibrated lever that is driven at its tip. Open the page without a scene.';
}

function makeTours() {
  const choice = /** @type {HTMLSelectElement} */ (element('tour-choice'));
  const why = toursRefused();
  if (why) {
    choice.disabled = true;
    choice.title = why;
    choice.options[0].text = 'not for this scene';
    return;
  }
  choice.append(...TOURS.map((one, n) => new Option(one.title, String(n))));
  choice.addEventListener('change', () => {
    if (choice.value === '') leaveTour();
    else {
      tour = { number: Number(choice.value), step: 0, before: tour?.before ?? stateToHash() };
      showStep();
      element('tour-title').focus({ preventScroll: true });
    }
  });
  element('tour-back').addEventListener('click', () => moveTour(-1));
  element('tour-next').addEventListener('click', () => moveTour(1));
  element('tour-leave').addEventListener('click', leaveTour);
}

/** @param {number} by */
function moveTour(by) {
  if (!tour) return;
  const last = TOURS[tour.number].steps.length - 1;
  if (tour.step + by > last) return leaveTour();
  tour.step = Math.max(0, tour.step + by);
  showStep();
}

function showStep() {
  if (!tour) return;
  const { title, steps } = TOURS[tour.number];
  const step = steps[tour.step];
  hashToState('');
  // A step stands on all before it.
  for (const one of steps.slice(0, tour.step + 1)) {
    for (const [id, value] of Object.entries(one.values ?? {})) setValue(id, value);
    state.law = one.law ?? state.law;
    state.hold = one.hold ?? state.hold;
    state.way = one.way ?? state.way;
    state.branch = one.branch ?? state.branch;
    Object.assign(state.map, one.map ?? {});
  }
  element('tour').hidden = false;
  element('tour-title').textContent = title;
  element('tour-text').textContent = step.text;
  element('tour-step').textContent = `${tour.step + 1} of ${steps.length}`;
  /** @type {HTMLButtonElement} */ (element('tour-back')).disabled = tour.step === 0;
  element('tour-next').textContent = tour.step === steps.length - 1 ? 'End' : 'Next';
  pointAt(step.at);
  showControls();
  change();
}

/** @param {string | null} id */
function pointAt(id) {
  for (const one of document.querySelectorAll('.pointed')) one.classList.remove('pointed');
  if (!id) return;
  element(id).classList.add('pointed');
  element(id).scrollIntoView({ block: 'nearest' });
}

function leaveTour() {
  if (!tour) return;
  hashToState(tour.before);
  tour = null;
  element('tour').hidden = true;
  const choice = /** @type {HTMLSelectElement} */ (element('tour-choice'));
  choice.value = '';
  choice.focus();
  pointAt(null);
  showControls();
  change();
}
