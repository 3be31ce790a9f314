// Types that the scripts share; uPlot itself is declared with its types.
type Plot = import('./vendor/uplot/uPlot');
type PlotOptions = import('./vendor/uplot/uPlot').Options;
type PlotSeries = import('./vendor/uplot/uPlot').Series;
declare const fzstd: typeof import('./vendor/fzstd/fzstd');
interface Window { afmsweep: unknown }
