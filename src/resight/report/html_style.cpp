// SPDX-License-Identifier: Apache-2.0
#include "resight/report/internal/html.hpp"

namespace resight::report {

std::string_view page_style() {
  return R"css(
:root { --ink:#1c2430; --soft:#5d6878; --line:#dde2ea; --ground:#f5f6f9; --card:#fff; --accent:#2a5bd7;
        --good:#18794e; --bad:#c62f38; --added:#18794e; --moved:#b26a00; --removed:#c62f38; }
* { box-sizing:border-box; }
html { background:var(--ground); color:var(--ink); font:15px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,sans-serif; }
body { max-width:1360px; margin:0 auto; padding:28px 24px 60px; }
h1 { font-size:26px; line-height:1.2; margin:0 0 4px; }
h2 { font-size:18px; margin:34px 0 10px; }
h3 { font-size:15px; margin:0; }
p.lead { color:var(--soft); margin:0 0 8px; }
a { color:var(--accent); }
section.card, article { background:var(--card); border:1px solid var(--line); border-radius:8px; padding:14px 16px; overflow-x:auto; }
article { margin:0 0 16px; break-inside:avoid; }
table { border-collapse:collapse; font-variant-numeric:tabular-nums; }
th, td { text-align:left; padding:3px 14px 3px 0; vertical-align:top; white-space:nowrap; }
th { font-weight:600; color:var(--soft); font-size:13px; }
tbody tr + tr > * { border-top:1px solid var(--line); }
td.n, th.n { text-align:right; }
td.good { color:var(--good); } td.bad { color:var(--bad); }
.soft { color:var(--soft); font-size:13px; }
.runs { display:grid; grid-template-columns:repeat(auto-fit,minmax(min(100%,420px),1fr)); gap:18px; margin-top:8px; }
.runs img { display:block; width:100%; max-width:640px; height:auto; border-radius:4px; background:#000; }
.runs > div { min-width:0; overflow-x:auto; }
.runs table { font-size:12px; margin-top:8px; }
.runs th { font-size:12px; } .runs th, .runs td { padding-right:9px; }
.patch { display:inline-block; width:11px; height:11px; border-radius:3px; margin-right:6px; border:1px solid rgba(0,0,0,.35); }
.events { list-style:none; margin:8px 0 0; padding:0; font-size:13px; }
.tag { display:inline-block; min-width:64px; padding:0 7px; margin-right:7px; border-radius:9px; text-align:center; font-size:12px; color:#fff; background:#77818f; }
.tag.added { background:var(--added); } .tag.moved { background:var(--moved); } .tag.removed { background:var(--removed); }
.history td, .history th { padding:1px; text-align:center; font-size:12px; }
.history th.name { text-align:left; padding-right:14px; color:var(--ink); font-weight:400; position:sticky; left:0; background:var(--card); }
.history tbody tr + tr > * { border-top:0; }
.cell { display:block; width:20px; height:20px; line-height:20px; border-radius:3px; color:#fff; font-weight:700; }
.cell.found { background:#4a6fb5; } .cell.still { background:#8fa8d4; } .cell.added { background:var(--added); }
.cell.moved { background:var(--moved); } .cell.removed { background:var(--removed); }
.cell.unseen { background:#e3e7ee; color:#7a8494; } .cell.none { background:transparent; }
.bar { display:inline-block; height:9px; background:var(--accent); border-radius:2px; vertical-align:middle; min-width:1px; }
.legend span { margin-right:18px; white-space:nowrap; }
.legend .cell { display:inline-block; vertical-align:middle; text-align:center; font-size:12px; margin-right:5px; }
details { margin-top:8px; font-size:13px; } summary { cursor:pointer; color:var(--soft); }
nav { font-size:14px; margin:10px 0 0; } nav a { margin-right:16px; }
@media print { html { background:#fff; font-size:11px; } body { max-width:none; padding:0; } nav { display:none; }
  section.card, article { border-color:#bbb; } .cell, .tag, .bar, .patch { print-color-adjust:exact; -webkit-print-color-adjust:exact; } }
)css";
}

}  // namespace resight::report
