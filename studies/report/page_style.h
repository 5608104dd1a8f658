// The style of index.html: readable on a screen, on a phone and on paper.
#pragma once

namespace ed3r::report {

inline constexpr char kPageStyle[] = R"css(
:root{color-scheme:light;--ink:#1d2327;--faint:#68737b;--line:#d9dee2;--blue:#0b5c92;--green:#0a7a52}
*{box-sizing:border-box}
body{margin:0 auto;max-width:72rem;padding:1.5rem;font:16px/1.5 system-ui,"DejaVu Sans",sans-serif;color:var(--ink);background:#fff}
header{display:flex;flex-wrap:wrap;align-items:baseline;justify-content:space-between;gap:.5rem;border-bottom:2px solid var(--ink)}
h1{margin:.2rem 0;font-size:1.7rem}
h2{margin:2.4rem 0 .6rem;font-size:1.3rem}
h3{margin:1.6rem 0 .4rem;font-size:1rem}
nav a{margin-left:1rem}
a{color:var(--blue)}
dl{display:grid;grid-template-columns:max-content 1fr;gap:.15rem 1.2rem;margin:0}
dt{color:var(--faint)}
dd{margin:0;overflow-wrap:anywhere}
code{font:.85em ui-monospace,"DejaVu Sans Mono",monospace;overflow-wrap:anywhere}
small{color:var(--faint);font-weight:normal}
.wide{overflow-x:auto}
table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:.88rem;width:100%}
th,td{padding:.32rem .6rem;text-align:right;vertical-align:top;border-bottom:1px solid var(--line);white-space:nowrap}
tr:first-child th{border-bottom:2px solid var(--ink);vertical-align:bottom;white-space:normal}
th:first-child{text-align:left}
td b,td i,td u{display:block;line-height:1.3}
td i{font-style:normal;font-size:.85em;color:var(--faint)}
td u,.key u{text-decoration:none;font-size:.85em;color:#a0522d}
td u::before{content:"paper "}
u.in{color:var(--green)!important}
.key,.files{font-size:.85rem;color:var(--faint)}
.files a{margin-right:.6rem}
.note{padding:.5rem .8rem;background:#fdf6e3;border-left:4px solid #c9a227}
figure{margin:1.6rem 0 2.4rem}
img{max-width:100%;height:auto}
figcaption{max-width:60rem;font-size:.9rem;color:#3c464d}
.chips span,td span{display:inline-block;padding:.05rem .5rem;border-radius:.3rem;margin:.1rem .2rem .1rem 0;white-space:nowrap}
.v-reproduced,.v-equivalent{background:#cfeadd}.v-direction{background:#e3f0d4}.v-differs{background:#f6d5cf}
.v-not,.v-imprecise{background:#e9ecef}.v-paper{background:#fbe9c0}
.claims .text{text-align:left;white-space:normal;min-width:9rem}
.claims small{display:block}
summary{cursor:pointer;color:var(--blue)}
@media print{nav,.files{display:none}figure,tr{break-inside:avoid}}
)css";

}  // namespace ed3r::report
