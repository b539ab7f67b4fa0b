// The page of `mbd accuracy`: what its template does not fill by itself.
(() => {
  const {data, element, fill, prose} = page;
  const by = id => document.getElementById(id);

  for (const answer of data.answers)
    by('answers').append(element('p', {}, element('strong', {textContent: answer.quantity}), ...prose(answer.text)));

  // Of one quantity the table has the picture beside it where there is room.
  by('halves').className = data.choices.length === 1 ? 'halves' : '';
  for (const choice of data.choices) {
    const part = by('choice').content.firstElementChild.cloneNode(true), box = part.querySelector('.box');
    part.querySelector('h3').textContent = choice.quantity;
    if (choice.rows.length) {
      part.querySelector('p').remove();
      box.setAttribute('aria-label', 'What to take for ' + choice.quantity);
      const table = box.querySelector('table');
      fill(table, choice.rows, line => { line.className = 'numbers'; });
      [...table.tBodies[0].rows].forEach((line, i) => {  // below each row what it takes
        const {setting, change} = choice.rows[i], cell = element('td', {className: 'change', colSpan: line.cells.length});
        cell.append(element('details', {}, element('summary', {}, ...prose(setting)), element('pre', {textContent: change})));
        line.after(element('tr', {}, cell));
      });
    } else {
      part.querySelector('p').textContent = choice.why;
      box.remove();
    }
    by('choices').append(part);
  }

  // Two columns for each quantity that has errors.
  data.quantities.forEach((name, i) => {
    for (const [title, key] of [[name + ' rms', 'shown'], ['largest', 'largest']]) {
      const head = element('th', {scope: 'col', className: 'n', textContent: title});
      head.dataset.cell = 'errors.' + i + '.' + key;
      by('counts').before(head);
    }
  });
  for (const run of data.runs) {
    run.name = run.run + (run.front ? ' ●' : '');
    for (const error of run.errors) error.shown = (error.front ? '● ' : '') + error.rms;
  }
  fill(by('table'), data.runs, (line, run) => {
    line.id = 'run-' + run.run;
    if (run.front) line.className = 'front';
  });
  page.finish();
})();
