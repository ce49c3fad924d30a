// The list of objects: active object, name, colour and number of Gaussians; rename, recolour, remove.
const counted = new Intl.NumberFormat('en');
export const number = (value) => counted.format(value);
export const gaussiansText = (count) => `${number(count)} ${count === 1 ? 'Gaussian' : 'Gaussians'}`;

// Updates the list from the server's objects. Existing rows are reused, so that focus and half-typed names remain.
export function showObjects(list, { objects, active }, change) {
  const rows = new Map([...list.children].map((row) => [Number(row.dataset.id), row]));
  for (const object of objects) {
    const row = rows.get(object.id) ?? list.appendChild(newRow(object.id, change));
    rows.delete(object.id);
    fill(row, object, object.id === active, objects.length > 1);
  }
  for (const row of rows.values()) row.remove();
}

function newRow(id, change) {
  const row = document.createElement('li');
  row.dataset.id = id;
  row.innerHTML = `<input type="radio" name="active"><input type="color">
    <input type="text" maxlength="60" spellcheck="false">
    <span class="count"></span><button class="quiet"><svg><use href="#icon-bin"/></svg></button>`;
  const [active, colour, name] = row.children, remove = row.lastElementChild;
  active.addEventListener('change', () => change({ active: id }));
  colour.addEventListener('change', () => change({ id, colour: colour.value }));
  name.addEventListener('change', () => {
    name.value = name.value.trim() || name.defaultValue;
    if (name.value !== name.defaultValue) change({ id, name: name.value });
  });
  name.addEventListener('keydown', ({ key }) => key === 'Enter' && name.blur());
  name.addEventListener('focus', () => active.checked || change({ active: id }));
  remove.addEventListener('click', () => change({ remove: id }));
  return row;
}

function fill(row, { name, colour, gaussians }, isActive, removable) {
  const [active, swatch, text, count, remove] = row.children;
  active.checked = isActive;
  row.classList.toggle('active', isActive);
  if (swatch.value !== colour) swatch.value = colour;
  text.defaultValue = name;
  if (document.activeElement !== text) text.value = name;
  count.textContent = gaussians ? number(gaussians) : 'unmarked';
  remove.disabled = !removable;
  active.setAttribute('aria-label', `Paint ${name}`);
  swatch.setAttribute('aria-label', `Colour of ${name}`);
  text.setAttribute('aria-label', 'Name');
  remove.setAttribute('aria-label', `Remove ${name}`);
}
