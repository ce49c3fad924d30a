#pragma once
// Style of all pages: system fonts, light or dark by the reader's setting, one column on a phone.
namespace ngs::cli {

inline constexpr const char* kStyle = R"css(
:root{color-scheme:light dark;--ground:#fbfaf7;--ink:#1d2126;--soft:#5d6670;--line:#dcd9d1;--panel:#fff;--accent:#b4481e;--bar:#3f7cac;--warn:#8a5a00}
@media (prefers-color-scheme:dark){:root{--ground:#15181c;--ink:#e6e4df;--soft:#9aa3ad;--line:#333a42;--panel:#1d2227;--accent:#ff9a6b;--bar:#6fa8d6;--warn:#e6b455}}
*{box-sizing:border-box}
body{margin:0;background:var(--ground);color:var(--ink);font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,sans-serif}
main,header,footer{max-width:76rem;margin:0 auto;padding:0 1.25rem}
header{padding-top:2.2rem}
h1{font-size:1.7rem;line-height:1.2;margin:0 0 .3rem;overflow-wrap:anywhere}
h2{font-size:1.15rem;margin:2.6rem 0 .7rem;padding-top:.8rem;border-top:1px solid var(--line)}
h3{font-size:1rem;margin:1.4rem 0 .4rem}
p{max-width:46rem}
.note,footer,figcaption{color:var(--soft);font-size:.88rem}
footer{padding-top:2rem;padding-bottom:3rem}
.tiles{display:flex;flex-wrap:wrap;gap:.6rem 2.2rem;margin:1.2rem 0 0;padding:0}
.tiles div{min-width:6.5rem}
.tiles dt{color:var(--soft);font-size:.88rem}
.tiles dd{margin:0;font-size:1.55rem;font-weight:600;font-variant-numeric:tabular-nums}
.tiles small{font-size:.8rem;font-weight:400;color:var(--soft);display:block}
.scroll{overflow-x:auto;background:linear-gradient(90deg,var(--ground) 30%,transparent) local 0/3rem 100% no-repeat,linear-gradient(270deg,var(--ground) 30%,transparent) local 100%/3rem 100% no-repeat,linear-gradient(90deg,var(--line),transparent) 0/.8rem 100% no-repeat,linear-gradient(270deg,var(--line),transparent) 100%/.8rem 100% no-repeat}
table{border-collapse:collapse;font-size:.92rem;margin:.4rem 0 1rem}
p.note{margin:.4rem 0}
th,td{padding:.28rem .8rem .28rem 0;text-align:left;vertical-align:top;border-bottom:1px solid var(--line)}
thead th{color:var(--soft);font-weight:500;white-space:nowrap}
tbody th{font-weight:500}
td{font-variant-numeric:tabular-nums}
td table{margin:0}
tr.best td,b{font-weight:650}
.bars td:nth-child(2){min-width:9rem;width:40%}
.bars table{width:100%;max-width:46rem}
.bars th,.bars td{white-space:nowrap}
.bars .child th{padding-left:1.2rem;font-weight:400;color:var(--soft)}
svg.bar{display:block;width:100%;height:.8rem;margin-top:.32rem}
svg.bar rect{fill:var(--bar)}
ul.odd{padding-left:1.1rem;max-width:60rem}
ul.odd li{margin:.25rem 0;overflow-wrap:anywhere}
ul.odd b{color:var(--warn)}
details{margin:.5rem 0}
summary{cursor:pointer;color:var(--accent)}
a{color:var(--accent)}
a.button{display:inline-block;padding:.45rem 1.1rem;border-radius:4px;background:var(--accent);color:var(--ground);text-decoration:none;font-weight:600}
details.made{margin-top:2.6rem;border-top:1px solid var(--line);padding-top:.8rem}
details th,details td{overflow-wrap:anywhere}
code{font:.88em ui-monospace,SFMono-Regular,Menlo,Consolas,monospace}
.legend{display:flex;flex-wrap:wrap;gap:.3rem 1.4rem;margin:.2rem 0 1rem}
.legend label,.legend span{display:flex;align-items:center;gap:.4rem}
.legend label{cursor:pointer}
.legend svg{width:2.4rem;height:1rem;background:#6b6f73;border-radius:2px}
.sheet{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,17rem),1fr));gap:1.1rem}
.small{grid-template-columns:repeat(auto-fill,minmax(min(45%,11rem),1fr))}
.opening{grid-template-columns:repeat(3,1fr)}
.opening figure:first-child{grid-column:1/3;grid-row:1/3}
.sheet.opening{margin-top:1.4rem}
@media (max-width:40rem){.opening{grid-template-columns:1fr}.opening figure:first-child{grid-column:auto;grid-row:auto}}
.crops{grid-template-columns:repeat(auto-fill,minmax(min(45%,17rem),1fr))}
.sheet .note{grid-column:1/-1}
figure{margin:0}
figcaption{margin-top:.3rem}
figcaption b{color:var(--ink)}
figcaption em{color:var(--warn);font-style:normal}
.stack{position:relative;line-height:0;background:#777;overflow:hidden}
.stack img{width:100%;height:auto;display:block}
.stack svg{position:absolute;inset:0;width:100%;height:100%}
.wide{grid-template-columns:repeat(auto-fill,minmax(min(100%,22rem),1fr))}
.flip label{display:block;cursor:pointer}
.flip input{position:absolute;opacity:0}
span.stack{display:block}
.flip .after{position:absolute;inset:0;opacity:0;transition:opacity .25s}
.flip input:checked~.stack .after{opacity:1}
.flip:has(input:checked) .of-before,.flip:not(:has(input:checked)) .of-after{display:none}
.flip input:focus-visible~.stack{outline:3px solid var(--accent)}
pre{font:.85rem/1.6 ui-monospace,SFMono-Regular,Menlo,Consolas,monospace;white-space:pre-wrap;overflow-wrap:anywhere;background:var(--panel);border:1px solid var(--line);padding:.8rem 1rem;border-radius:4px}
.crop img{image-rendering:pixelated}
.stack path,.legend path{fill:none;vector-effect:non-scaling-stroke;stroke-width:1.7px;stroke-linejoin:round}
path.casing{stroke:#000!important;stroke-opacity:.45;stroke-width:3.6px!important;stroke-dasharray:none!important}
.predicted path{stroke:#ff6a2b}
.truth path{stroke:#22d3ff}
.given path{stroke:#ff6a2b}
.input path{stroke:#fff;stroke-dasharray:4 3}
.views:has(.t-predicted:not(:checked)) .stack .predicted,.views:has(.t-truth:not(:checked)) .stack .truth,.views:has(.t-input:not(:checked)) .stack .input{display:none}
.charts{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,22rem),1fr));gap:1.2rem}
figure.chart{flex:1 1 22rem;max-width:40rem}
svg.plot{width:100%;height:auto;font-size:13px}
svg.plot text{fill:var(--soft)}
svg.plot .grid{stroke:var(--line)}
svg.plot polyline{fill:none;stroke-width:2;stroke:var(--bar)}
svg.plot circle{fill:var(--bar)}
svg.plot .series1 polyline{stroke:var(--accent)}
svg.plot .series1 circle{fill:var(--accent)}
svg.plot .series2 polyline{stroke:var(--soft)}
svg.plot .series2 circle{fill:var(--soft);fill-opacity:.55}
svg.plot .whisker{stroke:var(--soft);stroke-width:1.5}
svg.plot g text{fill:var(--ink);paint-order:stroke;stroke:var(--ground);stroke-width:4px;stroke-linejoin:round}
@media print{
:root{color-scheme:light;--ground:#fff;--ink:#111;--soft:#444;--line:#bbb;--panel:#fff;--accent:#8a3414;--bar:#2d6290;--warn:#6d4700}
body{font-size:10.5pt;print-color-adjust:exact;-webkit-print-color-adjust:exact}
main,header,footer{max-width:none;padding:0}
h2,h3,thead,p.note{break-after:avoid}
figcaption{break-before:avoid}
figure,tr,.tiles div{break-inside:avoid}
.legend input,.screen,details:not([open]),section[id$=tools]{display:none}
.opening figure{margin-bottom:.5rem}
.scroll{overflow:visible;background:none}
table{font-size:8.5pt}
thead th{white-space:normal}
.sheet{grid-template-columns:repeat(4,1fr)}
.sheet.small{grid-template-columns:repeat(5,1fr)}
.sheet.opening{display:block;max-width:88%}
.opening figure:first-child{grid-column:auto;grid-row:auto}
.flip .stack{display:grid;grid-template-columns:1fr 1fr;gap:.3rem;background:none}
.flip .after{position:static;opacity:1}
.flip span.of-before,.flip span.of-after{display:inline!important}
.of-before::after{content:", "}
}
)css";

}  // namespace ngs::cli
