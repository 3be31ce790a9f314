// Guided tours: short texts that move the sliders and point at a picture. Every number in a text was read from the page at
// that step; read them again when the engine changes. test/browser.mjs compares one of them.

/**
 * @typedef {{text: string, values?: Record<string, number>, law?: string, hold?: Hold, way?: 0 | 1, branch?: string,
 *   map?: Partial<MapChoice>, at: string}} Step
 */

/** A stiff lever on polystyrene in air. @type {Record<string, number>} */
const STIFF = {
  k: 26,
  f: 300e3,
  q: 400,
  r: 10e-9,
  e: 2e9,
  nu: 0.3,
  w: 0.066,
  lt: 0,
  a: 20e-9,
  acc: 1e-3,
  far: 1.1,
  near: 0.2,
};
/** Without adhesion and with a blunter tip, so that the loss is all that changes. */
const BLUNT = { ...STIFF, r: 20e-9, w: 0 };
/** A soft lever on a soft sample. */
const SOFT = { ...STIFF, k: 0.3, f: 12e3, e: 20e6, nu: 0.5, w: 0, a: 10e-9 };

/** @type {{title: string, steps: Step[]}[]} */
const TOURS = [
  {
    title: 'Attractive and repulsive',
    steps: [
      {
        text:
          'A stiff lever taps on polystyrene with a free amplitude of 20 nm. The sample comes nearer: follow ' +
          'the blue line from right to left. Near a gap of 18 nm it jumps.',
        values: { ...STIFF, g: 18.5e-9 },
        law: 'dmt',
        hold: 'gap',
        way: 0,
        branch: 'any',
        at: 'c-phase',
      },
      {
        text:
          'Here, at a gap of 18.5 nm on the approach, the lag is 111°. It is above 90° because the attraction ' +
          'lowers the resonance below the drive. The tip touches by 0.1 nm, yet the force on it never pushes.',
        at: 'motion',
      },
      {
        text:
          'The same gap on the way back. Now the lag is 78° and the sample pushes with 5.8 nN. At one gap ' +
          'there are two steady motions; which one you see depends on the way there.',
        way: 1,
        at: 'motion',
      },
      {
        text:
          'With a free amplitude of 8 nm the tip stays on the attractive branch as far as this curve goes: ' +
          'the lag rises all the way, and the force never pushes.',
        values: { a: 8e-9, g: 6e-9 },
        way: 0,
        at: 'c-phase',
      },
      {
        text:
          'With 60 nm there is no jump. The lag falls below 90° soon after the first touch. Small amplitudes ' +
          'feel the attraction; large ones tap.',
        values: { a: 60e-9, g: 50e-9 },
        at: 'c-phase',
      },
    ],
  },
  {
    title: 'Set-point and force',
    steps: [
      {
        text:
          'A microscope does not know the gap. It moves the sample until the amplitude is what was asked for. ' +
          'Here it holds 90 % of the free amplitude: the gap is 16.8 nm, and the tip pushes with 7.7 nN.',
        values: { ...STIFF, s: 0.9 },
        law: 'dmt',
        hold: 'setpoint',
        branch: 'any',
        at: 'c-amplitude',
      },
      { text: 'At 70 % the sample is nearer, and the force is larger: 9.3 nN.', values: { s: 0.7 }, at: 'c-force_max' },
      {
        text:
          'At 50 % it is still 9.3 nN. A lower set-point does not always push harder: over the gap the ' +
          'largest force is flat here, and it falls again at small gaps.',
        values: { s: 0.5 },
        at: 'c-force_max',
      },
      {
        text:
          'The free amplitude counts more. With 60 nm in place of 20 nm a set-point of 70 % takes 26 nN, ' +
          'almost three times as much.',
        values: { a: 60e-9, s: 0.7 },
        at: 'c-force_max',
      },
      {
        text:
          'A softer lever of 2.8 N/m and 75 kHz with 20 nm holds 70 % without touching at all: the lag is ' +
          '136°, on the attractive branch.',
        values: { k: 2.8, f: 75e3, q: 180, a: 20e-9 },
        at: 'c-phase',
      },
      {
        text:
          'The map shows the largest force of the stiff lever over free amplitude and set-point. It changes ' +
          'far more from left to right than from bottom to top. Click on it to go there.',
        values: { ...STIFF, s: 0.7 },
        map: { x: 'a', y: 's', of: 'force_max' },
        at: 'map',
      },
    ],
  },
  {
    title: 'Phase contrast: energy loss',
    steps: [
      {
        text:
          'An elastic sample loses nothing. At a set-point of 80 % the lag is then 53.1°, for its sine is ' + '0.8.',
        values: { ...BLUNT, s: 0.8 },
        law: 'hertz',
        hold: 'setpoint',
        branch: 'any',
        map: { x: 'lt', y: 'e', of: 'phase' },
        at: 'motion',
      },
      {
        text:
          'A sample of 5 GPa in place of 2 GPa has the same lag, 53.1°. The force has grown from 7.2 nN to 9 ' +
          'nN, but a phase image at this set-point shows no difference.',
        values: { e: 5e9 },
        at: 'motion',
      },
      {
        text:
          'Back to 2 GPa, with a loss tangent of 0.1. The lag is 57.1°: the sample takes 2.6 aJ in every ' +
          'period. The loop of force over distance is open, and what it encloses is that energy.',
        values: { e: 2e9, lt: 0.1 },
        at: 'm-distance-figure',
      },
      {
        text:
          'With a loss tangent of 0.3 the lag is 59.2° and the loss 3.8 aJ, not three times as much: the tip ' +
          'sinks in less, 0.49 nm in place of 0.61 nm.',
        values: { lt: 0.3 },
        at: 'motion',
      },
      {
        text:
          'The map shows the lag over the loss tangent and the modulus, from 53.7° to 61.4°. Viscous samples ' +
          'take longer: their map needs some seconds.',
        values: { lt: 0.1 },
        map: { ranges: { lt: [0.01, 0.5], e: [0.5e9, 5e9] } },
        at: 'map',
      },
    ],
  },
  {
    title: 'In a liquid',
    steps: [
      {
        text:
          'A soft lever, 0.3 N/m, on a soft sample, 20 MPa. With a quality factor of 400 it holds 80 % of 10 ' +
          'nm with no more than 36 pN.',
        values: { ...SOFT, s: 0.8 },
        law: 'hertz',
        hold: 'setpoint',
        branch: 'any',
        at: 'c-force_max',
      },
      {
        text:
          'In a liquid the quality factor is some 3. The same set-point now takes 1.26 nN, some 35 times as ' +
          'much: without a resonance to help, the drive is far stronger, and the sample has to work against ' +
          'it.',
        values: { q: 3 },
        at: 'c-force_max',
      },
      {
        text: 'The tip is in contact for 35 % of the period and sinks in by 5 nm. It no longer taps; it presses.',
        at: 'motion',
      },
      { text: 'A set-point of 95 % is gentler: 0.62 nN, for 25 % of the period.', values: { s: 0.95 }, at: 'motion' },
      {
        text:
          'A gel of 1 MPa, again at 80 %: the tip never lets go of it. It sinks in by 55 nm, five times its ' +
          'own radius, far beyond what the contact laws are made for. The program warns of it: open the list.',
        values: { s: 0.8, e: 1e6, near: -6 },
        at: 'warnings',
      },
    ],
  },
  {
    title: 'What the error means',
    steps: [
      {
        text:
          'Each number here has an estimated error. It is that of the worst observable: of the amplitude as a ' +
          'share of the free one, of the forces as a share of the largest, of the phase in radians. Asked for ' +
          'is 1e-3; the largest of this curve is some 5e-4.',
        values: { ...STIFF, g: 16e-9 },
        law: 'dmt',
        hold: 'gap',
        way: 0,
        branch: 'any',
        at: 'summary',
      },
      {
        text:
          'Asked for 1e-2, the program takes fewer steps. The largest error is some 5e-3 now, and the curve ' +
          'looks the same.',
        values: { acc: 1e-2 },
        at: 'summary',
      },
      {
        text:
          'Asked for 1e-4 the largest error is some 5e-5. It takes longer, and the curve still looks the ' +
          'same. Ask for what you need.',
        values: { acc: 1e-4 },
        at: 'summary',
      },
      {
        text:
          'Under JKR on a softer sample some points have no steady motion: the tip sticks and tears off at ' +
          'odd times. They are marked × and left out of the lines. The list says why.',
        values: { acc: 1e-3, e: 200e6 },
        law: 'jkr',
        at: 'c-amplitude',
      },
      {
        text:
          'The estimated error is that of the computation, not of the model. Back on DMT and 2 GPa the ' +
          'program warns that DMT is an approximation here, and that the contact is too wide for the laws. No ' +
          'finer step mends that.',
        values: { e: 2e9 },
        law: 'dmt',
        at: 'warnings',
      },
    ],
  },
];
