"use strict";
(() => {
  const table = document.getElementById("verdicts");
  const body = table.tBodies[0];
  const form = document.querySelector("form");
  const filter = () => {
    const shown = new Set([...form.querySelectorAll("input[type=checkbox]:checked")].map((box) => box.value));
    const words = form.querySelector("input[type=search]").value.toLowerCase();
    let count = 0;
    for (const row of body.rows) {
      row.hidden = !(shown.has(row.dataset.verdict) && row.textContent.toLowerCase().includes(words));
      count += row.hidden ? 0 : 1;
    }
    form.querySelector("output").textContent = `${count} of ${body.rows.length} rows`;
  };
  const sort = (heading) => {
    const falling = heading.getAttribute("aria-sort") === "ascending";
    const column = heading.cellIndex;
    const key = (row) => row.cells[column].dataset.key;
    const numeric = [...body.rows].every((row) => key(row) === "" || Number.isFinite(Number(key(row))));
    const compare = (a, b) => {
      if (key(a) === "" || key(b) === "") return (key(a) === "") - (key(b) === "");
      const order = numeric ? Number(key(a)) - Number(key(b)) : key(a).localeCompare(key(b));
      return falling ? -order : order;
    };
    for (const other of heading.parentNode.cells) other.setAttribute("aria-sort", "none");
    heading.setAttribute("aria-sort", falling ? "descending" : "ascending");
    body.append(...[...body.rows].sort(compare));
  };
  form.addEventListener("input", filter);
  form.addEventListener("submit", (event) => event.preventDefault());
  for (const heading of table.tHead.rows[0].cells) {
    heading.addEventListener("click", () => sort(heading));
    heading.addEventListener("keydown", (event) => { if (event.key === "Enter") sort(heading); });
  }
  filter();
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const paper = { width: 640, height: 380 }; // chosen: of a figure on A4 or letter, in pixels
  const draw = (printed = false) => {
    const narrow = printed || matchMedia("(max-width: 40rem)").matches;
    const ink = printed ? "#1a1a1a" : getComputedStyle(document.body).color;
    for (const script of document.querySelectorAll("script[data-figure]")) {
      const { data, layout, config } = JSON.parse(script.textContent);
      const grid = { gridcolor: "rgba(128,128,128,0.25)", zerolinecolor: "rgba(128,128,128,0.6)", exponentformat: "power", automargin: true };
      const before = document.getElementById(script.dataset.figure).layout;
      const kept = (axis) => (before?.[axis]?.range ? { range: [...before[axis].range] } : {}); // what a reader has zoomed to stays
      const axes = { xaxis: { ...grid, ...layout.xaxis, ...kept("xaxis") }, yaxis: { ...grid, ...layout.yaxis, ...kept("yaxis") } };
      const look = { paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", font: { color: ink }, margin: { t: 40, r: 20, l: narrow ? 48 : 70, b: narrow ? 40 : 60 }, dragmode: "pan", modebar: { bgcolor: "rgba(0,0,0,0)", color: ink } };
      const menus = (layout.updatemenus ?? []).map((menu) => ({ ...menu, visible: !printed, bgcolor: "rgba(0,0,0,0)", bordercolor: ink, font: { color: ink } }));
      Plotly.react(script.dataset.figure, data, { ...layout, ...look, ...axes, updatemenus: menus, ...(printed ? paper : { autosize: true }) }, config);
      if (!printed && before) Plotly.Plots.resize(script.dataset.figure); // after printing it fills the page again
    }
  };
  dark.addEventListener("change", () => draw());
  addEventListener("beforeprint", () => draw(true));
  addEventListener("afterprint", () => draw());
  draw();
})();
