// The pointer reads all columns of a cycle at the same time. Without this script the page loses nothing but that.
"use strict";
for (const cycle of document.querySelectorAll("[data-cycle]")) {
  const columns = [...cycle.querySelectorAll("figure.trace")].flatMap((figure) => {
    const data = figure.querySelector("script");
    return data ? [column(figure.querySelector("svg"), JSON.parse(data.textContent))] : [];
  });
  for (const { svg, data } of columns) {
    svg.addEventListener("pointermove", (event) => {
      const x = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse()).x;
      const time = data.from + ((x - data.left) / (data.right - data.left)) * (data.to - data.from);
      for (const each of columns) each.show(time);
    });
    svg.addEventListener("pointerleave", () => columns.forEach((each) => each.show(NaN)));
  }
}

function column(svg, data) {
  const made = (name, attributes) => {
    const node = document.createElementNS(svg.namespaceURI, name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    return node;
  };
  const layer = svg.appendChild(made("g", { class: "readout", "aria-hidden": "true", visibility: "hidden" }));
  const cursor = layer.appendChild(made("line", { y1: 0, y2: data.bottom }));
  const clock = layer.appendChild(made("text", { y: data.bottom + 27, "text-anchor": "middle" }));
  const values = data.series.map(({ y, style }) => layer.appendChild(made("text", { y, class: style })));
  const show = (time) => {
    const share = (time - data.from) / (data.to - data.from);
    const visible = share >= 0 && share <= 1;
    layer.setAttribute("visibility", visible ? "visible" : "hidden");
    if (!visible) return;
    const x = data.left + share * (data.right - data.left);
    cursor.setAttribute("x1", x);
    cursor.setAttribute("x2", x);
    clock.setAttribute("x", x);
    clock.textContent = `${time.toFixed(1)} s`;
    values.forEach((text, place) => {
      const { name, unit, decimals, values: samples } = data.series[place];
      const value = samples[Math.round(share * (samples.length - 1))];
      text.textContent = value === null ? "" : `${name} ${value.toFixed(decimals).replace("-", "−")} ${unit}`;
      text.setAttribute("x", share < 0.6 ? x + 5 : x - 5);
      text.setAttribute("text-anchor", share < 0.6 ? "start" : "end");
    });
  };
  return { svg, data, show };
}
