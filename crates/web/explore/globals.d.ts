// Types that the scripts share with those of the live page.
type Plot = import('../page/vendor/uplot/uPlot');
type PlotOptions = import('../page/vendor/uplot/uPlot').Options;
type PlotSeries = import('../page/vendor/uplot/uPlot').Series;
declare const fzstd: typeof import('../page/vendor/fzstd/fzstd');
interface Window { afmsweep: unknown }
