"use strict";
// Sorts tables by a click on a heading, and draws the plots of a quantity against the tilt and against a drawn factor.
(() => {
  const valueOf = (cell) => {
    const text = cell.dataset.value ?? cell.textContent.trim();
    const number = Number(text);
    return text !== "" && Number.isFinite(number) ? number : text;
  };
  const before = (a, b) => {
    if (typeof a === "number" && typeof b === "number") return a - b;
    if (typeof a !== typeof b) return typeof a === "number" ? -1 : 1;
    return a.localeCompare(b);
  };
  for (const table of document.querySelectorAll("table.sortable")) {
    const headings = [...table.tHead.rows[0].cells];
    headings.forEach((heading, column) => {
      heading.tabIndex = 0;
      const sort = () => {
        const falls = heading.getAttribute("aria-sort") === "ascending";
        headings.forEach((other) => other.removeAttribute("aria-sort"));
        heading.setAttribute("aria-sort", falls ? "descending" : "ascending");
        const rows = [...table.tBodies[0].rows];
        rows.sort((a, b) => (falls ? -1 : 1) * before(valueOf(a.cells[column]), valueOf(b.cells[column])));
        table.tBodies[0].append(...rows);
      };
      heading.addEventListener("click", sort);
      heading.addEventListener("keydown", (event) => { if (event.key === "Enter") sort(); });
    });
  }

  const colours = ["#1f5f8b", "#b8432f", "#2a7d4f", "#8a5aa8", "#d98a21", "#3b8f93", "#7a6a4f", "#c2548f"];
  const plotWidth = 590, left = 60, top = 14, bottom = 44, legendRow = 17, letter = 6.2;
  const least = (values) => values.reduce((a, b) => Math.min(a, b), Infinity);
  const most = (values) => values.reduce((a, b) => Math.max(a, b), -Infinity);
  const element = (name, attributes, text) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== undefined) made.textContent = text;
    return made;
  };
  const steps = (low, high) => {
    const raw = (high - low) / 8, power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((k) => k * power).find((s) => s >= raw);
    const list = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) list.push(k * step);
    return list;
  };
  // The lines and numbers of both axes; `across` names what the horizontal one shows.
  const drawAxes = (plot, frame, across) => {
    for (const value of steps(frame.yLow, frame.yHigh)) {
      plot.append(element("line", { class: "grid", x1: frame.left, x2: frame.right, y1: frame.y(value), y2: frame.y(value) }));
      plot.append(element("text", { x: frame.left - 6, y: frame.y(value) + 4, "text-anchor": "end" },
        String(Number(value.toPrecision(6)))));
    }
    for (const value of steps(frame.xLow, frame.xHigh)) {
      plot.append(element("line", { class: "grid", x1: frame.x(value), x2: frame.x(value), y1: frame.top, y2: frame.bottom }));
      plot.append(element("text", { x: frame.x(value), y: frame.bottom + 16, "text-anchor": "middle" },
        Number(value.toPrecision(6)) + frame.unit));
    }
    plot.append(element("text", { x: (frame.left + frame.right) / 2, y: frame.bottom + 36, "text-anchor": "middle" }, across));
  };
  const frameOf = (xs, ys, right, height, unit) => {
    const xLow = least(xs), xHigh = Math.max(most(xs), xLow + (unit === "°" ? 1 : 1e-6));
    const yLow = Math.min(0, least(ys)), yHigh = Math.max(most(ys), yLow + 1e-6), bottomAt = height - bottom;
    return { xLow, xHigh, yLow, yHigh, left, right, top, bottom: bottomAt, unit,
      x: (value) => left + (value - xLow) / (xHigh - xLow) * (right - left),
      y: (value) => bottomAt - (value - yLow) / (yHigh - yLow) * (bottomAt - top) };
  };

  const drawTilts = (plot, series, spoon, quantity) => {
    plot.replaceChildren();
    const shown = series.filter((one) => one.spoon === spoon.value);
    const field = quantity.value;
    const right = 60 + letter * most([0, ...shown.map((one) => one.label.length)]);
    const width = left + plotWidth + right;
    const height = Math.max(340, top + legendRow * (shown.length + 1) + bottom);
    plot.setAttribute("viewBox", "0 0 " + width + " " + height);
    const values = shown.flatMap((one) => one.points.map((point) => point[field])).filter((y) => y !== null);
    const tilts = shown.flatMap((one) => one.points.map((point) => point.tilt));
    if (values.length === 0) {
      plot.append(element("text", { x: left, y: 40 }, "No case has a value of this quantity."));
      return;
    }
    const frame = frameOf(tilts, values, width - right, height, "°");
    const { x, y } = frame;
    drawAxes(plot, frame, "tilt (positive lifts the front)");
    shown.forEach((one, index) => {
      const colour = colours[index % colours.length];
      const dashes = ["none", "7 3", "2 3"][Math.floor(index / colours.length) % 3];
      const points = one.points.filter((point) => point[field] !== null);
      plot.append(element("polyline", { fill: "none", stroke: colour, "stroke-width": 1.6, "stroke-dasharray": dashes,
        points: points.map((point) => x(point.tilt) + "," + y(point[field])).join(" ") }));
      for (const point of points) {
        const dot = element("circle", { cx: x(point.tilt), cy: y(point[field]), r: 3.2, fill: colour });
        dot.append(element("title", {}, one.label + ", " + point.tilt + "°: " +
          Number(point[field].toPrecision(4)) + ", " + point.verdict));
        plot.append(dot);
      }
      const row = top + 14 + legendRow * index;
      plot.append(element("line", { x1: width - right + 14, x2: width - right + 34, y1: row - 4, y2: row - 4,
        stroke: colour, "stroke-width": 2, "stroke-dasharray": dashes }));
      plot.append(element("text", { x: width - right + 40, y: row }, one.label));
    });
  };

  const drawSample = (plot, points, factor, quantity) => {
    plot.replaceChildren();
    if (points.length === 0) {
      plot.append(element("text", { x: left, y: 40 }, "No case was judged."));
      return;
    }
    const width = 760, height = 340, field = factor.value;
    plot.setAttribute("viewBox", "0 0 " + width + " " + height);
    const unit = field.endsWith("_deg") ? "°" : "";
    const frame = frameOf(points.map((point) => point[field]), points.map((point) => point[quantity.value]), width - 20, height, unit);
    drawAxes(plot, frame, factor.selectedOptions[0].textContent);
    for (const point of points) {
      const dot = element("circle", { class: point.verdict, cx: frame.x(point[field]), cy: frame.y(point[quantity.value]), r: 4 });
      dot.append(element("title", {}, point.label + ": " + Number(point[quantity.value].toPrecision(4)) + ", " + point.verdict));
      plot.append(dot);
    }
  };

  // Draws the plot of this name, if the page has it, and again whenever one of its controls changes.
  const show = (name, data, controls, draw) => {
    const plot = document.getElementById(name);
    if (!plot) return;
    const content = JSON.parse(document.getElementById(data).textContent);
    const chosen = controls.map((id) => document.getElementById(id));
    const redraw = () => draw(plot, content, ...chosen);
    chosen.forEach((control) => control.addEventListener("change", redraw));
    redraw();
  };
  show("plot", "study-data", ["spoon", "quantity"], drawTilts);
  show("sample-plot", "sample-data", ["sample-factor", "sample-quantity"], drawSample);
})();
