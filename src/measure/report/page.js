"use strict";
// Pictures to flip between; without this script they stand below one another.
for (const gallery of document.querySelectorAll(".gallery")) {
  const figures = [...gallery.querySelectorAll("figure")];
  const tabs = gallery.querySelector(".tabs");
  const show = (chosen) => figures.forEach((figure, place) => { figure.hidden = place !== chosen; });
  let current = 0;
  const buttons = figures.map((figure, place) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = figure.dataset.name;
    button.onclick = () => choose(place);
    tabs.append(button);
    return button;
  });
  const choose = (place) => {
    current = place;
    buttons.forEach((button, other) => button.setAttribute("aria-pressed", other === place));
    show(place);
  };
  // While a picture is held, the first one shows.
  gallery.addEventListener("pointerdown", (event) => { if (event.target.tagName === "IMG") show(0); });
  for (const end of ["pointerup", "pointerleave", "pointercancel"]) {
    gallery.addEventListener(end, () => show(current));
  }
  gallery.addEventListener("dragstart", (event) => event.preventDefault());
  choose(0);
}
// Tables sort by the column whose head is pressed; "data-value" holds what sorts.
for (const table of document.querySelectorAll("table.sortable")) {
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = head.textContent;
    head.replaceChildren(button);
    button.onclick = () => {
      const up = head.getAttribute("aria-sort") === "descending";
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", up ? "ascending" : "descending");
      const value = (row) => row.cells[column].dataset.value ?? row.cells[column].textContent;
      const rows = [...table.tBodies[0].rows].sort((a, b) => {
        const [p, q] = [value(a), value(b)];
        const order = isNaN(p) || isNaN(q) ? p.localeCompare(q) : p - q;
        return up ? order : -order;
      });
      table.tBodies[0].append(...rows);
    };
  });
}
// Rows that do not hold all words of the filter hide.
for (const label of document.querySelectorAll("label.filter")) {
  const table = document.getElementById(label.dataset.table);
  label.hidden = false;
  label.querySelector("input").oninput = (event) => {
    const words = event.target.value.toLowerCase().split(/\s+/);
    for (const row of table.tBodies[0].rows) {
      const text = row.cells[0].textContent.toLowerCase();
      row.hidden = !words.every((word) => text.includes(word));
    }
  };
}
