"use strict";
// Sorts tables by a click on a heading, and draws the plot of a quantity against the tilt.
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

  const plot = document.getElementById("plot");
  if (!plot) return;
  const series = JSON.parse(document.getElementById("study-data").textContent);
  const quantity = document.getElementById("quantity");
  const spoon = document.getElementById("spoon");
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
  const draw = () => {
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
    const xLow = least(tilts), xHigh = Math.max(most(tilts), xLow + 1);
    const yLow = Math.min(0, least(values)), yHigh = Math.max(most(values), yLow + 1e-6);
    const x = (tilt) => left + (tilt - xLow) / (xHigh - xLow) * (width - left - right);
    const y = (value) => height - bottom - (value - yLow) / (yHigh - yLow) * (height - top - bottom);
    for (const value of steps(yLow, yHigh)) {
      plot.append(element("line", { class: "grid", x1: left, x2: width - right, y1: y(value), y2: y(value) }));
      plot.append(element("text", { x: left - 6, y: y(value) + 4, "text-anchor": "end" },
        String(Number(value.toPrecision(6)))));
    }
    for (const tilt of steps(xLow, xHigh)) {
      plot.append(element("line", { class: "grid", x1: x(tilt), x2: x(tilt), y1: top, y2: height - bottom }));
      plot.append(element("text", { x: x(tilt), y: height - bottom + 16, "text-anchor": "middle" }, tilt + "°"));
    }
    plot.append(element("text", { x: (left + width - right) / 2, y: height - 8, "text-anchor": "middle" },
      "tilt (positive lifts the front)"));
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
  quantity.addEventListener("change", draw);
  spoon.addEventListener("change", draw);
  draw();
})();
