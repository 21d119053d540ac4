#include "report/page_parts.hpp"

namespace hybrid::report {

const char* const kPageStyle = R"css(:root {
  color-scheme: light dark;
  --ground: #fff; --ink: #1d1f21; --soft: #5b6168; --line: #d5d9dd; --shade: #f3f5f7;
  --accent: #1a5fb4; --bad: #b3261e; --good: #19703a; --warn: #8a5a00;
}
@media (prefers-color-scheme: dark) {
  :root {
    --ground: #16181b; --ink: #e6e8ea; --soft: #a2a9b0; --line: #3a3f45; --shade: #202328;
    --accent: #7db3f5; --bad: #ff8f86; --good: #7ed49b; --warn: #f0bd62;
  }
}
* { box-sizing: border-box; } [hidden] { display: none !important; }
body { margin: 0; background: var(--ground); color: var(--ink); font: 16px/1.5 system-ui, sans-serif; }
main { max-width: 84rem; margin: 0 auto; padding: 1rem; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: .5rem 0; overflow-wrap: anywhere; }
h2 { font-size: 1.25rem; margin: 2.2rem 0 .6rem; padding-top: .6rem; border-top: 1px solid var(--line);
     overflow-wrap: anywhere; }
h3 { font-size: 1rem; margin: 1.4rem 0 .4rem; }
a { color: var(--accent); }
p { margin: .4rem 0; max-width: 60rem; }
ul { padding-left: 1.2rem; }
li { overflow-wrap: anywhere; }
.facts { display: flex; flex-wrap: wrap; gap: .5rem; list-style: none; margin: .6rem 0; padding: 0; }
.facts li { background: var(--shade); border-radius: .4rem; padding: .2rem .7rem; }
.bad { color: var(--bad); } .good { color: var(--good); } .warn { color: var(--warn); }
.soft, figcaption, caption { color: var(--soft); font-size: .9rem; }
.row { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 26rem), 1fr)); gap: 1rem;
       align-items: start; margin: .6rem 0; }
.wide { grid-template-columns: 1fr; }
.small { grid-template-columns: repeat(auto-fill, minmax(min(100%, 12rem), 1fr)); }
.three { grid-template-columns: repeat(auto-fit, minmax(min(100%, 15rem), 1fr)); }
figure { margin: 0; }
img { display: block; width: 100%; height: auto; border: 1px solid var(--line); background: var(--shade); }
figcaption { padding-top: .2rem; overflow-wrap: anywhere; }
code, pre { font: .85rem/1.4 ui-monospace, monospace; background: var(--shade); border-radius: .3rem; }
code { display: inline-block; padding: .1rem .4rem; user-select: all; overflow-wrap: anywhere;
       white-space: pre-wrap; }
pre { padding: .6rem; overflow-x: auto; }
details { margin: .6rem 0; }
summary { cursor: pointer; }
.scroll { overflow-x: auto; border: 1px solid var(--line); border-radius: .3rem; }
table { border-collapse: collapse; font-size: .875rem; font-variant-numeric: tabular-nums; width: 100%; }
th, td { padding: .25rem .6rem; text-align: left; border-bottom: 1px solid var(--line); vertical-align: top; }
tr:last-child td { border-bottom: 0; }
th { background: var(--shade); font-weight: 600; vertical-align: bottom; }
th small { display: block; font-weight: 400; color: var(--soft); }
td.n, th.n { text-align: right; } td.n { white-space: nowrap; }
td:first-child, th:first-child { position: sticky; left: 0; background: var(--ground); }
th:first-child { background: var(--shade); }
th button { all: unset; display: block; width: 100%; cursor: pointer; } th button:focus-visible { outline: 2px solid var(--accent); }
th[aria-sort=ascending] button::before { content: "\25b2 "; }
th[aria-sort=descending] button::before { content: "\25bc "; }
.bar { display: flex; flex-wrap: wrap; gap: .3rem .8rem; align-items: baseline; margin: .4rem 0; }
.bar input { font: inherit; padding: .2rem .5rem; width: min(22rem, 100%); color: inherit;
             background: var(--ground); border: 1px solid var(--line); border-radius: .3rem; }
.more { font: inherit; margin: .4rem 0; }
svg { display: block; max-width: 100%; height: auto; }
svg text { fill: var(--ink); font: 12px system-ui, sans-serif; } svg .quiet { fill: var(--soft); }
svg rect { fill: var(--accent); } svg line { stroke: var(--line); } svg rect.second { fill: var(--soft); }
@media print { .bar, .more { display: none; } }
)css";

}  // namespace hybrid::report
