// What pages of studies have in common: #data (JSON) fills what says so by its attributes, tables are sorted by a click on
// the head of a column, pictures grow by a double click. Texts of the data become text, never markup; pictures are XML.
//   data-if="runs"         goes where the data have no such thing, or an empty one
//   data-text="norm"       the text
//   data-pre="command"     the text, as it is
//   data-list="notes"      a child for each text: <li>, or <p>
//   data-figures="cost"    pictures
//   data-facts="facts"     names and values of a <dl>
//   data-rows="orders"     rows of a table, whose heads have data-cell: what of the row stands in the column. A head with
//                          data-head is that of cells that head their row, with data-link of links to runs
'use strict';
const page = (() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const all = selector => [...document.querySelectorAll(selector)];
  const element = (tag, more, ...children) => {
    const e = Object.assign(document.createElement(tag), more);
    e.append(...children);
    return e;
  };
  const of = (from, path) => path.split('.').reduce((x, key) => x === undefined || x === null ? x : x[key], from);
  const none = x => x === undefined || x === null || x === '' || x === false || Array.isArray(x) && x.length === 0;

  // Numbers with an exponent are not broken at its sign.
  const prose = text => text.split(/( )/).map(word =>
    /^[0-9].*e-/.test(word) ? element('span', {className: 'w', textContent: word}) : word);

  function figure(svg) {
    const root = new DOMParser().parseFromString(svg, 'image/svg+xml').documentElement;
    return element('figure', {}, document.importNode(root, true));
  }

  // Rows as the heads of the table say; each is seen by `more` with its element.
  function fill(table, rows, more = () => {}) {
    const heads = [...table.tHead.rows[0].cells];
    for (const row of rows) {
      const line = element('tr', {});
      for (const head of heads) {
        const cell = element('head' in head.dataset ? 'th' : 'td', {className: head.className});
        if (cell.tagName === 'TH') cell.scope = 'row';
        const value = of(row, head.dataset.cell), text = none(value) ? '' : String(value);
        cell.append(...('link' in head.dataset
          ? [element('a', {href: '#run-' + text, textContent: head.dataset.link + text})] : prose(text)));
        line.append(cell);
      }
      more(line, row);
      table.tBodies[0].append(line);
    }
  }

  for (const e of all('[data-if]')) if (none(of(data, e.dataset.if))) e.remove();
  for (const e of all('[data-text]')) e.append(...prose(of(data, e.dataset.text)));
  for (const e of all('[data-pre]')) e.textContent = of(data, e.dataset.pre);
  for (const e of all('[data-list]'))
    e.append(...of(data, e.dataset.list).map(text => element(e.tagName === 'UL' ? 'li' : 'p', {}, ...prose(text))));
  for (const e of all('[data-figures]')) e.append(...of(data, e.dataset.figures).map(figure));
  for (const e of all('[data-facts]'))
    for (const [name, value] of of(data, e.dataset.facts))
      e.append(element('dt', {textContent: name}), element('dd', {textContent: value}));
  for (const e of all('[data-rows]')) fill(e, of(data, e.dataset.rows));

  const value = cell => {
    const text = cell ? cell.textContent.trim() : '', number = parseFloat(text.replace(/^[<>~● ]+/, ''));
    return Number.isFinite(number) ? number : text;
  };
  const less = (a, b) => typeof a === typeof b ? (a < b ? -1 : a > b ? 1 : 0) : typeof a === 'number' ? -1 : 1;
  function sortable(table) {
    const heads = [...table.tHead.rows[0].cells], body = table.tBodies[0];
    heads.forEach((head, i) => {
      const button = element('button', {type: 'button', className: 'sort', title: 'sort'}, ...head.childNodes);
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

  function enlarges(svg) {
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

  // The last thing that a page does.
  function finish() {
    for (const table of all('table.runs, table.orders')) sortable(table);
    for (const svg of all('figure svg[viewBox]')) enlarges(svg);
    const root = document.documentElement;
    root.classList.toggle('dark', window.matchMedia('(prefers-color-scheme: dark)').matches);
    document.getElementById('theme').addEventListener('click', () => root.classList.toggle('dark'));
    root.dataset.ready = 'yes';
  }
  return {data, element, fill, finish, none, prose};
})();
