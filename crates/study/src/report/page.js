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

// ---- Pictures --------------------------------------------------------------------------------------------------

const data = JSON.parse(find("#pictures-data").textContent);
if (data.cells.length > 0) makeViewer();

function makeViewer() {
  const stage = find("#stage");
  const [under, over] = [find(".under img", stage), find(".over img", stage)];
  const divider = find("#divider");
  const names = ["Scene", "Pipeline", "Values", "Seed"];
  const options = data.cells.map((cell) => [cell.scene, cell.pipeline, cell.values || "–", String(cell.seed)]);
  const radios = findAll("input[name=view]");
  const state = { cell: data.cells[0], view: "slider", zoom: 1, x: 0, y: 0, divider: 50 };

  // The views: what lies over, what under.
  const views = {
    slider: (cell, truth) => [cell.image, truth.picture],
    side: (cell, truth) => [cell.image, truth.picture],
    image: (cell) => [cell.image],
    reference: (_, truth) => [truth.picture],
    flip: (cell) => [cell.flip],
    difference: (cell) => [cell.difference],
  };
  const labels = { image: "image", slider: "image", side: "image", reference: "reference", flip: "ꟻLIP", difference: "difference" };

  function setPicture(element, picture, text) {
    element.classList.toggle("missing", !picture);
    element.alt = text;
    if (picture) element.src = `data:image/png;base64,${picture.data}`;
  }

  function show() {
    const { cell } = state;
    const truth = data.truths[cell.truth];
    for (const radio of radios) radio.disabled = views[radio.value](cell, truth).some((picture) => !picture);
    // The view that was asked for stays asked for: the next cell may have it.
    let view = state.view;
    if (radios.find((radio) => radio.value === view).disabled) view = radios.find((radio) => !radio.disabled)?.value ?? "image";
    radios.forEach((radio) => { radio.checked = radio.value === view; });
    const [first, second] = views[view](cell, truth);
    const size = first ?? second ?? { width: 3, height: 2 };
    stage.className = ["slider", "side"].includes(view) ? view : "single";
    stage.style.setProperty("--single", size.width / size.height);
    stage.style.setProperty("--aspect", (view === "side" ? 2 : 1) * size.width / size.height);
    setPicture(over, first, `${cell.pipeline}, ${cell.values}, ${labels[view]}`);
    setPicture(under, second, `reference of ${cell.scene}`);
    find(".tag.left").textContent = view === "reference" ? "reference" : `${cell.pipeline}${["flip", "difference"].includes(view) ? `, ${labels[view]}` : ""}`;
    find("#flip-bar").hidden = view !== "flip";
    find("#difference-bar").hidden = view !== "difference";
    find("#difference-low").textContent = `−${truth.end}`;
    find("#difference-high").textContent = `+${truth.end}`;
    find("#picture-note").textContent = cell.missing || truth.note;
    find("#picture-facts").replaceChildren(...cell.facts.map(([label, value]) => {
      const pair = document.createElement("div");
      for (const [tag, text] of [["dt", label], ["dd", value]]) pair.append(Object.assign(document.createElement(tag), { textContent: text }));
      return pair;
    }));
    place();
  }

  const paneSize = () => ({ width: over.parentElement.clientWidth, height: over.parentElement.clientHeight });

  function place() {
    const { width, height } = paneSize();
    state.x = clamp(state.x, width * (1 - state.zoom), 0);
    state.y = clamp(state.y, height * (1 - state.zoom), 0);
    stage.style.setProperty("--zoom", state.zoom);
    stage.style.setProperty("--x", `${state.x}px`);
    stage.style.setProperty("--y", `${state.y}px`);
    stage.style.setProperty("--divider", `${state.divider}%`);
    divider.setAttribute("aria-valuenow", Math.round(state.divider));
    divider.setAttribute("aria-valuetext", `${Math.round(state.divider)} % image`);
    const scale = state.zoom * width / (over.naturalWidth || width);
    stage.classList.toggle("coarse", scale > 1.5);
    find("#zoom-one").disabled = over.naturalWidth <= width;
    find("#zoom").textContent = `${Math.round(100 * scale)} %`;
  }

  /// Zooms by a factor and keeps the point (px, py) of the pane where it is.
  function zoomBy(factor, px, py) {
    const zoom = clamp(state.zoom * factor, 1, 64);
    state.x = px - (px - state.x) * zoom / state.zoom;
    state.y = py - (py - state.y) * zoom / state.zoom;
    state.zoom = zoom;
    place();
  }
  const zoomCentre = (factor) => { const { width, height } = paneSize(); zoomBy(factor, width / 2, height / 2); };
  const fit = () => { Object.assign(state, { zoom: 1, x: 0, y: 0 }); place(); };
  const setDivider = (value) => { state.divider = clamp(value, 0, 100); place(); };
  const pan = (dx, dy) => { state.x += dx; state.y += dy; place(); };

  /// The address names what is shown, so that it can be sent to others.
  function remember() {
    const [scene, pipeline, values, seed] = options[data.cells.indexOf(state.cell)];
    history.replaceState(null, "", `#${new URLSearchParams({ scene, pipeline, values, seed, view: state.view })}`);
  }

  const chooser = makeChooser(find("#picture-selects"), names, options, (index, byPerson) => {
    state.cell = data.cells[index];
    show();
    if (byPerson) remember();
  });
  function recall() {
    const wanted = new URLSearchParams(location.hash.slice(1));
    if (!wanted.has("scene")) return;
    if (Object.hasOwn(views, wanted.get("view"))) state.view = wanted.get("view");
    chooser.choose(["scene", "pipeline", "values", "seed"].map((name) => wanted.get(name)), false);
    choosers.filter((other) => other !== chooser).forEach((other) => other.setScene(wanted.get("scene")));
    find("#pictures").scrollIntoView();
  }

  radios.forEach((radio) => radio.addEventListener("change", () => { state.view = radio.value; show(); remember(); }));
  find("#zoom-in").addEventListener("click", () => zoomCentre(1.5));
  find("#zoom-out").addEventListener("click", () => zoomCentre(1 / 1.5));
  find("#zoom-fit").addEventListener("click", fit);
  find("#zoom-one").addEventListener("click", () => zoomCentre(over.naturalWidth / paneSize().width / state.zoom));
  over.addEventListener("load", place);
  new ResizeObserver(place).observe(stage);
  addEventListener("hashchange", recall);

  stage.addEventListener("wheel", (event) => {
    // A page that scrolls past must not be caught: the stage is clicked first, or Ctrl is held.
    if (!event.ctrlKey && !event.metaKey && !stage.contains(document.activeElement)) return;
    event.preventDefault();
    const box = over.parentElement.getBoundingClientRect();
    zoomBy(Math.exp(-event.deltaY / 400), (event.clientX - box.left) % Math.max(box.width, 1), event.clientY - box.top);
  }, { passive: false });

  stage.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    const moves = event.target === divider || (state.zoom === 1 && stage.classList.contains("slider"));
    event.preventDefault();
    stage.setPointerCapture(event.pointerId);
    (moves ? divider : stage).focus({ preventScroll: true });
    let last = event;
    const move = (next) => {
      const box = stage.getBoundingClientRect();
      if (moves) setDivider(100 * (next.clientX - box.left) / box.width);
      else pan(next.clientX - last.clientX, next.clientY - last.clientY);
      last = next;
    };
    if (moves) move(event);
    const drag = new AbortController();
    stage.addEventListener("pointermove", move, drag);
    for (const end of ["pointerup", "pointercancel"]) stage.addEventListener(end, () => drag.abort(), drag);
  });
  stage.addEventListener("keydown", (event) => {
    const step = event.shiftKey ? 10 : 1;
    const onDivider = event.target === divider;
    const keys = {
      ArrowLeft: () => (onDivider ? setDivider(state.divider - step) : pan(20 * step, 0)),
      ArrowRight: () => (onDivider ? setDivider(state.divider + step) : pan(-20 * step, 0)),
      ArrowUp: () => (onDivider ? setDivider(state.divider + step) : pan(0, 20 * step)),
      ArrowDown: () => (onDivider ? setDivider(state.divider - step) : pan(0, -20 * step)),
      Home: () => setDivider(0),
      End: () => setDivider(100),
      "+": () => zoomCentre(1.5),
      "-": () => zoomCentre(1 / 1.5),
      0: fit,
    };
    if (!Object.hasOwn(keys, event.key) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    keys[event.key]();
  });
  recall();
}
