// The page of `mbd effects`: what its template does not fill by itself.
(() => {
  const {data, element, fill, prose} = page;
  const table = document.getElementById('table');
  data.quantities.forEach((name, i) => {
    const head = element('th', {scope: 'col', className: 'n', textContent: name});
    head.dataset.cell = 'changes.' + i;
    table.tHead.rows[0].append(head);
  });
  fill(table, data.effects, (line, effect) => {
    if (effect.failure === null) return;
    while (line.cells.length > 1) line.lastChild.remove();
    line.append(element('td', {colSpan: 3 + data.quantities.length}, ...prose('does not run: ' + effect.failure)));
  });
  page.finish();
})();
