"use strict";
(() => {
  const root = document.documentElement;
  const read = (id) => JSON.parse(document.getElementById(id).textContent);
  const stored = read("arrays"), figures = read("figures"), decoded = new Map();

  function array(key) {
    if (!decoded.has(key)) {
      const text = atob(stored[key]), bytes = new Uint8Array(text.length);
      for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
      decoded.set(key, new Float64Array(bytes.buffer));
    }
    return decoded.get(key);
  }

  const ours = () => {
    const style = getComputedStyle(root);
    return Object.fromEntries(["ink", "muted", "rule", "middle", "card", "accent"].map((name) => [name, style.getPropertyValue("--" + name).trim()]));
  };

  // arrays by key, and the page's own colours by name
  function resolve(value, colors) {
    if (Array.isArray(value)) return value.map((inner) => resolve(inner, colors));
    if (value && typeof value === "object") {
      if (typeof value.$ === "string") return array(value.$);
      return Object.fromEntries(Object.entries(value).map(([key, inner]) =>
        [key, /color$/.test(key) && inner in colors ? colors[inner]
          : key === "colorscale" ? inner.map(([at, color]) => [at, colors[color] || color]) : resolve(inner, colors)]));
    }
    return value;
  }

  function full(spec, colors) {
    const axis = { gridcolor: colors.rule, zerolinecolor: colors.rule, linecolor: colors.muted, ticks: "outside", tickcolor: colors.rule, automargin: true };
    const layout = resolve(spec.layout, colors);
    const styled = {
      margin: { l: 64, r: 16, t: 34, b: 42 }, paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
      font: { family: getComputedStyle(document.body).fontFamily, size: 12.5, color: colors.ink },
      modebar: { bgcolor: "rgba(0,0,0,0)", color: colors.muted, activecolor: colors.ink },
      hoverlabel: { bgcolor: colors.card, bordercolor: colors.muted, font: { color: colors.ink } },
      legend: { orientation: "h", x: 0, y: 1, xanchor: "left", yanchor: "bottom", bgcolor: "rgba(0,0,0,0)", itemsizing: "constant" },
      ...layout,
    };
    for (const name of new Set(["xaxis", "yaxis", ...Object.keys(layout).filter((key) => /^[xy]axis\d*$/.test(key))]))
      styled[name] = { ...axis, ...(layout[name] || {}) };
    // a title stands beside the numbers of its axis however long these are
    for (const name of Object.keys(styled)) if (/^yaxis\d*$/.test(name) && styled[name].title)
      styled[name] = { ...styled[name], title: { standoff: 8, ...styled[name].title } };
    // planes side by side stand one above the other where they would be too narrow to read
    const beside = Object.keys(layout).filter((key) => /^xaxis\d*$/.test(key) && layout[key].domain), n = beside.length;
    const place = element(spec), stacked = n > 1 && narrow(spec);
    place.dataset.height ??= parseFloat(place.style.height);
    if (stacked) place.style.height = `${place.dataset.height * 0.75 * n}px`;
    else if (narrow(spec)) place.style.height = `${Number(place.dataset.height) + broken(spec, styled)}px`;
    if (stacked) beside.forEach((name, i) => {
      const up = name.replace("x", "y"), top = 1 - i / n;
      styled[name] = { ...styled[name], domain: [0, 1], anchor: up.replace("axis", ""), title: i < n - 1 ? "" : styled[name].title };
      styled[up] = { ...styled[up], domain: [top - 1 / n + 0.09, top - 0.02], showticklabels: true, title: styled.yaxis.title };
      styled.annotations[i] = { ...styled.annotations[i], x: 0, y: top - 0.02, align: "left", text: lines(styled.annotations[i].text, 34) };
    });
    return styled;
  }

  // text in lines of at most so many characters, broken at spaces
  const lines = (text, most) => text.split(" ").reduce((said, word) => {
    const last = said.length - 1;
    if (last >= 0 && said[last].length + word.length < most) said[last] += ` ${word}`; else said.push(word);
    return said;
  }, []).join("<br>");

  // a folded plot has no width yet
  const narrow = (spec) => (element(spec).clientWidth || document.querySelector("main").clientWidth) < NARROW;

  // titles and names of categories in several lines; returns the pixels that they and the legend take besides
  function broken(spec, styled) {
    const named = new Set(spec.traces.flatMap((trace) => Array.isArray(trace.y) && typeof trace.y[0] === "string" ? trace.y : []));
    const title = styled.xaxis.title && styled.xaxis.title.text;
    if (title) styled.xaxis = { ...styled.xaxis, title: { ...styled.xaxis.title, text: lines(title, named.size ? 22 : 40) } };
    const said = [...named].map((name) => lines(name, 22)), most = Math.max(1, ...said.map((text) => text.split("<br>").length));
    if (most > 1) styled.yaxis = { ...styled.yaxis, tickmode: "array", tickvals: [...named], ticktext: said, tickfont: { size: 11 } };
    const entries = spec.traces.filter((trace) => trace.name && trace.showlegend !== false).length;
    return 17 * Math.max(0, entries - 2) + 13 * (most - 1) * named.size;
  }
  const entered = (spec, traces) => narrow(spec)
    ? traces.map((trace) => trace.name ? { ...trace, name: lines(trace.name, 36) } : trace) : traces;

  // nothing of a page leaves it
  const config = {
    displaylogo: false, responsive: true, showSendToCloud: false, plotlyServerURL: "",
    modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"],
  };
  const element = (spec) => document.getElementById("plot-" + spec.name);
  const FEW = 400, NARROW = 560;

  // indices of the first and last sample within [low, high]; x increases
  function within(x, low, high) {
    const first = (bound) => { let a = 0, b = x.length; while (a < b) { const m = (a + b) >> 1; if (x[m] < bound) a = m + 1; else b = m; } return a; };
    return [first(low), first(high)];
  }

  // what is folded on the screen is printed, and a plot as wide as paper, where the style sheet fits it to the page's
  const PAPER = 690;
  const scaled = (plot) => plot.querySelectorAll(".main-svg").forEach((one) => {
    one.setAttribute("viewBox", `0 0 ${one.getAttribute("width")} ${one.getAttribute("height")}`);
  });
  const sized = (change) => document.querySelectorAll(".plot").forEach((plot) => { if (plot.dataset.drawn) Plotly.relayout(plot, change); });
  window.addEventListener("beforeprint", () => {
    document.querySelectorAll("details").forEach((one) => { one.open = true; });
    sized({ autosize: false, width: PAPER });
  });
  window.addEventListener("afterprint", () => sized({ autosize: true, width: null }));

  // a table that is wider than its place has each row as a block of named values
  const fitted = (one) => one.querySelectorAll(".scroll").forEach((place) => {
    const table = place.firstElementChild;
    table.classList.remove("stacked");
    if (!place.clientWidth || table.offsetWidth <= place.clientWidth + 1) return;
    const heads = [...table.tHead.rows[0].cells].map((head) => head.textContent);
    for (const row of table.tBodies[0].rows) [...row.cells].forEach((cell, i) => { cell.dataset.head = heads[i]; });
    table.classList.add("stacked");
  });
  window.addEventListener("resize", () => fitted(document));
  fitted(document);

  // a plot is as wide as its place, which has no width while it is folded
  const wide = (one) => {
    fitted(one);
    one.querySelectorAll(".plot").forEach((plot) => { if (plot.dataset.drawn) Plotly.Plots.resize(plot); });
  };
  document.querySelectorAll("details").forEach((one) => one.addEventListener("toggle", () => { if (one.open) wide(one); }));

  // y range of what is visible between low and high, and whether single samples can be told apart
  function look(plot, low, high) {
    let bottom = Infinity, top = -Infinity;
    const modes = [];
    for (const trace of plot.data) {
      if (trace.visible === "legendonly") { modes.push(trace.mode); continue; }
      const line = trace.meta && trace.meta.curve;
      const [a, b] = line ? within(trace.x, low, high) : [0, trace.x.length];
      for (let i = Math.max(0, a - 1); i < Math.min(trace.x.length, b + 1); i++)
        if ((line || (trace.x[i] >= low && trace.x[i] <= high)) && Number.isFinite(trace.y[i])) {
          bottom = Math.min(bottom, trace.y[i]); top = Math.max(top, trace.y[i]);
        }
      modes.push(line ? (b - a < FEW ? "lines+markers" : "lines") : trace.mode);
    }
    const margin = 0.06 * (top - bottom) || 1e-12;
    return { range: Number.isFinite(bottom) ? [bottom - margin, top + margin] : null, modes };
  }

  // one zoom after the other; what is shown is remembered, so that our own changes do not answer themselves
  const shown = {};
  let queue = Promise.resolve();
  function zoom(group, range) {
    const wanted = JSON.stringify(range);
    if (shown[group] === wanted) return;
    shown[group] = wanted;
    queue = queue.then(() => apply(group, range));
  }

  async function apply(group, range) {
    if (shown[group] !== JSON.stringify(range)) return;
    for (const spec of figures.filter((one) => one.group === group)) {
      const plot = element(spec);
      const all = plot.data.filter((trace) => trace.meta && trace.meta.curve && trace.x.length).map((trace) => trace.x);
      const [low, high] = range || [Math.min(...all.map((x) => x[0])), Math.max(...all.map((x) => x[x.length - 1]))];
      const seen = look(plot, low, high);
      await Plotly.restyle(plot, { mode: seen.modes }, seen.modes.map((_, i) => i));
      await Plotly.relayout(plot, range && seen.range
        ? { "xaxis.range": [...range], "yaxis.range": seen.range } : { "xaxis.autorange": true, "yaxis.autorange": true });
    }
  }

  function pressed(button) {
    for (const other of document.querySelectorAll(".zoom button")) other.setAttribute("aria-pressed", String(other === button));
  }

  function watch(spec) {
    const plot = element(spec);
    if (!spec.group) return;
    shown[spec.group] = "null";
    plot.on("plotly_restyle", ([change]) => {
      if (!("visible" in change)) return;
      const wanted = shown[spec.group];
      shown[spec.group] = undefined;
      zoom(spec.group, JSON.parse(wanted));
    });
    plot.on("plotly_relayout", (change) => {
      const range = "xaxis.range[0]" in change ? [change["xaxis.range[0]"], change["xaxis.range[1]"]] : change["xaxis.range"];
      const wanted = range ? range.map(Number) : null;
      if ((!range && !change["xaxis.autorange"]) || shown[spec.group] === JSON.stringify(wanted)) return;
      pressed(range ? null : document.querySelector(".zoom button"));
      zoom(spec.group, wanted);
    });
  }

  for (const button of document.querySelectorAll(".zoom button"))
    button.addEventListener("click", () => { pressed(button); zoom(button.dataset.group, button.dataset.range ? JSON.parse(button.dataset.range) : null); });

  async function draw(first) {
    const colors = ours();
    for (const spec of figures) {
      const plot = element(spec);
      if (first) {
        await Plotly.newPlot(plot, entered(spec, resolve(spec.traces, colors)), full(spec, colors), config);
        watch(spec);
        scaled(plot);
        plot.on("plotly_afterplot", () => scaled(plot));
        plot.dataset.drawn = "true";
      } else {
        const kept = { x: plot.layout.xaxis, y: plot.layout.yaxis }, layout = full(spec, colors);
        for (const [name, axis] of [["xaxis", kept.x], ["yaxis", kept.y]])
          if (axis && !axis.autorange) layout[name] = { ...layout[name], range: axis.range, autorange: false };
        await Plotly.react(plot, entered(spec, resolve(spec.traces, colors)), layout, config);
      }
    }
    root.dataset.ready = "true";
  }

  const dark = matchMedia("(prefers-color-scheme: dark)");
  const theme = (name) => { root.dataset.theme = name; };
  theme(dark.matches ? "dark" : "light");
  dark.addEventListener("change", (event) => { theme(event.matches ? "dark" : "light"); draw(false); });
  document.getElementById("theme").addEventListener("click", () => { theme(root.dataset.theme === "dark" ? "light" : "dark"); draw(false); });
  draw(true);
})();
