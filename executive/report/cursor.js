// One time cursor through all charts, and the rover's place at that time on the map.
(() => {
  const places = JSON.parse(document.getElementById("places").textContent);
  const charts = [...document.querySelectorAll("svg.timed")];
  const map = document.getElementById("site-map"), here = document.getElementById("here");
  const NS = "http://www.w3.org/2000/svg";
  for (const chart of charts) {
    const line = document.createElementNS(NS, "line");
    line.setAttribute("class", "cursor");
    line.setAttribute("y1", chart.dataset.y0);
    line.setAttribute("y2", chart.dataset.y1);
    line.setAttribute("visibility", "hidden");
    line.setAttribute("vector-effect", "non-scaling-stroke");
    chart.cursor = line;
    chart.append(line);
    chart.addEventListener("pointermove", (event) => show(timeAt(chart, event)));
    chart.addEventListener("pointerleave", () => show(null));
  }
  function timeAt(chart, event) {
    const box = chart.getBoundingClientRect(), d = chart.dataset;
    const x = ((event.clientX - box.left) / box.width) * chart.viewBox.baseVal.width;
    const share = (x - d.x0) / (d.x1 - d.x0);
    return share < 0 || share > 1 ? null : share * d.t1;
  }
  function show(time) {
    for (const { cursor, dataset: d } of charts) {
      cursor.setAttribute("visibility", time === null ? "hidden" : "visible");
      const x = time === null ? 0 : +d.x0 + (time / d.t1) * (d.x1 - d.x0);
      cursor.setAttribute("x1", x);
      cursor.setAttribute("x2", x);
    }
    if (!map || !here || !places.length) return;
    here.setAttribute("visibility", time === null ? "hidden" : "visible");
    if (time === null) return;
    let low = 0, high = places.length - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (places[middle][0] < time) low = middle + 1;
      else high = middle;
    }
    const [, x, y] = places[low], d = map.dataset;
    here.setAttribute("cx", +d.x0 + x * d.px);
    here.setAttribute("cy", d.y0 - y * d.px);
  }
  const find = document.getElementById("find-lane");
  if (find) {
    const groups = [...document.querySelectorAll(".lanes .group")].map((group) => [group, group.open]);
    find.parentElement.hidden = false;
    find.addEventListener("input", () => {
      const words = find.value.toLowerCase().split(/\s+/).filter(Boolean);
      const holds = (lane) => words.every((word) => lane.dataset.find.includes(word));
      for (const [group, open] of groups) {
        const lanes = [...group.querySelectorAll("div.lane[data-find]")];
        for (const lane of lanes) lane.hidden = !holds(lane);
        group.hidden = !lanes.some(holds);
        group.open = words.length ? !group.hidden : open;
      }
    });
  }
  addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((d) => (d.open = true)));
})();
