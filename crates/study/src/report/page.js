// The page works without this file, only less well: every chart and table is in it.
"use strict";
const find = (selector, root = document) => root.querySelector(selector);
const findAll = (selector, root = document) => [...root.querySelectorAll(selector)];
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
document.documentElement.classList.add("js");

// ---- Theme -----------------------------------------------------------------------------------------------------

const themes = ["auto", "light", "dark"];
const storage = {
  // Storage is refused in some browsers for pages from files.
  get() { try { return localStorage.getItem("theme"); } catch { return null; } },
  set(value) { try { localStorage.setItem("theme", value); } catch { /* only this page then */ } },
};
function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  find("#theme").textContent = `Theme: ${theme}`;
}
setTheme(themes.includes(storage.get()) ? storage.get() : "auto");
find("#theme").addEventListener("click", () => {
  const next = themes[(themes.indexOf(document.documentElement.dataset.theme) + 1) % themes.length];
  setTheme(next);
  storage.set(next);
});

// ---- Choosing --------------------------------------------------------------------------------------------------

const choosers = [];

/// Selects, each of which offers what is left by those before it. `options` are lists of labels, one for each of
/// `names`; `show` is called with the index of the chosen one, and whether a person chose it.
function makeChooser(holder, names, options, show) {
  const selects = names.map((name) => {
    const label = document.createElement("label");
    label.append(name, document.createElement("select"));
    holder.append(label);
    return label.lastChild;
  });
  let current = options[0];

  function choose(wanted, byPerson) {
    // As many of the wanted labels as there are together, the first ones first.
    let left = options;
    names.forEach((_, place) => {
      const having = left.filter((option) => option[place] === wanted[place]);
      const labels = [...new Set(left.map((option) => option[place]))];
      const chosen = having.length > 0 ? wanted[place] : labels[0];
      selects[place].replaceChildren(...labels.map((label) => new Option(label, label, false, label === chosen)));
      selects[place].parentElement.hidden = labels.length < 2 && place > 0;
      left = left.filter((option) => option[place] === chosen);
    });
    current = left[0];
    show(options.indexOf(current), byPerson);
  }

  selects.forEach((select, place) => {
    select.addEventListener("change", () => {
      const wanted = current.with(place, select.value);
      choose(wanted, true);
      // One scene at a time, everywhere.
      if (names[place] === "Scene") {
        choosers.filter((other) => other.choose !== choose).forEach((other) => other.setScene(select.value));
      }
    });
  });
  const chooser = {
    choose,
    setScene(scene) { if (options.some((option) => option[0] === scene)) choose(current.with(0, scene), false); },
  };
  choosers.push(chooser);
  choose(current, false);
  return chooser;
}

for (const holder of findAll(".chooser")) {
  const choices = findAll(".choice", holder);
  const options = choices.map((choice) => JSON.parse(choice.dataset.choice));
  makeChooser(find(".selects", holder), JSON.parse(holder.dataset.names), options, (index) => {
    choices.forEach((choice, other) => choice.classList.toggle("chosen", other === index));
  });
}

// ---- Charts ----------------------------------------------------------------------------------------------------

const tip = find("#tip");
document.addEventListener("pointerover", (event) => {
  const mark = event.target.closest?.(".mark, .front");
  const title = mark && find("title", mark);
  // The browser's own tip would come on top, late.
  if (title) { mark.dataset.tip = title.textContent; title.remove(); }
  tip.hidden = !mark;
  if (mark) tip.textContent = mark.dataset.tip;
});
document.addEventListener("pointermove", (event) => {
  if (tip.hidden) return;
  const [width, height] = [tip.offsetWidth, tip.offsetHeight];
  tip.style.left = `${clamp(event.clientX + 14, 4, Math.max(4, innerWidth - width - 4))}px`;
  tip.style.top = `${event.clientY + 18 + height > innerHeight ? event.clientY - height - 10 : event.clientY + 18}px`;
});
for (const button of findAll("button.save")) {
  button.addEventListener("click", () => {
    const drawing = find("svg", button.closest("figure")).cloneNode(true);
    for (const mark of findAll("[data-tip]", drawing)) {
      const title = document.createElementNS("http://www.w3.org/2000/svg", "title");
      title.textContent = mark.dataset.tip;
      mark.removeAttribute("data-tip");
      mark.prepend(title);
    }
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([new XMLSerializer().serializeToString(drawing)], { type: "image/svg+xml" }));
    link.download = button.dataset.file;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  });
}

// ---- Tables ----------------------------------------------------------------------------------------------------

function sortKey(row, column) {
  const cell = row.cells[column];
  const text = cell?.dataset.value ?? cell?.textContent ?? "";
  const number = Number(text);
  if (text === "" || text === "–" || cell.colSpan > 1) return { rank: 2 };
  return Number.isNaN(number) ? { rank: 1, text } : { rank: 0, number };
}
for (const table of findAll("table.sortable")) {
  const body = table.tBodies[0];
  findAll("thead button", table).forEach((button, column) => {
    button.addEventListener("click", () => {
      const head = button.parentElement;
      const falling = head.getAttribute("aria-sort") === "ascending";
      findAll("th[aria-sort]", table).forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", falling ? "descending" : "ascending");
      const sign = falling ? -1 : 1;
      // What has no value stays last either way.
      const order = (a, b) => a.rank - b.rank ||
        sign * (a.rank === 0 ? a.number - b.number : (a.text ?? "").localeCompare(b.text ?? "", "en", { numeric: true }));
      const rows = [...body.rows].map((row) => ({ row, key: sortKey(row, column) }));
      body.append(...rows.sort((a, b) => order(a.key, b.key)).map(({ row }) => row));
    });
  });
}
for (const button of findAll("button.copy")) {
  button.addEventListener("click", async () => {
    const text = find("pre", button.parentElement);
    const before = button.textContent;
    try {
      await navigator.clipboard.writeText(text.textContent);
      button.textContent = "Copied";
    } catch {
      getSelection().selectAllChildren(text);
      button.textContent = "Selected: press Ctrl+C";
    }
    setTimeout(() => { button.textContent = before; }, 2000);
  });
}
if (find("#cell-filter")) {
  // A body a cell: what it is, and what made it.
  const rows = [...find("#cell-table").tBodies];
  const update = () => {
    const words = find("#cell-filter").value.toLowerCase().split(/\s+/).filter(Boolean);
    const failed = find("#cell-failed").checked;
    let shown = 0;
    for (const row of rows) {
      const text = row.textContent.toLowerCase();
      row.hidden = !words.every((word) => text.includes(word)) || (failed && !("failed" in row.dataset));
      shown += row.hidden ? 0 : 1;
    }
    find("#cell-count").textContent = `${shown} of ${rows.length} cells`;
  };
  find("#cell-filter").addEventListener("input", update);
  find("#cell-failed").addEventListener("change", update);
  update();
}
