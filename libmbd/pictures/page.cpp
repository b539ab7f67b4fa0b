#include "libmbd/pictures/page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libmbd/text/text.hpp"

namespace mbd::study {

const std::string_view page_style = R"(:root { color-scheme: light; }
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; text-size-adjust: 100%; }
body { margin: 0; color: #111; background: #fff; overflow-wrap: break-word;
  font: 1rem/1.45 system-ui, "Segoe UI", Helvetica, Arial, sans-serif; }
main { max-width: 74rem; margin: 0 auto; padding: 0 1rem 3rem; }
h1 { font-size: 1.6rem; line-height: 1.2; margin: 1.2rem 0 .4rem; }
h2 { font-size: 1.25rem; margin: 2rem 0 .5rem; border-bottom: 2px solid #111; }
h3 { font-size: 1.05rem; margin: 1.4rem 0 .4rem; }
p, li, dd { max-width: 48rem; }
a { color: #0b4a80; }
.by { color: #444; margin-top: 0; }
.box { overflow-x: auto; max-width: 100%; }
.box:focus-visible { outline: 2px solid #0b4a80; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .94rem; }
caption { text-align: left; font-weight: bold; padding: .3rem 0; }
th, td { text-align: left; vertical-align: top; padding: .25rem .6rem; border-bottom: 1px solid #bbb; }
thead th { border-bottom: 2px solid #111; vertical-align: bottom; }
.n { text-align: right; white-space: nowrap; }
.w { white-space: nowrap; }
.quantities { display: grid; gap: 0 2rem; grid-template-columns: repeat(auto-fit, minmax(min(100%, 28rem), 1fr)); }
.quantities > *, .halves > * { min-width: 0; }
.halves { display: grid; gap: 0 2rem; grid-template-columns: repeat(auto-fit, minmax(min(100%, 30rem), 1fr)); }
.bars { display: grid; gap: .5rem 2rem; grid-template-columns: repeat(auto-fit, minmax(min(100%, 22rem), 1fr)); }
.sort { all: unset; cursor: pointer; }
.sort:focus-visible { outline: 2px solid #0b4a80; }
[aria-sort] .sort::after { content: " \25B2"; }
[aria-sort=descending] .sort::after { content: " \25BC"; }
figure svg { touch-action: pan-x pan-y; }
figure svg.near { cursor: grab; touch-action: none; }
.advice { width: 100%; max-width: 44rem; }
.advice tr.numbers > * { border-bottom: none; }
.advice td.change { padding-top: 0; }
.t { min-width: 12rem; }
.runs { font-size: .82rem; }
.runs td, .runs th { padding: .15rem .5rem; }
.runs th[scope=row] { white-space: nowrap; }
.runs tr.front th { font-weight: bold; }
.runs tr:not(.front) th { font-weight: normal; }
.runs tr:target { background: #eee; }
pre, code { font-family: ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace; }
pre { margin: .2rem 0; padding: .4rem .6rem; background: #f5f5f5; border: 1px solid #ccc; font-size: .8rem;
  white-space: pre-wrap; overflow-wrap: anywhere; }
.pictures { display: grid; gap: 1rem; grid-template-columns: repeat(auto-fit, minmax(min(100%, 30rem), 1fr)); }
figure { margin: 0; break-inside: avoid; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .2rem 1rem; }
dt { font-weight: bold; }
dd { margin: 0; min-width: 0; overflow-wrap: anywhere; }
summary { cursor: pointer; padding: .3rem 0; }
@media (max-width: 40rem) {
  main { padding: 0 .6rem 2rem; }
  th, td { padding: .25rem .35rem; }
  dl { grid-template-columns: 1fr; gap: 0; }
  dd { margin-bottom: .5rem; }
}
@media print {
  @page { margin: 14mm; }
  @page wide { size: landscape; }
  body { font-size: 9.5pt; }
  main { max-width: none; padding: 0; }
  p, li, dd { max-width: none; }
  .box { overflow: visible; }
  .quantities, .halves { grid-template-columns: 1fr; }
  [aria-sort] .sort::after { content: none; }
  .pictures { grid-template-columns: 1fr 1fr; }
  table { font-size: 8.5pt; }
  pre { font-size: 7.5pt; }
  .all { page: wide; }
  .runs { font-size: 7pt; }
  .runs td, .runs th { padding: .1rem .25rem; }
  .runs .t { min-width: 34em; }
  h2, h3, .numbers { break-after: avoid; }
  tr, pre { break-inside: avoid; }
  a { color: inherit; text-decoration: none; }
  details::details-content { content-visibility: visible; block-size: auto; }
  summary { list-style: none; }
}
)";

const std::string page_end = R"(</main>
<script>
(() => {
  const value = cell => {
    const text = cell ? cell.textContent.trim() : '', number = parseFloat(text.replace(/^[<>~ ]+/, ''));
    return Number.isFinite(number) ? number : text;
  };
  const less = (a, b) => typeof a === typeof b ? (a < b ? -1 : a > b ? 1 : 0) : typeof a === 'number' ? -1 : 1;
  for (const table of document.querySelectorAll('table.runs, table.orders')) {
    const heads = [...table.tHead.rows[0].cells], body = table.tBodies[0];
    heads.forEach((head, i) => {
      const button = document.createElement('button');
      button.type = 'button';
      button.className = 'sort';
      button.title = 'sort';
      button.append(...head.childNodes);
      head.append(button);
      button.addEventListener('click', () => {
        const down = head.getAttribute('aria-sort') === 'ascending';
        for (const other of heads) other.removeAttribute('aria-sort');
        head.setAttribute('aria-sort', down ? 'descending' : 'ascending');
        const rows = [...body.rows].map(row => ({row, v: value(row.cells[i])}));
        rows.sort((a, b) => typeof a.v !== typeof b.v ? less(a.v, b.v) : (down ? -1 : 1) * less(a.v, b.v));
        body.append(...rows.map(r => r.row));
      });
    });
  }
  for (const svg of document.querySelectorAll('figure svg[viewBox]')) {
    const whole = svg.viewBox.baseVal, all = [whole.x, whole.y, whole.width, whole.height];
    let box = all.slice(), from = null;
    const show = () => {
      for (const k of [0, 1]) box[k] = Math.min(Math.max(box[k], all[k]), all[k] + all[k + 2] - box[k + 2]);
      svg.setAttribute('viewBox', box.join(' '));
      svg.classList.toggle('near', box[2] < all[2]);
    };
    const at = event => {
      const r = svg.getBoundingClientRect();
      return [box[0] + (event.clientX - r.left) / r.width * box[2], box[1] + (event.clientY - r.top) / r.height * box[3]];
    };
    svg.tabIndex = 0;
    svg.addEventListener('dblclick', event => {
      const p = at(event), f = box[2] < all[2] / 7 ? 8 : 0.5;
      box = f > 1 ? all.slice() : [p[0] - f * (p[0] - box[0]), p[1] - f * (p[1] - box[1]), f * box[2], f * box[3]];
      show();
      event.preventDefault();
    });
    svg.addEventListener('pointerdown', event => { if (box[2] < all[2]) from = at(event), svg.setPointerCapture(event.pointerId); });
    svg.addEventListener('pointermove', event => {
      if (!from) return;
      const p = at(event);
      box[0] += from[0] - p[0], box[1] += from[1] - p[1];
      show();
    });
    for (const end of ['pointerup', 'pointercancel']) svg.addEventListener(end, () => { from = null; });
    svg.addEventListener('keydown', event => { if (event.key === 'Escape') box = all.slice(), show(); });
  }
})();
</script>
</body>
</html>
)";

std::string page_begin(std::string_view title, std::string_view by) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0}</title>\n<style>\n{1}</style>\n</head>\n<body>\n<main>\n"
      "<h1>{0}</h1>\n<p class=\"by\">{2}</p>\n",
      xml_escaped(title), page_style, xml_escaped(by));
}

// Each line escaped.
std::string escaped_lines(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    result += xml_escaped(text.substr(0, end));
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
    if (!text.empty()) result += '\n';
  }
  return result;
}

// Escaped, and numbers with an exponent are not broken at its sign.
std::string prose(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string word = xml_escaped(text.substr(0, end));
    const bool number = word.find("e-") != std::string::npos && word[0] >= '0' && word[0] <= '9';
    result += number ? "<span class=\"w\">" + word + "</span>" : word;
    if (end < text.size()) result += ' ';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

}  // namespace mbd::study
