// SPDX-License-Identifier: MIT
#pragma once

namespace apps {

/// The report's style sheet: one column, light and dark, fit for printing. Pictures stay on white.
inline constexpr const char* kReportStyle = R"css(
:root {
  --paper: #f6f7f9; --card: #ffffff; --ink: #1d2230; --soft: #5d6675; --line: #dfe3e9;
  --accent: #1f5fb4; --best: #e3eefc; --error: #a3271f;
}
@media (prefers-color-scheme: dark) {
  :root {
    --paper: #12151b; --card: #1b2029; --ink: #e7eaf0; --soft: #9aa4b4; --line: #2d3440;
    --accent: #7fb2f5; --best: #1e3350; --error: #f08a80;
  }
}
* { box-sizing: border-box; }
body {
  margin: 0; background: var(--paper); color: var(--ink);
  font: 16px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif;
  -webkit-text-size-adjust: 100%;
}
header, main, footer { max-width: 1240px; margin: 0 auto; padding: 0 24px; }
header { padding-top: 56px; padding-bottom: 8px; }
h1 { margin: 0; font-size: 2.4rem; line-height: 1.15; letter-spacing: -0.02em; overflow-wrap: anywhere; }
h2 { margin: 56px 0 16px; font-size: 1.4rem; letter-spacing: -0.01em; }
h3 { margin: 0 0 16px; font-size: 1.05rem; overflow-wrap: anywhere; }
.kicker {
  margin: 0 0 8px; color: var(--accent); font-size: 0.8rem; font-weight: 600;
  letter-spacing: 0.08em; text-transform: uppercase;
}
.lead, .hint { color: var(--soft); }
.lead { margin: 8px 0 0; font-size: 1.05rem; }
.hint { margin: 8px 0 0; font-size: 0.875rem; }
article, section > figure, .scroll, section > details {
  margin: 0 0 24px; padding: 24px; background: var(--card);
  border: 1px solid var(--line); border-radius: 12px;
}
figure { margin: 0; }
figure img { display: block; max-width: 100%; height: auto; margin: 0 auto; border-radius: 8px; background: #fff; }
figcaption { margin-top: 12px; color: var(--soft); font-size: 0.9rem; }
figcaption b { color: var(--ink); font-weight: 600; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(180px, 1fr)); gap: 16px; margin: 0 0 24px; }
.tile {
  display: flex; flex-direction: column; padding: 18px 20px; background: var(--card);
  border: 1px solid var(--line); border-radius: 12px;
}
.tile span, .tile small { color: var(--soft); font-size: 0.85rem; overflow-wrap: anywhere; }
.tile b { font-size: 2rem; line-height: 1.3; font-weight: 650; font-variant-numeric: tabular-nums; }
.tile i { margin-left: 4px; color: var(--soft); font-size: 1rem; font-style: normal; font-weight: 400; }
.scroll { overflow-x: auto; padding: 8px 0; margin-bottom: 0; }
table { width: 100%; border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: 9px 24px; border-bottom: 1px solid var(--line); text-align: right; white-space: nowrap; }
tbody tr:last-child > * { border-bottom: 0; }
th:first-child { text-align: left; }
tbody th { font-weight: 400; }
thead th { vertical-align: bottom; font-weight: 600; }
thead small { display: block; white-space: normal; color: var(--soft); font-weight: 400; }
.words td, .words th { padding: 9px 12px; text-align: left; white-space: normal; vertical-align: top; min-width: 6em; }
.unit { margin-left: 8px; color: var(--soft); font-size: 0.85rem; }
.best { background: var(--best); color: var(--accent); font-weight: 650; }
.none { color: var(--soft); }
dl { display: grid; grid-template-columns: repeat(auto-fill, minmax(150px, 1fr)); gap: 14px 24px; margin: 24px 0 0; }
dt { color: var(--soft); font-size: 0.82rem; }
dd { margin: 0; font-variant-numeric: tabular-nums; overflow-wrap: anywhere; }
.notes { margin: 20px 0 0; padding-left: 20px; color: var(--soft); font-size: 0.9rem; }
details { margin-top: 20px; }
section > details { padding: 14px 24px; margin: 0 0 12px; }
summary { cursor: pointer; color: var(--accent); font-size: 0.92rem; overflow-wrap: anywhere; }
pre {
  margin: 12px 0 0; padding: 16px; max-height: 420px; overflow: auto; background: var(--paper);
  border-radius: 8px; font: 0.8rem/1.5 ui-monospace, SFMono-Regular, Menlo, Consolas, monospace;
}
.errors { margin: 0; padding: 18px 24px 18px 40px; background: var(--card); border: 1px solid var(--line); border-radius: 12px; }
.errors b { color: var(--error); }
footer { padding-top: 40px; padding-bottom: 48px; color: var(--soft); font-size: 0.85rem; }
@media (max-width: 640px) {
  header, main, footer { padding-left: 14px; padding-right: 14px; }
  article, section > figure { padding: 14px; }
  th, td { padding: 8px 12px; }
  tbody th { white-space: normal; }
}
@media print {
  :root { --paper: #fff; --card: #fff; --ink: #000; --soft: #444; --line: #ccc; --accent: #124a94; --best: #e8eef6; }
  body { font-size: 10.5pt; }
  header { padding-top: 0; }
  article, figure, tr, .tile { break-inside: avoid; }
  h2, h3 { break-after: avoid; }
}
)css";

}  // namespace apps
