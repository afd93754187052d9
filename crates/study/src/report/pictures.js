// The viewer of pictures. They are linear: what is shown is computed here, for the exposure that the reader chooses.

const data = JSON.parse(find("#pictures-data").textContent);
if (data.cells.length > 0) makeViewer();

function makeViewer() {
  const stage = find("#stage");
  const [under, over] = [find(".under canvas", stage), find(".over canvas", stage)];
  const divider = find("#divider");
  const beside = find("#beside");
  const [exposure, exposureNumber] = [find("#exposure"), find("#exposure-number")];
  const names = ["Scene", "Pipeline", "Values", "Seed"];
  const options = data.cells.map((cell) => [cell.scene, cell.pipeline, cell.values || "–", String(cell.seed)]);
  const radios = findAll("input[name=view]");
  const half = halves();
  const diverging = bytesOf(data.diverging);
  const nameOf = (cell) => [cell.pipeline, cell.values].filter(Boolean).join(", ");
  const state = {
    cell: data.cells[0], beside: "reference", view: "slider", zoom: 1, x: 0, y: 0, divider: 50,
    // null: as the reference asks for.
    exposure: null,
    crops: data.crops, marking: false,
    // The pixel that is read, in shares of the sides; and whether by keys.
    probe: null,
  };

  const kept = new Map();
  /// The linear picture, unpacked; the last ones that were used are kept.
  function linear(picture) {
    if (!picture) return Promise.resolve(null);
    const found = kept.get(picture) ?? unpacked(picture);
    kept.delete(picture);
    kept.set(picture, found);
    if (kept.size > 24) kept.delete(kept.keys().next().value);
    return found;
  }

  const truth = () => data.truths[state.cell.truth];
  const chosenExposure = () => state.exposure ?? truth().exposure;
  /// What lies beside the image: the reference or another method, as { name, picture }.
  function other() {
    const cell = data.cells.find(({ key, scene }) => key === state.beside && scene === state.cell.scene);
    return cell ? { name: nameOf(cell), picture: cell.image } : { name: "reference", picture: truth().picture };
  }

  // The views: what lies over, what under. A picture is linear, a map of ꟻLIP is not.
  const views = {
    slider: () => [state.cell.image, other().picture],
    side: () => [state.cell.image, other().picture],
    image: () => [state.cell.image],
    reference: () => [truth().picture],
    flip: () => [state.cell.flip],
    difference: () => {
      const [a, b] = [state.cell.image, other().picture];
      return [a && b && a.width === b.width && a.height === b.height ? a : null];
    },
  };

  // ---- Painting ------------------------------------------------------------------------------------------------

  /// The display value of each half float: sRGB, cut at white.
  function display(stops) {
    const gain = 2 ** stops;
    return Uint8Array.from(half, (value) => {
      const light = clamp(value * gain, 0, 1) || 0;
      return Math.round(255 * (light <= 0.0031308 ? 12.92 * light : 1.055 * light ** (1 / 2.4) - 0.055));
    });
  }

  /// Paints a part of a picture; `color` writes the pixel `from` to the place `to` of an ImageData.
  function paint(canvas, { width }, [left, top, columns, rows], color) {
    const pixels = new ImageData(columns, rows);
    for (let y = 0, to = 0; y < rows; y++) {
      for (let x = 0; x < columns; x++, to += 4) {
        color(pixels.data, (top + y) * width + left + x, to);
        pixels.data[to + 3] = 255;
      }
    }
    Object.assign(canvas, { width: columns, height: rows });
    // Pixels come from here: nothing is gained by a canvas on the GPU.
    canvas.getContext("2d", { willReadFrequently: true }).putImageData(pixels, 0, 0);
  }

  /// The colors of a linear picture; magenta where it is NaN or infinite.
  const shown = ({ codes: [red, green, blue] }, table) => (out, from, to) => {
    const codes = [red[from], green[from], blue[from]];
    const broken = codes.some((code) => (code & 0x7c00) === 0x7c00);
    for (let channel = 0; channel < 3; channel++) out[to + channel] = broken ? 255 * (channel !== 1) : table[codes[channel]];
  };
  const luminance = ({ codes: [red, green, blue] }, at) => 0.2126 * half[red[at]] + 0.7152 * half[green[at]] + 0.0722 * half[blue[at]];
  const differenceEnd = () => 0.25 / 2 ** chosenExposure();
  const differences = (a, b) => (out, from, to) => {
    const difference = luminance(a, from) - luminance(b, from);
    const place = 3 * Math.round(127.5 * (1 + clamp(difference / differenceEnd(), -1, 1)));
    for (let channel = 0; channel < 3; channel++) {
      out[to + channel] = Number.isFinite(difference) ? diverging[place + channel] : 255 * (channel !== 1);
    }
  };
  const whole = ({ width, height }) => [0, 0, width, height];

  /// What is painted: of several calls that overlap, the last one wins.
  let turn = 0;
  let read = { left: null, right: null, truth: null };
  async function repaint() {
    const mine = ++turn;
    stage.ariaBusy = "true";
    const view = stage.dataset.view;
    const [first, second] = views[view]();
    const map = view === "flip" && first ? new Image() : null;
    if (map) map.src = `data:image/png;base64,${first.data}`;
    let pictures;
    try {
      pictures = await Promise.all([
        linear(state.cell.image), linear(other().picture), linear(truth().picture),
        linear(map ? null : first), linear(second), map?.decode(),
      ]);
    } catch (error) {
      stage.ariaBusy = "false";
      find("#picture-note").textContent = `This browser cannot unpack the pictures: ${error.message}`;
      return;
    }
    if (mine !== turn) return;
    const [left, right, reference, upper, lower] = pictures;
    read = { left, right, truth: reference };
    const table = display(chosenExposure());
    if (map) {
      Object.assign(over, { width: map.naturalWidth, height: map.naturalHeight });
      over.getContext("2d", { willReadFrequently: true }).drawImage(map, 0, 0);
    } else if (view === "difference" && left && right) {
      paint(over, left, whole(left), differences(left, right));
    } else if (upper) {
      paint(over, upper, whole(upper), shown(upper, table));
    }
    if (lower) paint(under, lower, whole(lower), shown(lower, table));
    // What is on the screen, for those who wait for it.
    stage.dataset.shown = [view, state.cell.key, state.beside, chosenExposure().toFixed(2)].join(" ");
    place();
    stage.ariaBusy = "false";
    tellPixel();
    paintCrops(mine, table);
  }

  function show() {
    const { cell } = state;
    const { note } = truth();
    listBeside();
    for (const radio of radios) radio.disabled = views[radio.value]().some((picture) => !picture);
    // The view that was asked for stays asked for: the next cell may have it.
    let view = state.view;
    if (radios.find((radio) => radio.value === view).disabled) view = radios.find((radio) => !radio.disabled)?.value ?? "image";
    radios.forEach((radio) => { radio.checked = radio.value === view; });
    const [first, second] = views[view]();
    const size = first ?? second ?? { width: 3, height: 2 };
    stage.className = ["slider", "side"].includes(view) ? view : "single";
    stage.dataset.view = view;
    stage.style.setProperty("--single", size.width / size.height);
    stage.style.setProperty("--aspect", (view === "side" ? 2 : 1) * size.width / size.height);
    const added = { flip: ", ꟻLIP", difference: ` − ${other().name}` }[view] ?? "";
    const labels = [view === "reference" ? "reference" : nameOf(cell) + added, other().name];
    [over, under].forEach((canvas, index) => {
      canvas.classList.toggle("missing", !views[view]()[index]);
      canvas.setAttribute("aria-label", `${labels[index]}, ${cell.scene}`);
    });
    find(".tag.left").textContent = labels[0];
    find(".tag.right").textContent = labels[1];
    find("#flip-bar").hidden = view !== "flip";
    find("#difference-bar").hidden = view !== "difference";
    const end = Number(differenceEnd().toPrecision(3));
    find("#difference-low").textContent = `−${end}`;
    find("#difference-high").textContent = `+${end}`;
    const signs = other().name === "reference" ? "blue is too dark, red too bright" : "blue is darker, red brighter";
    find("#difference-of").textContent = `luminance of ${nameOf(cell)} − ${other().name}: ${signs}`;
    find("#picture-note").textContent = cell.missing || note;
    exposure.value = exposureNumber.value = chosenExposure().toFixed(2);
    find("#picture-facts").replaceChildren(...cell.facts.map(([label, value]) => {
      const pair = document.createElement("div");
      for (const [tag, text] of [["dt", label], ["dd", value]]) pair.append(Object.assign(document.createElement(tag), { textContent: text }));
      return pair;
    }));
    place();
    repaint();
  }

  /// Offers the reference and the other pictures of the scene.
  function listBeside() {
    const cells = data.cells.filter((cell) => cell.scene === state.cell.scene && cell.image);
    const entries = cells.map((cell) => [`${nameOf(cell)}, seed ${cell.seed}`, cell.key]);
    const chosen = cells.some((cell) => cell.key === state.beside) ? state.beside : "reference";
    const all = truth().picture ? [["reference", "reference"], ...entries] : entries;
    beside.replaceChildren(...all.map(([label, key]) => new Option(label, key, false, key === chosen)));
    state.beside = beside.value || "reference";
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
    const scale = state.zoom * width / over.width;
    stage.classList.toggle("coarse", scale > 1.5);
    find("#zoom-one").disabled = over.width <= width;
    find("#zoom").textContent = `${Math.round(100 * scale)} %`;
    const box = ([left, top, wide, high]) => ({
      left: `${state.x + state.zoom * width * left}px`, top: `${state.y + state.zoom * height * top}px`,
      width: `${state.zoom * width * wide}px`, height: `${state.zoom * height * high}px`,
    });
    const outlines = state.marking instanceof Array ? [...state.crops, state.marking] : state.crops;
    for (const pane of findAll(".pane", stage)) {
      findAll(".outline", pane).forEach((outline) => outline.remove());
      pane.append(...outlines.map((crop, index) => {
        const outline = document.createElement("div");
        outline.className = `outline crop-${index % 6}`;
        Object.assign(outline.style, box(crop));
        return outline;
      }));
      const cross = find(".probe", pane);
      cross.hidden = !state.probe || document.activeElement !== find("#pixel");
      if (state.probe) Object.assign(cross.style, box([...state.probe, 0, 0]));
    }
  }

  // ---- The pixel under the pointer -----------------------------------------------------------------------------

  const printed = (value) => (Number.isFinite(value) ? Number(value.toPrecision(4)).toString() : String(value)).replace("-", "−");
  function tellPixel() {
    const body = find("#pixel tbody");
    const { left, right, truth: reference } = read;
    const at = (picture) => {
      const [column, row] = [picture.width, picture.height].map((count, axis) => Math.min(Math.floor(state.probe[axis] * count), count - 1));
      return { column, row, rgb: picture.codes.map((channel) => half[channel[row * picture.width + column]]) };
    };
    const inside = state.probe?.every((share) => share >= 0 && share < 1);
    const [a, b] = [left, right].map((picture) => (inside && picture ? at(picture) : null));
    const rows = [[nameOf(state.cell), a?.rgb], [other().name, b?.rgb]];
    if (a && b) rows.push(["difference", a.rgb.map((value, channel) => value - b.rgb[channel])]);
    if (inside && reference && other().name !== "reference") rows.push(["reference", at(reference).rgb]);
    find("#pixel-at").textContent = a ? `Pixel ${a.column}, ${a.row}` : "Pixel: none under the pointer";
    body.replaceChildren(...rows.map(([name, rgb]) => {
      const row = document.createElement("tr");
      row.append(Object.assign(document.createElement("th"), { scope: "row", textContent: name }));
      for (const channel of [0, 1, 2]) {
        row.append(Object.assign(document.createElement("td"), { className: "number", textContent: rgb ? printed(rgb[channel]) : "–" }));
      }
      return row;
    }));
  }
  /// The place under the pointer, in shares of the sides of the picture.
  function shareAt(event) {
    const panes = findAll(".pane", stage).map((pane) => pane.getBoundingClientRect());
    const box = panes.find((pane) => event.clientX >= pane.left && event.clientX < pane.right) ?? panes[0];
    return [(event.clientX - box.left - state.x) / (state.zoom * box.width), (event.clientY - box.top - state.y) / (state.zoom * box.height)];
  }
  stage.addEventListener("pointermove", (event) => { state.probe = shareAt(event); tellPixel(); });
  find("#pixel").addEventListener("focus", () => { state.probe ??= [0.5, 0.5]; place(); tellPixel(); });
  find("#pixel").addEventListener("blur", place);
  find("#pixel").addEventListener("keydown", (event) => {
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    if (!Object.hasOwn(moves, event.key) || !read.left) return;
    event.preventDefault();
    const counts = [read.left.width, read.left.height];
    // To the middle of the next pixel.
    state.probe = state.probe.map((share, axis) => {
      const pixel = Math.floor(clamp(share, 0, 1) * counts[axis]) + moves[event.key][axis] * (event.shiftKey ? 10 : 1);
      return (clamp(pixel, 0, counts[axis] - 1) + 0.5) / counts[axis];
    });
    place();
    tellPixel();
  });

  // ---- Crops ---------------------------------------------------------------------------------------------------

  const pixelsOf = ([left, top, wide, high], { width, height }) => {
    const side = (start, length, count) => {
      const first = Math.min(Math.round(start * count), count - 1);
      return [first, clamp(Math.round((start + length) * count), first + 1, count) - first];
    };
    const [[x, columns], [y, rows]] = [side(left, wide, width), side(top, high, height)];
    return [x, y, columns, rows];
  };

  /// The pictures of which crops are shown: the reference; then those of the scene with this seed, or if they are many,
  /// those with these values.
  function compared() {
    const { cell } = state;
    const same = data.cells.filter((each) => each.image && each.scene === cell.scene && each.truth === cell.truth && each.seed === cell.seed);
    const few = same.length <= 8 ? same : same.filter((each) => each === cell || each.values === cell.values || each.key === state.beside);
    return [{ name: "reference", picture: truth().picture }, ...few.slice(0, 16).map((each) => ({ name: nameOf(each), picture: each.image }))]
      .filter(({ picture }) => picture);
  }

  async function paintCrops(mine, table) {
    const holder = find("#crops");
    const list = compared();
    const pictures = state.crops.length > 0 ? await Promise.all(list.map(({ picture }) => linear(picture))) : [];
    if (mine !== turn) return;
    holder.replaceChildren(...state.crops.map((crop, index) => {
      const group = document.createElement("div");
      group.className = `crop crop-${index % 6}`;
      const remove = Object.assign(document.createElement("button"), { type: "button", textContent: "Remove" });
      remove.setAttribute("aria-label", `Remove crop ${index + 1}`);
      remove.addEventListener("click", () => setCrops(state.crops.filter((_, at) => at !== index)));
      const head = Object.assign(document.createElement("h3"), { textContent: `Crop ${index + 1} ` });
      head.append(remove);
      const insets = document.createElement("div");
      insets.className = "insets";
      insets.append(...list.map(({ name }, at) => {
        const figure = document.createElement("figure");
        const canvas = document.createElement("canvas");
        canvas.setAttribute("role", "img");
        canvas.setAttribute("aria-label", `Crop ${index + 1} of ${name}`);
        paint(canvas, pictures[at], pixelsOf(crop, pictures[at]), shown(pictures[at], table));
        figure.append(canvas, Object.assign(document.createElement("figcaption"), { textContent: name }));
        return figure;
      }));
      group.append(head, insets);
      return group;
    }));
    const numbers = state.crops.map((crop) => `(${crop.map((share) => Number(share.toFixed(4))).join(", ")})`);
    find("#crops-field").hidden = numbers.length === 0;
    find("#crops-field pre").textContent = `crops: [${numbers.join(", ")}],`;
  }

  function setCrops(crops) {
    state.crops = crops;
    place();
    repaint();
    remember();
  }
  /// Adds the part of the picture that is on the stage.
  function cropShown() {
    const { width, height } = paneSize();
    const all = [-state.x / width, -state.y / height, 1, 1].map((share) => share / state.zoom);
    setCrops([...state.crops, all]);
  }
  const mark = find("#crop-mark");
  const setMarking = (marking) => { state.marking = marking; mark.setAttribute("aria-pressed", Boolean(marking)); };

  // ---- Moving --------------------------------------------------------------------------------------------------

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
    const said = { scene, pipeline, values, seed, view: state.view };
    if (state.beside !== "reference") said.beside = state.beside;
    if (state.exposure !== null) said.exposure = state.exposure.toFixed(2);
    if (state.crops !== data.crops) said.crops = state.crops.map((crop) => crop.map((share) => share.toFixed(4)).join(",")).join(";");
    history.replaceState(null, "", `#${new URLSearchParams(said)}`);
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
    state.beside = wanted.get("beside") ?? "reference";
    const stops = parseFloat(wanted.get("exposure"));
    state.exposure = Number.isFinite(stops) ? clamp(stops, -20, 20) : null;
    if (wanted.has("crops")) {
      const crops = wanted.get("crops").split(";").map((crop) => crop.split(",").map(Number));
      const inside = (start, length) => start >= 0 && length > 0 && start + length <= 1.001;
      state.crops = crops.filter((crop) => crop.length === 4 && inside(crop[0], crop[2]) && inside(crop[1], crop[3])).slice(0, 32);
    }
    chooser.choose(["scene", "pipeline", "values", "seed"].map((name) => wanted.get(name)), false);
    choosers.filter((one) => one !== chooser).forEach((one) => one.setScene(wanted.get("scene")));
    find("#pictures").scrollIntoView();
  }

  radios.forEach((radio) => radio.addEventListener("change", () => { state.view = radio.value; show(); remember(); }));
  beside.addEventListener("change", () => { state.beside = beside.value; show(); remember(); });
  const setExposure = (stops) => { state.exposure = stops; show(); remember(); };
  for (const input of [exposure, exposureNumber]) {
    input.addEventListener("input", () => {
      // While a number is typed it may be none.
      if (Number.isFinite(input.valueAsNumber)) {
        state.exposure = clamp(input.valueAsNumber, -20, 20);
        for (const twin of [exposure, exposureNumber]) if (twin !== input) twin.value = state.exposure;
        repaint();
      }
    });
    input.addEventListener("change", () => setExposure(Number.isFinite(input.valueAsNumber) ? clamp(input.valueAsNumber, -20, 20) : null));
  }
  find("#exposure-auto").addEventListener("click", () => setExposure(null));
  mark.addEventListener("click", () => setMarking(!state.marking));
  find("#crop-shown").addEventListener("click", cropShown);
  find("#zoom-in").addEventListener("click", () => zoomCentre(1.5));
  find("#zoom-out").addEventListener("click", () => zoomCentre(1 / 1.5));
  find("#zoom-fit").addEventListener("click", fit);
  find("#zoom-one").addEventListener("click", () => zoomCentre(over.width / paneSize().width / state.zoom));
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
    const marks = Boolean(state.marking) || event.shiftKey;
    const moves = !marks && (event.target === divider || (state.zoom === 1 && stage.classList.contains("slider")));
    event.preventDefault();
    stage.setPointerCapture(event.pointerId);
    (moves ? divider : stage).focus({ preventScroll: true });
    let last = event;
    const start = shareAt(event);
    const move = (next) => {
      const box = stage.getBoundingClientRect();
      if (marks) {
        const ends = [start, shareAt(next)].map((share) => share.map((value) => clamp(value, 0, 1)));
        const low = [0, 1].map((axis) => Math.min(ends[0][axis], ends[1][axis]));
        state.marking = [...low, ...[0, 1].map((axis) => Math.abs(ends[0][axis] - ends[1][axis]))];
        place();
      } else if (moves) setDivider(100 * (next.clientX - box.left) / box.width);
      else pan(next.clientX - last.clientX, next.clientY - last.clientY);
      last = next;
    };
    if (moves) move(event);
    const drag = new AbortController();
    stage.addEventListener("pointermove", move, drag);
    for (const end of ["pointerup", "pointercancel"]) {
      stage.addEventListener(end, () => {
        drag.abort();
        const crop = state.marking;
        if (!marks) return;
        setMarking(false);
        if (end === "pointerup" && crop instanceof Array && crop[2] > 0.002 && crop[3] > 0.002) setCrops([...state.crops, crop]);
        else place();
      }, drag);
    }
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
      c: cropShown,
      "[": () => setExposure(chosenExposure() - 0.5),
      "]": () => setExposure(chosenExposure() + 0.5),
    };
    if (!Object.hasOwn(keys, event.key) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    keys[event.key]();
  });
  recall();
}
