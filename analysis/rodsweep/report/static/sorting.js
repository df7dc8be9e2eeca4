// Tables whose headings are buttons sort by them: numbers by data-value, words by text; what is unknown stays last.

function makeSortable(table) {
  for (const button of table.querySelectorAll("th > button.sort")) {
    const heading = button.parentElement;
    button.addEventListener("click", () => {
      const direction = heading.getAttribute("aria-sort") === "ascending" ? "descending" : "ascending";
      for (const other of table.querySelectorAll("th[aria-sort]")) other.removeAttribute("aria-sort");
      heading.setAttribute("aria-sort", direction);
      sortRows(table.tBodies[0], heading.cellIndex, direction === "ascending" ? 1 : -1);
    });
  }
}

function sortRows(body, column, sign) {
  const keyOf = (row) => {
    const cell = row.cells[column];
    if (cell === undefined) return null;
    if (cell.dataset.value === undefined) return cell.textContent.trim().toLowerCase();
    return cell.dataset.value === "" ? null : Number(cell.dataset.value);
  };
  const keyed = [...body.rows].map((row) => ({ row, key: keyOf(row) }));
  keyed.sort((a, b) => {
    if (a.key === null || b.key === null) return (a.key === null) - (b.key === null);
    return sign * (typeof a.key === "number" ? a.key - b.key : a.key.localeCompare(b.key));
  });
  body.append(...keyed.map((one) => one.row));
}
