#include "report/page_parts.hpp"

namespace hybrid::report {

const char* const kPageScript = R"js('use strict';
// Text only ever becomes text: nothing here parses HTML.
const make = (name, attributes, ...inside) => {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...inside);
  return element;
};
const plain = cell => cell !== null && typeof cell === 'object' ? cell.value ?? cell.text : cell;
const isNumber = column => 'digits' in column;
const shown = (cell, column) => {
  if (cell !== null && typeof cell === 'object' && 'text' in cell) return cell.text;
  const value = plain(cell);
  if (value === null || value === undefined) return '\u2013';
  if (typeof value !== 'number') return String(value);
  const digits = column.digits ?? 0;
  return value.toLocaleString('en', {minimumFractionDigits: digits, maximumFractionDigits: digits});
};

// "west rms>3": rows with "west" in a text and more than 3 in the column whose name begins with "rms".
const filterOf = (text, columns) => {
  const squeezed = name => name.toLowerCase().replaceAll(' ', '');
  const tests = text.toLowerCase().split(/\s+/).filter(Boolean).map(word => {
    const parts = word.match(/^([^<>=]+)(<=|>=|<|>|=)(.+)$/);
    const at = parts ? columns.findIndex(column => squeezed(column.name).startsWith(parts[1])) : -1;
    if (at < 0) return row => row.some(cell => String(plain(cell) ?? '').toLowerCase().includes(word));
    const wanted = parts[3], number = Number(wanted);
    return row => {
      const value = plain(row[at]);
      if (value === null || value === undefined) return false;
      if (parts[2] === '=') return isNumber(columns[at]) ? value === number : String(value).toLowerCase() === wanted;
      return {'<': value < number, '>': value > number, '<=': value <= number, '>=': value >= number}[parts[2]];
    };
  });
  return row => tests.every(test => test(row));
};

const kAtOnce = 200;
const compare = (a, b) => typeof a === 'number' && typeof b === 'number' ? a - b
  : String(a).localeCompare(String(b), 'en', {numeric: true});

function buildTable(place) {
  const data = JSON.parse(place.querySelector('script').textContent);
  const {columns, rows} = data;
  let sort = data.sort ?? null, limit = kAtOnce;
  const filter = make('input', {type: 'search', placeholder: 'filter: words, or ' +
    (columns.find(isNumber)?.name ?? 'name').replaceAll(' ', '') + '>1', 'aria-label': 'filter the rows'});
  const count = make('span', {class: 'soft', role: 'status'});
  const head = make('tr', {}), body = make('tbody', {});
  const more = make('button', {class: 'more', type: 'button'});
  const headings = columns.map((column, at) => {
    const button = make('button', {type: 'button'}, column.name);
    if (column.unit) button.append(make('small', {}, column.unit));
    button.onclick = () => { sort = sort && sort[0] === at ? [at, !sort[1]] : [at, false]; show(); };
    const heading = make('th', {class: isNumber(column) ? 'n' : '', scope: 'col', title: column.help ?? ''}, button);
    head.append(heading);
    return heading;
  });
  function cellOf(cell, column) {
    const object = cell !== null && typeof cell === 'object' ? cell : {};
    const text = shown(cell, column);
    const inside = object.href ? make('a', {href: object.href}, text) : text;
    return make('td', {class: (isNumber(column) ? 'n ' : '') + (object.state ?? '')}, inside);
  }
  function show() {
    let chosen = rows.filter(filterOf(filter.value, columns));
    if (sort) {
      const sign = sort[1] ? -1 : 1;
      chosen = [...chosen].sort((a, b) => {
        const [x, y] = [plain(a[sort[0]]) ?? null, plain(b[sort[0]]) ?? null];
        if (x === null || y === null) return (x === null) - (y === null);  // what is missing comes last
        return sign * compare(x, y);
      });
    }
    headings.forEach((heading, at) => {
      if (sort && sort[0] === at) heading.setAttribute('aria-sort', sort[1] ? 'descending' : 'ascending');
      else heading.removeAttribute('aria-sort');
    });
    body.replaceChildren(...chosen.slice(0, limit).map(row =>
      make('tr', {}, ...row.map((cell, at) => cellOf(cell, columns[at])))));
    count.textContent = chosen.length === rows.length ? `${rows.length} rows` : `${chosen.length} of ${rows.length} rows`;
    more.hidden = chosen.length <= limit;
    more.textContent = `show all ${chosen.length}`;
  }
  more.onclick = () => { limit = Infinity; show(); };
  filter.oninput = () => { limit = kAtOnce; show(); };
  const bar = make('div', {class: 'bar'}, filter, count);
  bar.hidden = rows.length < 6;
  place.append(bar, make('div', {class: 'scroll'}, make('table', {}, make('thead', {}, head), body)), more);
  show();
}
// A closed section builds its tables when it is opened.
for (const place of document.querySelectorAll('.table')) {
  const section = place.closest('details');
  if (!section || section.open) buildTable(place);
  else section.addEventListener('toggle', () => buildTable(place), {once: true});
}

// Horizontal bars: [[name, value, text]].
function bars(rows) {
  const space = 'http://www.w3.org/2000/svg', height = 22, names = 170, width = 330;
  const part = (name, attributes, text) => {
    const element = document.createElementNS(space, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text) element.textContent = text;
    return element;
  };
  const most = Math.max(...rows.map(row => row[1]), 1e-9);
  const svg = part('svg', {viewBox: `0 0 620 ${height * rows.length + 4}`, width: 620, role: 'img'});
  rows.forEach(([name, value, text], at) => {
    const y = at * height;
    svg.append(part('text', {x: names - 8, y: y + 16, 'text-anchor': 'end'}, name),
      part('rect', {x: names, y: y + 4, width: Math.max(1, width * value / most), height: height - 6, rx: 2}),
      part('text', {x: names + width * value / most + 6, y: y + 16, class: 'quiet'}, text));
  });
  return svg;
}

// An archive's page knows where it was opened, and so the store's folder; the page itself holds no such path.
const store = location.protocol === 'file:' && decodeURIComponent(location.pathname)
  .match(/^(.*)\/(?:results\/report|objects\/[0-9a-f]{2}\/[0-9a-f]{32})\/index\.html$/)?.[1];
if (store) {
  const typed = /^[\w@%+=:,./-]+$/.test(store) ? store : `'${store.replaceAll("'", "'\\''")}'`;
  for (const command of document.querySelectorAll('code[data-store]'))
    command.textContent = command.textContent.replace('STORE', () => typed);
  document.getElementById('store')?.remove();
}

// timing.js beside this page calls it: what differs from run to run stays out of the page.
function hybridTiming(timing) {
  const place = document.getElementById('timing');
  if (!place) return;
  const seconds = value => value >= 100 ? `${value.toFixed(0)} s` : `${value.toFixed(3)} s`;
  const ranked = (list, most) => Object.entries(list).sort((a, b) => b[1] - a[1]).slice(0, most)
    .map(([name, value]) => [name, value, seconds(value)]);
  const total = list => Object.values(list).reduce((sum, value) => sum + value, 0);
  const units = timing.cpu_s_by_unit;
  if (units) {
    const all = `${Object.keys(units).length} units, ${seconds(total(units))} of CPU time when they were made`;
    place.replaceChildren(make('h3', {}, `${all}; the longest`), bars(ranked(units, 40)));
    return;
  }
  const stages = timing.seconds_by_stage ?? {};
  const kernels = Object.fromEntries(Object.entries(timing.kernels ?? {}).map(([name, row]) => [name, row.seconds]));
  place.replaceChildren(
    make('p', {class: 'soft'}, `${timing.host}, ${timing.device}, ${timing.threads} threads`),
    make('h3', {}, `Stages, ${seconds(total(stages))} in all`), bars(ranked(stages, 40)));
  if (Object.keys(kernels).length)
    place.append(make('h3', {}, `The longest kernels, of ${seconds(total(kernels))} on the device`),
      bars(ranked(kernels, 12)));
  for (const command of document.querySelectorAll('code[data-unit]'))
    command.textContent = timing.run_again?.[command.dataset.unit] ?? command.textContent;
}
)js";

}  // namespace hybrid::report
