"""Frame of an interactive page: HTML, style, and the script that draws.

The page contains all that it needs, and its content policy forbids to load anything else.
"""

#: HTML with placeholders for the title, the plotting library, and the content as JSON.
FRAME = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src 'unsafe-inline';
 style-src 'unsafe-inline'; img-src data: blob:">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="generator" content="undula">
<title>{title}</title>
<style>
body {{ margin: 0; font: 14px system-ui, sans-serif; color: #222; background: #fff; }}
main {{ display: flex; flex-wrap: wrap; min-height: calc(100vh - 60px); }}
h1 {{ font-size: 18px; font-weight: 500; margin: 14px 22px 0; }}
#diagram {{ flex: 3 1 620px; min-height: 520px; height: calc(100vh - 64px); }}
#aside {{ flex: 1 1 300px; max-width: 440px; padding: 8px 22px; box-sizing: border-box;
 max-height: calc(100vh - 60px); overflow: auto; }}
#aside p {{ color: #6b6b6b; margin: 6px 0; }}
#aside svg {{ width: 100%; max-height: 300px; background: #f3f3f1; border-radius: 4px; }}
table {{ border-collapse: collapse; width: 100%; margin-top: 8px; }}
td {{ padding: 1px 6px 1px 0; vertical-align: top; overflow-wrap: anywhere; }}
td:first-child {{ color: #6b6b6b; white-space: nowrap; }}
</style>
</head>
<body>
<h1>{title}</h1>
<main>
<div id="diagram"></div>
<div id="aside">
<p id="hint">Point at a dot to see what was found there; click to keep it.</p>
<div id="shapes" hidden>
<p>over a period, from aside</p><svg id="side"></svg>
<p>from above, with the path of the mean position</p><svg id="top"></svg>
</div>
<table id="figures"></table>
</div>
</main>
<script>{library}</script>
<script type="application/json" id="content">{content}</script>
<script>{script}</script>
</body>
</html>
"""

SCRIPT = r"""
(function () {
  "use strict";
  const content = JSON.parse(document.getElementById("content").textContent);
  const diagram = document.getElementById("diagram");
  let kept = null;

  function line(svg, points, colour, width) {
    const one = document.createElementNS(svg.namespaceURI, "polyline");
    one.setAttribute("points", points.map((p) => p[0] + "," + -p[1]).join(" "));
    one.setAttribute("style", "fill:none;stroke-linecap:round;stroke:" + colour +
      ";stroke-width:" + width);
    svg.appendChild(one);
  }

  function unpacked(packed, nodes) {
    const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
    const numbers = new DataView(bytes.buffer);
    const shapes = [];
    for (let at = 0; at < bytes.length; at += 6 * nodes) {
      const shape = [];
      for (let node = 0; node < nodes; node += 1) {
        const place = at + 6 * node;
        shape.push([0, 2, 4].map((k) => numbers.getInt16(place + k, true) / content.per_length));
      }
      shapes.push(shape);
    }
    return shapes;
  }

  function drawn(id, shapes, box, extra) {
    const svg = document.getElementById(id);
    svg.replaceChildren();
    svg.setAttribute("viewBox", [box[0], -box[3], box[2] - box[0], box[3] - box[1]].join(" "));
    shapes.forEach((shape, k) => {
      const last = k === shapes.length - 1;
      const place = shapes.length > 1 ? k / (shapes.length - 1) : 1;
      const colour = content.colours[Math.round(place * (content.colours.length - 1))];
      line(svg, shape, colour, last ? 0.02 : 0.009);
    });
    if (extra) { line(svg, extra, "#D55E00", 0.012); }
  }

  function mean(shape) {
    let sum = [0, 0], weight = 0;
    shape.forEach((node, k) => {
      const w = k === 0 || k === shape.length - 1 ? 0.5 : 1;
      sum = [sum[0] + w * node[0], sum[1] + w * node[1]];
      weight += w;
    });
    return [sum[0] / weight, sum[1] / weight];
  }

  function show(point) {
    document.getElementById("hint").hidden = true;
    const table = document.getElementById("figures");
    table.replaceChildren();
    point.figures.forEach((pair) => {
      const row = table.insertRow();
      row.insertCell().textContent = pair[0];
      row.insertCell().textContent = pair[1];
    });
    document.getElementById("shapes").hidden = !point.shapes;
    if (!point.shapes) { return; }
    const shapes = unpacked(point.shapes, content.nodes);
    const c = Math.cos(point.angle), s = Math.sin(point.angle);
    const tilt = Math.PI / 9;
    const side = shapes.map((shape) => shape.map((p) => [
      c * p[0] + s * p[1],
      Math.cos(tilt) * p[2] + Math.sin(tilt) * (c * p[1] - s * p[0])
    ]));
    const r = content.reach;
    drawn("side", side, [-r, Math.min(-0.35 * r, content.lowest) - 0.05, r, 1.08]);
    drawn("top", shapes.map((shape) => shape.map((p) => [p[0], p[1]])), [-r, -r, r, r],
      shapes.map(mean));
  }

  function point_of(event) {
    const index = event.points[0].customdata;
    return index === undefined || index === null ? null : index;
  }

  Plotly.newPlot(diagram, content.traces, content.layout, {
    responsive: true,
    displaylogo: false,
    modeBarButtons: [["zoom2d", "pan2d", "resetScale2d", "toImage"]]
  });
  diagram.on("plotly_hover", (event) => {
    const index = point_of(event);
    if (index !== null && kept === null) { show(content.points[index]); }
  });
  diagram.on("plotly_click", (event) => {
    const index = point_of(event);
    if (index === null) { return; }
    kept = kept === index ? null : index;
    show(content.points[index]);
  });
})();
"""
