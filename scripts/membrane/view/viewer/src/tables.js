// SPDX-License-Identifier: GPL-2.0-or-later
// Tables of measures and parameters.

function cell(row, name, text, kind) {
  const made = document.createElement(name);
  made.textContent = text;
  made.className = kind;
  row.append(made);
}

/** Adds a table with `title`, `head` and `rows` of text to `parent`. */
export function addTable(parent, { title, head, rows }) {
  const section = document.createElement("section");
  const heading = document.createElement("h2");
  heading.textContent = title;
  const table = document.createElement("table");
  const titles = table.createTHead().insertRow();
  head.forEach((text) => cell(titles, "th", text, text));
  const body = table.createTBody();
  for (const texts of rows) {
    const row = body.insertRow();
    texts.forEach((text, i) => cell(row, "td", text === "-" ? "" : text, head[i]));
  }
  section.append(heading, table);
  parent.append(section);
}
